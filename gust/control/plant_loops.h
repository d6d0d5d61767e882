#pragma once

#include "gust/control/loop_source.h"
#include "gust/control/readings.h"
#include "gust/sim/plant.h"

namespace gust {

/// The closed loops of a plant. Episodes start at the plant's nominal state, or in the distribution of its trainings.
class PlantLoops final : public LoopSource {
 public:
  PlantLoops(std::shared_ptr<const Plant> plant, Readings readings)
      : plant_(std::move(plant)), readings_(std::move(readings)) {}

  const PlantSpec& spec() const override { return plant_->spec(); }
  std::vector<StartProtocol> starts() const override { return {{"nominal", false, spec().start}, random_starts()}; }
  std::vector<double> start_state(const StartProtocol& start, Rng episode) const override;
  std::string start_complaint(const StartProtocol& start) const override;
  std::unique_ptr<Loop> make(std::span<const Injection> injections, std::size_t lanes) const override;
  double seconds_per_step() const override;
  const Plant* plant() const override { return plant_.get(); }

 private:
  std::shared_ptr<const Plant> plant_;
  Readings readings_;
};

}  // namespace gust
