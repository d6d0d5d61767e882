#include "gust/nn/quantile_network.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace gust;

namespace {

constexpr QuantileShape kSmall = {.inputs = 3, .hidden = 20, .cosines = 5, .head = 18};

/// A network on drawn inputs and fractions; its loss is half the sum of squared quantiles.
template <class T>
struct Problem {
  QuantileShape shape;
  QuantileRoom room;
  QuantileNetwork<T> network;
  Tiles<T> input, own;
  std::vector<T> shared;
  Tiles<T> at_quantiles;
  QuantileRunner<T> runner;

  Problem(const QuantileShape& size, const QuantileRoom& batch)
      : shape(size),
        room(batch),
        network(size),
        input(room.lanes, size.inputs),
        own(room.lanes, room.fractions),
        at_quantiles(room.lanes, room.fractions),
        runner(size, batch, {0, size.inputs}) {
    QuantileNetwork<double> drawn(size);
    initialise_uniform(drawn, Rng(1));
    network.trunk = converted<T>(drawn.trunk);
    network.embedding = converted<T>(drawn.embedding);
    network.top = converted<T>(drawn.top);
    for (std::size_t i = 0; i < room.fractions; ++i)
      shared.push_back(static_cast<T>(static_cast<float>(Rng(2).uniform(i))));
    for (std::size_t lane = 0; lane < room.lanes; ++lane) {
      for (std::size_t i = 0; i < size.inputs; ++i)
        input.at(lane, i) = static_cast<T>(static_cast<float>(Rng(3).split(lane).uniform(i)));
      for (std::size_t i = 0; i < room.fractions; ++i) own.at(lane, i) = static_cast<T>(Rng(4).split(lane).uniform(i));
    }
  }
  Fractions<T> fractions() const { return room.own ? Fractions<T>{.own = &own} : Fractions<T>{.shared = shared}; }
  const Tiles<T>& output() { return runner.forward(network, input, fractions()); }
  double loss() {
    double sum = 0.0;
    const Tiles<T>& z = output();
    for (std::size_t lane = 0; lane < room.lanes; ++lane)
      for (std::size_t i = 0; i < room.fractions; ++i)
        sum += 0.5 * static_cast<double>(z.at(lane, i)) * static_cast<double>(z.at(lane, i));
    return sum;
  }
  /// Runs forward, and leaves the loss's gradient at the quantiles in place.
  void prepare() {
    const Tiles<T>& z = output();
    for (std::size_t lane = 0; lane < room.lanes; ++lane)
      for (std::size_t i = 0; i < room.fractions; ++i) at_quantiles.at(lane, i) = z.at(lane, i);
  }
  QuantileNetwork<T> gradient() {
    QuantileNetwork<T> result(shape);
    prepare();
    runner.backward(network, at_quantiles, result);
    return result;
  }
  Tiles<T> input_gradient() {
    prepare();
    return runner.backward_to_input(network, at_quantiles);
  }
  double slope(T& x) {
    const double h = 1e-5, at = x;
    x = at + h;
    const double above = loss();
    x = at - h;
    const double below = loss();
    x = at;
    return (above - below) / (2 * h);
  }
};

/// The numbers of a batch, lane by lane.
template <class T>
std::vector<T> listed(const Tiles<T>& tiles) {
  std::vector<T> values;
  for (std::size_t lane = 0; lane < tiles.lanes(); ++lane)
    for (std::size_t i = 0; i < tiles.features(); ++i) values.push_back(tiles.at(lane, i));
  return values;
}

/// Gives every lane the shared fractions as its own.
template <class T>
void share(Problem<T>& problem) {
  for (std::size_t lane = 0; lane < problem.room.lanes; ++lane)
    for (std::size_t i = 0; i < problem.room.fractions; ++i) problem.own.at(lane, i) = problem.shared[i];
}

bool agrees(double slope, double expected) {
  return std::abs(slope - expected) <= 1e-6 * std::max(std::abs(expected), 1e-2);
}

/// The largest difference of two sets of numbers, against the largest number.
template <class A, class B>
double distance(const A& a, const B& b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = std::max<double>(difference, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
    size = std::max<double>(size, std::abs(static_cast<double>(b[i])));
  }
  return difference / size;
}

}  // namespace

TEST_CASE("8.1.1 finite differences confirm every gradient of an implicit quantile network") {
  for (const bool own : {false, true}) {
    Problem<double> problem(kSmall, {.lanes = 4, .fractions = 6, .own = own});
    QuantileNetwork<double> gradient = problem.gradient();
    const Tiles<double> input_gradient = problem.input_gradient();

    int wrong = 0;
    for (std::size_t part = 0; part < 3; ++part) {
      const auto parameters = problem.network.parameters()[part];
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (parameters[i] == 0.0) continue;  // a gap between two layers
        wrong += !agrees(problem.slope(parameters[i]), gradient.parameters()[part][i]);
      }
    }
    for (std::size_t lane = 0; lane < 4; ++lane)
      for (std::size_t i = 0; i < kSmall.inputs; ++i)
        wrong += !agrees(problem.slope(problem.input.at(lane, i)), input_gradient.at(lane, i));
    CAPTURE(own);
    CHECK(wrong == 0);
  }
}

TEST_CASE("8.7.7 shared fractions give what every lane with the same ones of its own gives") {
  const QuantileShape shape = {.inputs = 5};
  Problem<float> shared(shape, {70, 10, false}), own(shape, {70, 10, true});
  share(own);

  CHECK(distance(listed(shared.output()), listed(own.output())) < 1e-6);
  QuantileNetwork<float> a = shared.gradient(), b = own.gradient();
  for (std::size_t part = 0; part < 3; ++part) CHECK(distance(a.parameters()[part], b.parameters()[part]) < 1e-5);
  CHECK(distance(listed(shared.input_gradient()), listed(own.input_gradient())) < 1e-5);
}

TEST_CASE("8.7.7 in double, shared and own fractions agree to rounding, gradients too") {
  for (const std::size_t head : {8u, 18u}) {  // weights lie either way round
    QuantileShape shape = kSmall;
    shape.head = head;
    Problem<double> shared(shape, {70, 7, false}), own(shape, {70, 7, true});
    share(own);

    CHECK(distance(listed(shared.output()), listed(own.output())) < 1e-12);
    QuantileNetwork<double> a = shared.gradient(), b = own.gradient();
    for (std::size_t part = 0; part < 3; ++part) CHECK(distance(a.parameters()[part], b.parameters()[part]) < 1e-12);
    CHECK(distance(listed(shared.input_gradient()), listed(own.input_gradient())) < 1e-12);
  }
}

TEST_CASE("8.1.1 gradients of a quantile network in float32 are those in double within 1e-4") {
  const QuantileShape shape = {.inputs = 5};
  Problem<float> single(shape, {64, 32, false});
  Problem<double> twice(shape, {64, 32, false});

  QuantileNetwork<float> a = single.gradient();
  QuantileNetwork<double> b = twice.gradient();

  for (std::size_t part = 0; part < 3; ++part) CHECK(distance(a.parameters()[part], b.parameters()[part]) < 1e-4);
}

TEST_CASE("a quantile network is its definition") {
  Problem<double> problem(kSmall, {2, 3, false});
  const QuantileNetwork<double>& network = problem.network;
  const auto rectified = [](double x) { return x > 0.0 ? x : 0.0; };
  const std::vector<double> input = listed(problem.input);

  const std::vector<double> z = listed(problem.output());

  MlpWorkspace<double> trunk(kSmall.trunk(), 2), embedding(kSmall.embedding(), 3), top(kSmall.top(), 1);
  std::vector<double> cosines, product(kSmall.hidden);
  for (const double fraction : problem.shared)
    for (std::size_t i = 0; i < kSmall.cosines; ++i)
      cosines.push_back(std::cos(3.14159265358979323846 * static_cast<double>(i) * fraction));
  const auto e = trunk.forward(network.trunk, input);
  const auto psi = embedding.forward(network.embedding, cosines);
  for (std::size_t lane = 0; lane < 2; ++lane) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < kSmall.hidden; ++j)
        product[j] = rectified(e[lane * kSmall.hidden + j]) * rectified(psi[i * kSmall.hidden + j]);
      CHECK(z[lane * 3 + i] == doctest::Approx(top.forward(network.top, product)[0]).epsilon(1e-12));
    }
  }
}

TEST_CASE("the bits of a lane's quantiles depend neither on other lanes nor on other fractions") {
  const QuantileShape shape = {.inputs = 5};
  Problem<float> all(shape, {70, 10, false}), few(shape, {3, 5, false});

  const std::vector<float> a = listed(all.output()), b = listed(few.output());

  bool equal = true;
  for (std::size_t lane = 0; lane < 3; ++lane)
    for (std::size_t i = 0; i < 5; ++i) equal = equal && b[lane * 5 + i] == a[lane * 10 + i];
  CHECK(equal);
}
