#include "gust/agents/environments.h"

#include <algorithm>
#include <memory>

namespace gust {

Environments::Environments(const TrainingTask& task, std::size_t count, Rng rng)
    : task_(task),
      rng_(rng),
      loop_(*task.plant, task.readings, task.injections, count),
      episodes_(count, 0),
      history_(count),
      reward_(count),
      done_(count),
      truncated_(count),
      terminal_(task.plant->spec().observations(), count) {
  for (std::size_t lane = 0; lane < count; ++lane) begin(lane);
}

void Environments::begin(std::size_t lane) {
  const Rng episode = rng_.split(lane).split(episodes_[lane]);
  EpisodeStart start;
  start.state = random_start(spec(), episode);
  start.parameters = draw_parameters(task_.randomised, spec(), episode);
  for (const Injection& injection : task_.injections) start.levels.push_back(injection.level);
  if (!task_.injections.empty()) start.signals = std::make_shared<Signals>(task_.injections, spec(), episode);
  loop_.begin(lane, start);
}

void Environments::step(Rows<const double> command) {
  for (std::size_t lane = 0; lane < count(); ++lane)
    for (std::size_t i = 0; i < command.rows; ++i) history_[lane].push_back(command.at(i, lane));
  loop_.step(command);
  std::ranges::copy(loop_.reward(), reward_.begin());
  for (std::size_t lane = 0; lane < count(); ++lane) {
    const bool last = loop_.steps_done(lane) >= spec().steps;
    truncated_[lane] = last && !loop_.failed(lane);
    done_[lane] = last || loop_.failed(lane);
    if (!done_[lane]) continue;
    for (std::size_t i = 0; i < terminal_.rows(); ++i) terminal_.at(i, lane) = loop_.observation().at(i, lane);
    ++episodes_[lane];
    history_[lane].clear();
    begin(lane);
  }
}

void Environments::save(Saver& saver) const {
  saver.list(episodes_);
  for (const std::vector<double>& commands : history_) saver.list(commands);
}

void Environments::load(Loader& loader) {
  loader.block(std::span(episodes_));
  for (std::vector<double>& commands : history_) {
    loader.list(commands);
    const std::size_t actions = spec().action.size();
    if (commands.size() % actions != 0 || commands.size() / actions >= static_cast<std::size_t>(spec().steps)) {
      Loader::fail();
    }
  }
  replay();
}

/// Begins every episode as late as it is short, so that all of them arrive together.
void Environments::replay() {
  Matrix<double> command(spec().action.size(), count());
  const auto steps_of = [&](std::size_t lane) { return history_[lane].size() / command.rows(); };
  std::size_t longest = 0;
  for (std::size_t lane = 0; lane < count(); ++lane) longest = std::max(longest, steps_of(lane));
  for (std::size_t step = 0; step <= longest; ++step) {
    for (std::size_t lane = 0; lane < count(); ++lane) {
      const std::size_t late = longest - steps_of(lane);
      if (step == late) begin(lane);
      if (step < late || step == longest) continue;
      for (std::size_t i = 0; i < command.rows(); ++i)
        command.at(i, lane) = history_[lane][(step - late) * command.rows() + i];
    }
    if (step < longest) loop_.step(command.view());
  }
}

}  // namespace gust
