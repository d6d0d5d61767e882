#pragma once

#include "gust/core/catalog.h"
#include "gust/core/rng.h"

namespace gust {

/// What a random parameter of a plant is drawn from. Immutable.
class Distribution {
 public:
  virtual ~Distribution() = default;

  // Every draw lies in [low, high].
  virtual double low() const = 0;
  virtual double high() const = 0;

  /// A number of the stream; equal streams give equal bits.
  virtual double draw(const Rng& rng) const = 0;
};

/// Every distribution there is, in the order of distributions/list.inc.
const Catalog<Distribution>& distributions();

}  // namespace gust
