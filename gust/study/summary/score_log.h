#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace gust {

/// The scores that claims are decided by, as they are asked for: whoever has them can resample them again. Any number
/// of threads may note at once; what is asked twice is kept once.
class ScoreLog {
 public:
  /// One policy along one sweep: a number a unit, which is a training, or an episode of a policy that is one alone.
  struct Curve {
    std::string study;
    std::string policy;
    std::string sweep;  ///< empty: undisturbed
    std::string start;
    std::string metric;
    std::string trainings;      ///< the same for policies whose units are resampled together
    std::size_t units = 0;      ///< in a cell
    std::vector<float> values;  ///< cell by cell
  };

  void note(Curve curve);
  bool empty() const { return curves_.empty(); }

  /// A table of the curves in alphabetical order, with where each begins among the values.
  std::string index() const;
  /// The values of all curves one after the other, as little-endian float32.
  std::string values() const;

 private:
  std::mutex mutex_;
  std::map<std::vector<std::string>, Curve> curves_;
};

}  // namespace gust
