#include "gust/agents/environments.h"

#include <algorithm>
#include <memory>

namespace gust {

Environments::Environments(const TrainingTask& task, std::size_t count, Rng rng,
                           const std::optional<AdversarySite>& against)
    : task_(task),
      rng_(rng),
      against_(against),
      loop_(*task.plant, task.readings, task.injections, count),
      episodes_(count, 0),
      history_(count),
      reward_(count),
      done_(count),
      truncated_(count),
      terminal_(task.plant->spec().observations(), count),
      value_(against ? adversary_channels(*against, task.plant->spec()) : 0, count) {
  std::vector<double> levels;
  for (const Injection& injection : task_.injections) levels.push_back(injection.level);
  for (std::size_t lane = 0; lane < count; ++lane)
    signals_.emplace_back(task_.injections, spec(), levels, rng_.split(lane));
  for (std::size_t lane = 0; lane < count; ++lane) begin(lane);
}

void Environments::begin(std::size_t lane) {
  const Rng episode = rng_.split(lane).split(episodes_[lane]);
  EpisodeStart start;
  start.state = random_start(spec(), episode);
  start.parameters = draw_parameters(task_.randomised, spec(), episode);
  for (const Injection& injection : task_.injections) start.levels.push_back(injection.level);
  start.signals = signals_[lane].at(static_cast<std::int64_t>(episodes_[lane]));
  loop_.begin(lane, start);
}

void Environments::move(Rows<const double> command, Rows<const double> adversary) {
  if (!against_) return loop_.step(command);
  adversary_value(*against_, adversary, value_.view());
  step_against(loop_, command, against_->site, value_.view());
}

void Environments::restart() {
  for (std::size_t lane = 0; lane < count(); ++lane) next(lane);
}

void Environments::next(std::size_t lane) {
  ++episodes_[lane];
  history_[lane].clear();
  begin(lane);
}

void Environments::step(Rows<const double> command, Rows<const double> adversary) {
  for (std::size_t lane = 0; lane < count(); ++lane) {
    for (std::size_t i = 0; i < command.rows; ++i) history_[lane].push_back(command.at(i, lane));
    for (std::size_t i = 0; i < adversary.rows; ++i) history_[lane].push_back(adversary.at(i, lane));
  }
  move(command, adversary);
  std::ranges::copy(loop_.reward(), reward_.begin());
  for (std::size_t lane = 0; lane < count(); ++lane) {
    const bool last = loop_.steps_done(lane) >= spec().steps;
    truncated_[lane] = last && !loop_.failed(lane);
    done_[lane] = last || loop_.failed(lane);
    if (!done_[lane]) continue;
    for (std::size_t i = 0; i < terminal_.rows(); ++i) terminal_.at(i, lane) = loop_.observation().at(i, lane);
    next(lane);
  }
}

void Environments::save(Saver& saver) const {
  saver.list(episodes_);
  for (const std::vector<double>& commands : history_) saver.list(commands);
}

void Environments::load(Loader& loader) {
  const std::size_t width = spec().action.size() + channels();
  loader.block(std::span(episodes_));
  for (std::vector<double>& actions : history_) {
    loader.list(actions);
    if (actions.size() % width != 0 || actions.size() / width >= static_cast<std::size_t>(spec().steps)) Loader::fail();
  }
  replay();
}

/// Begins every episode as late as it is short, so that all of them arrive together.
void Environments::replay() {
  Matrix<double> command(spec().action.size(), count()), adversary(channels(), count());
  const std::size_t width = command.rows() + adversary.rows();
  const auto steps_of = [&](std::size_t lane) { return history_[lane].size() / width; };
  std::size_t longest = 0;
  for (std::size_t lane = 0; lane < count(); ++lane) longest = std::max(longest, steps_of(lane));
  for (std::size_t step = 0; step <= longest; ++step) {
    for (std::size_t lane = 0; lane < count(); ++lane) {
      const std::size_t late = longest - steps_of(lane);
      if (step == late) begin(lane);
      if (step < late || step == longest) continue;
      const double* done = &history_[lane][(step - late) * width];
      for (std::size_t i = 0; i < command.rows(); ++i) command.at(i, lane) = done[i];
      for (std::size_t i = 0; i < adversary.rows(); ++i) adversary.at(i, lane) = done[command.rows() + i];
    }
    if (step < longest) move(command.view(), adversary.view());
  }
}

}  // namespace gust
