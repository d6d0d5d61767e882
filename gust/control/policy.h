#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gust/core/rows.h"
#include "gust/sim/plant.h"

namespace gust {

/// Maps observations to actions. Deterministic; it acts and does not learn (an agent trains).
class Policy {
 public:
  virtual ~Policy() = default;

  virtual std::size_t observations() const = 0;
  virtual std::size_t actions() const = 0;

  /// Writes an action for every lane, in the unit in which the plant's preset lets policies act, not clipped.
  /// observation is observations() x lanes, action is actions() x lanes; `step` tells the control steps that each
  /// lane's episode has behind it, for controllers that follow a clock. The bits of a lane do not depend on the others.
  /// An object belongs to one thread: it may use its own scratch memory.
  ///
  /// A policy with memory keeps it lane by lane, and begins anew in each lane whose `step` is 0, and in all lanes where
  /// their number changes.
  virtual void act(Rows<const double> observation, std::span<const std::int64_t> step, Rows<double> action) = 0;

  /// What it keeps of each lane from one control step to the next, by name and unit; nothing for a policy whose action
  /// depends on observation and step alone.
  virtual std::vector<Component> memory() const { return {}; }
  /// That memory after the last act(): memory().size() x lanes.
  virtual Rows<const double> remembered() const { return {}; }
};

/// Does nothing: the plant by itself.
std::unique_ptr<Policy> zero_policy(std::size_t observations, std::size_t actions);

}  // namespace gust
