#include "gust/study/trials/executor.h"

#include <algorithm>

namespace gust {

Progress::Progress(std::span<const Job> jobs) : entries_(jobs.size()) {
  for (std::size_t job = 0; job < jobs.size(); ++job) {
    entries_[job].what = jobs[job].what;
    entries_[job].seconds = jobs[job].seconds;
  }
}

Progress::Moment Progress::now() const {
  Moment moment;
  moment.jobs = entries_.size();
  double whole = 0;
  for (const Entry& entry : entries_) {
    const bool finished = entry.finished.load();
    whole += entry.seconds;
    moment.fraction += entry.seconds * (finished ? 1.0 : entry.fraction.load());
    moment.finished += finished ? 1 : 0;
    if (!finished && entry.running.load()) moment.running.push_back(entry.what);
  }
  if (whole > 0) moment.fraction = std::min(1.0, moment.fraction / whole);
  return moment;
}

void Progress::start(std::size_t job) { entries_.at(job).running = true; }

void Progress::advance(std::size_t job, double fraction) { entries_.at(job).fraction = std::clamp(fraction, 0.0, 1.0); }

void Progress::finish(std::size_t job) { entries_.at(job).finished = true; }

}  // namespace gust
