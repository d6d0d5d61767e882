#include "gust/control/network_policy.h"

#include <vector>

#include "gust/core/error.h"

namespace gust {
namespace {

class NetworkPolicy final : public Policy {
 public:
  explicit NetworkPolicy(OnnxModel model) : model_(std::move(model)), runner_(model_) {}
  NetworkPolicy(const NetworkPolicy&) = delete;  // the runner refers to the model
  NetworkPolicy& operator=(const NetworkPolicy&) = delete;

  std::size_t observations() const override { return model_.observations(); }
  std::size_t actions() const override { return model_.actions(); }

  void act(Rows<const double> observation, Rows<double> action) override {
    const std::size_t lanes = observation.lanes;
    in_.resize(lanes * observations());
    out_.resize(lanes * actions());
    for (std::size_t i = 0; i < observations(); ++i) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        in_[lane * observations() + i] = static_cast<float>(observation.at(i, lane));
      }
    }
    runner_.run(in_, lanes, out_);
    for (std::size_t i = 0; i < actions(); ++i) {
      for (std::size_t lane = 0; lane < lanes; ++lane) action.at(i, lane) = out_[lane * actions() + i];
    }
  }

 private:
  OnnxModel model_;
  OnnxRunner runner_;
  std::vector<float> in_, out_;  // lanes x features
};

}  // namespace

std::unique_ptr<Policy> network_policy(OnnxModel model) { return std::make_unique<NetworkPolicy>(std::move(model)); }

}  // namespace gust
