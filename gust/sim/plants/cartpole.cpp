#include <algorithm>

#include "gust/sim/plant_entry.h"

namespace gust {
namespace {

/// Pole hinged on a cart. The action u [N] pushes the cart; the dynamics site (w_x, w_z) [N], world axes, pulls at the
/// middle of the pole (tap_point = com) or at its tip. M cart mass, m pole mass, l half length, w thickness,
/// J = I + m l^2 with I = m/12 (w^2 + 4 l^2), the box that the reference simulator takes for its inertia
/// (docs/plants.md 1.1). The lever a of the tap is l at the centre of mass and 2 l at the tip.
///
///   (M + m) x'' + m l (th'' cos th - th'^2 sin th) = u + w_x
///   J th'' + m l (x'' cos th - g sin th)           = a (w_x cos th - w_z sin th)
///
/// State: x [m], x' [m/s], th [rad, 0 upright, positive towards +x], th' [rad/s]. Semi-implicit Euler
/// (docs/plants.md 1.3). Checked against tests/reference/traj (PyBullet).
struct CartPole {
  static constexpr int kStates = 4;
  static constexpr int kHidden = 0;
  static constexpr int kActions = 1;
  static constexpr int kForces = 2;
  static constexpr int kParameters = 3;

  double pole_length = 0.5;
  double pole_mass = 0.1;
  double cart_mass = 1.0;
  double gravity = 9.8;
  double pole_thickness = 0.05;
  double force_limit = 10.0;
  double rail = 15.0;
  double x_limit = 2.4;
  double theta_limit = 1.5707963267948966;
  std::string tap_point = "com";
  double control_rate = 50.0;
  double physics_rate = 1000.0;
  std::int64_t steps = 250;
  bool normalized_action = true;
  std::vector<double> goal = {0, 0, 0, 0};
  std::vector<double> start = {0, 0, 0, 0};
  std::vector<double> start_range = {0.3, 0, 0.1, 0};
  std::vector<double> state_weights = {5, 0, 1, 0};
  double action_weight = 1e-4;

  static constexpr std::tuple kFields = {
      field("pole_length", &CartPole::pole_length, "pivot to the pole's centre of mass, half the rod", positive, "m"),
      field("pole_mass", &CartPole::pole_mass, "mass of the pole", positive, "kg"),
      field("cart_mass", &CartPole::cart_mass, "mass of the cart", positive, "kg"),
      field("gravity", &CartPole::gravity, "acceleration of gravity", non_negative, "m/s^2"),
      field("pole_thickness", &CartPole::pole_thickness, "side of the pole's square section", non_negative, "m"),
      field("force_limit", &CartPole::force_limit, "the actuator saturates at plus and minus this", positive, "N"),
      field("rail", &CartPole::rail, "the rail ends at plus and minus this", positive, "m"),
      field("x_limit", &CartPole::x_limit, "the episode fails beyond this position", positive, "m"),
      field("theta_limit", &CartPole::theta_limit, "the episode fails beyond this angle", positive, "rad"),
      field("tap_point", &CartPole::tap_point, "where the dynamics site pulls: centre of mass or tip of the pole",
            one_of("com|tip")),
      field("control_rate", &CartPole::control_rate, "how often the policy acts", positive, "Hz"),
      field("physics_rate", &CartPole::physics_rate, "integration steps; a multiple of control_rate", positive, "Hz"),
      field("steps", &CartPole::steps, "control steps in an episode", between(1, 1'000'000)),
      field("normalized_action", &CartPole::normalized_action, "the policy acts in [-1, 1] times force_limit"),
      field("goal", &CartPole::goal, "state to hold: x, x_dot, theta, theta_dot"),
      field("start", &CartPole::start, "nominal initial state"),
      field("start_range", &CartPole::start_range, "random starts are start + U(-range, range)", non_negative),
      field("state_weights", &CartPole::state_weights, "w of the reward exp(-sum w e^2 - w_u u^2)", non_negative),
      field("action_weight", &CartPole::action_weight, "w_u of the reward", non_negative, "1/N^2"),
  };

  void check(const Place& place) const {
    const double ratio = physics_rate / control_rate;
    if (ratio != std::round(ratio) || ratio < 1 || ratio > 1e6) {
      throw error_at(place, "'physics_rate' must be a whole multiple of 'control_rate', got ", physics_rate, " and ",
                     control_rate);
    }
    const auto four = [&](const std::vector<double>& list, const char* name) {
      if (list.size() == 4) return;
      throw error_at(place, "'", name, "' must have 4 numbers (x, x_dot, theta, theta_dot), got ", list.size());
    };
    four(goal, "goal");
    four(start, "start");
    four(start_range, "start_range");
    four(state_weights, "state_weights");
  }

  PlantSpec spec() const;

  void reference(std::size_t, std::span<double> state) const noexcept { std::ranges::copy(goal, state.begin()); }
  bool near_ground(std::span<const double>) const noexcept { return false; }
  template <class T>
  void remember(T*, bool) const noexcept {}

  template <class T>
  struct Law {
    T ml, total, inertia, weight, lever;
    double rail_end;

    Law(const CartPole& options, const T* parameters) : rail_end(options.rail) {
      const T l = parameters[0];
      const T m = parameters[1];
      ml = m * l;
      total = parameters[2] + m;
      inertia = m * (options.pole_thickness * options.pole_thickness + 4.0 * l * l) / 12.0 + ml * l;
      weight = ml * options.gravity;
      lever = l * (options.tap_point.front() == 't' ? 2.0 : 1.0);  // tip or com; a whole comparison would cost a step
    }

    void start(T*) const {}

    [[gnu::always_inline]] inline void substep(T* state, const T* action, const T* force, double dt) const {
      const T x = state[0];
      const auto [sine, cosine] = sin_cos(state[2]);
      const T coupling = ml * cosine;
      const T push = action[0] + force[0] + ml * sine * state[3] * state[3];
      const T turn = weight * sine + lever * (force[0] * cosine - force[1] * sine);
      const T scale = dt / (total * inertia - coupling * coupling);
      state[1] = state[1] + (push * inertia - coupling * turn) * scale;
      state[3] = state[3] + (total * turn - coupling * push) * scale;
      hold_rail(state, coupling, x, dt);
      state[0] = x + dt * state[1];
      state[2] = state[2] + dt * state[3];
    }

    /// The joint limit of the reference simulator: outward speed is capped beyond the end of the rail
    /// (docs/plants.md 1.3).
    void hold_rail(T* state, const T& coupling, const T& x, double dt) const {
      const T beyond = absolute(x) - rail_end;
      if (!any(beyond > 0.0)) return;
      constexpr double kSoftDepth = 0.04;  // m; deeper, the joint only stops
      const T zero = x * 0.0;
      const T cap = select(beyond <= kSoftDepth, T(beyond * (-0.2 / dt)), zero);
      const T side = select(x < 0.0, T(zero - 1.0), T(zero + 1.0));
      const T outward = side * state[1];
      const T capped = select(beyond > 0.0, select(outward > cap, cap, outward), outward);
      const T change = side * (capped - outward);
      state[1] = state[1] + change;
      state[3] = state[3] - coupling / inertia * change;
    }
  };
};

PlantSpec CartPole::spec() const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  PlantSpec spec;
  spec.state = {{"x", "m"}, {"x_dot", "m/s"}, {"theta", "rad"}, {"theta_dot", "rad/s"}};
  spec.action = {{"force", "N"}};
  spec.force = {{"fx", "N"}, {"fz", "N"}};
  spec.parameters = {{"pole_length", "m", pole_length}, {"pole_mass", "kg", pole_mass}, {"cart_mass", "kg", cart_mass}};
  spec.control_rate = control_rate;
  spec.physics_rate = physics_rate;
  spec.steps = steps;
  spec.normalized_action = normalized_action;
  spec.action_scale = {normalized_action ? force_limit : 1.0};
  spec.action_offset = {0.0};
  spec.action_low = {-force_limit};
  spec.action_high = {force_limit};
  spec.start = start;
  spec.start_offset = {0, 0, 0, 0};
  spec.start_range = start_range;
  spec.fail_low = {-x_limit, -kNever, -theta_limit, -kNever};
  spec.fail_high = {x_limit, kNever, theta_limit, kNever};
  spec.wraps = {false, false, true, false};
  spec.state_weights = state_weights;
  spec.action_weight = action_weight;
  spec.action_goal = {0.0};
  spec.error_weights = {1, 0, 1, 0};
  spec.angle = 2;
  return spec;
}

}  // namespace

Entry<Plant> plant_cartpole() {
  return plant_entry<CartPole>("cartpole", "Pole hinged on a cart that a force pushes along a rail; hold it upright.",
                               "Glossop et al. 2022; safe-control-gym's cart-pole in PyBullet (docs/plants.md 1)");
}

}  // namespace gust
