#include "gust/control/policy.h"

#include <algorithm>

namespace gust {
namespace {

class ZeroPolicy final : public Policy {
 public:
  ZeroPolicy(std::size_t observations, std::size_t actions) : observations_(observations), actions_(actions) {}

  std::size_t observations() const override { return observations_; }
  std::size_t actions() const override { return actions_; }
  void act(Rows<const double>, std::span<const std::int64_t>, Rows<double> action) override {
    for (std::size_t i = 0; i < actions_; ++i) std::ranges::fill(action.row(i), 0.0);
  }

 private:
  std::size_t observations_;
  std::size_t actions_;
};

}  // namespace

std::unique_ptr<Policy> zero_policy(std::size_t observations, std::size_t actions) {
  return std::make_unique<ZeroPolicy>(observations, actions);
}

}  // namespace gust
