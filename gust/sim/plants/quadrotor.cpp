#include <algorithm>
#include <cmath>

#include "gust/sim/plant_entry.h"
#include "gust/sim/trajectory.h"

namespace gust {
namespace {

/// Quadrotor in a vertical plane. The actions T1, T2 [N] are the thrusts of its two pairs of rotors, at the lever a on
/// either side; the dynamics site (w_x, w_z) [N], world axes, is wind at its centre of mass. M mass, I moment of
/// inertia.
///
///   M x''  = (T1 + T2) sin th + w_x
///   M z''  = (T1 + T2) cos th - M g + w_z
///   I th'' = a (T2 - T1)
///
/// State: x [m], x' [m/s], z [m], z' [m/s], th [rad, 0 level, positive tips the thrust to +x], th' [rad/s].
/// Semi-implicit Euler; at the floor z is held and a fall ends (docs/plants.md 2.2, an approximation of the contact).
///
/// Artefacts of the reference simulator, off unless asked for (docs/plants.md 2.2): with thrust_lag the thrust has the
/// direction of one integration step ago, and its moment the factor cos(th - th_old); with wind_stale_point the wind
/// pulls at where the body was when the control step began, and its moment is taken about where it was one integration
/// step ago; damping c adds -v (c + c |v|) to the acceleration and the same to the turning. Checked against
/// tests/reference/traj (PyBullet).
struct Quadrotor {
  static constexpr int kStates = 6;
  static constexpr int kHidden = 6;  // th, x, z one substep ago; x, z when the control step began; contact
  static constexpr int kActions = 2;
  static constexpr int kForces = 2;
  static constexpr int kParameters = 2;

  double mass = 0.027;
  double inertia = 1.4e-5;
  double arm = 0.028;
  double gravity = 9.8;
  double thrust_low = 0.056323375552892685;  // 2 kf (0.2685 pwm + 4070.3)^2 at pwm 20000 and 65535 (docs/plants.md 2.1)
  double thrust_high = 0.2966828942298889;
  double hover_mass = 0.027;
  double floor = -0.0365;
  double x_limit = 2.0;
  double z_low = -0.05;
  double z_high = 2.0;
  double theta_limit = 1.4835298641951802;
  std::string artefacts = "clean";
  double damping = 0.0;
  double control_rate = 50.0;
  double physics_rate = 1000.0;
  std::int64_t steps = 250;
  bool normalized_action = true;
  double act_scale = 0.1;
  std::string task = "track";
  std::vector<double> goal = {0, 0, 1, 0, 0, 0};
  std::string trajectory = "circle";
  std::string trajectory_plane = "zx";
  double trajectory_scale = -0.5;
  double trajectory_cycles = 1.0;
  std::vector<double> trajectory_offset = {0.5, 0};
  std::int64_t horizon = 1;
  std::string reference_index = "next";
  std::vector<double> start = {0, 0, 0, 0, 0, 0};
  std::vector<double> start_offset = {0, 0, 0.1, 0, 0, 0};
  std::vector<double> start_range = {0.1, 0, 0.1, 0, 0.1, 0};
  std::vector<double> state_weights = {1, 0, 1, 0, 0, 0};
  double action_weight = 0.0;

  static constexpr std::tuple kFields = {
      field("mass", &Quadrotor::mass, "mass of the whole", positive, "kg"),
      field("inertia", &Quadrotor::inertia, "moment of inertia about the pitch axis", positive, "kg m^2"),
      field("arm", &Quadrotor::arm, "lever of each pair of rotors", positive, "m"),
      field("gravity", &Quadrotor::gravity, "acceleration of gravity", non_negative, "m/s^2"),
      field("thrust_low", &Quadrotor::thrust_low, "least thrust of a pair of rotors", non_negative, "N"),
      field("thrust_high", &Quadrotor::thrust_high, "greatest thrust of a pair of rotors", positive, "N"),
      field("hover_mass", &Quadrotor::hover_mass, "a normalised action of 0 carries the weight of this", positive,
            "kg"),
      field("floor", &Quadrotor::floor, "the body rests at this height", anything, "m"),
      field("x_limit", &Quadrotor::x_limit, "the episode fails beyond this position", positive, "m"),
      field("z_low", &Quadrotor::z_low, "the episode fails below this height", anything, "m"),
      field("z_high", &Quadrotor::z_high, "the episode fails above this height", anything, "m"),
      field("theta_limit", &Quadrotor::theta_limit, "the episode fails beyond this pitch", positive, "rad"),
      field("artefacts", &Quadrotor::artefacts,
            "scg: thrust and wind act one integration step late, as in the reference simulator; clean: plain physics",
            one_of("clean|scg")),
      field("damping", &Quadrotor::damping, "linear and angular, of which the reference simulator has 0.04 or none",
            non_negative, "1/s"),
      field("control_rate", &Quadrotor::control_rate, "how often the policy acts", positive, "Hz"),
      field("physics_rate", &Quadrotor::physics_rate, "integration steps; a multiple of control_rate", positive, "Hz"),
      field("steps", &Quadrotor::steps, "control steps in an episode", between(1, 1'000'000)),
      field("normalized_action", &Quadrotor::normalized_action,
            "the policy acts in [-1, 1]: thrust = hover (1 + act_scale action)"),
      field("act_scale", &Quadrotor::act_scale, "authority of a normalised action, as a share of hover", positive),
      field("task", &Quadrotor::task, "track the trajectory, or hold the goal", one_of("track|stabilise")),
      field("goal", &Quadrotor::goal, "state to hold: x, x_dot, z, z_dot, theta, theta_dot"),
      field("trajectory", &Quadrotor::trajectory, "shape of the reference", one_of("circle|figure8|square")),
      field("trajectory_plane", &Quadrotor::trajectory_plane, "axes in which the shape is drawn", one_of("zx|xz")),
      field("trajectory_scale", &Quadrotor::trajectory_scale, "radius of a circle, half width, or side", anything, "m"),
      field("trajectory_cycles", &Quadrotor::trajectory_cycles, "rounds in an episode", positive),
      field("trajectory_offset", &Quadrotor::trajectory_offset, "where the shape's origin lies, in its axes", anything,
            "m"),
      field("horizon", &Quadrotor::horizon, "reference states that follow the state in the observation",
            between(0, 100)),
      field("reference_index", &Quadrotor::reference_index,
            "next: the state after step k is compared with reference k + 1, and the observation goes on from k + 2; "
            "current: with reference k, as the 2022 code did",
            one_of("next|current")),
      field("start", &Quadrotor::start, "nominal initial state"),
      field("start_offset", &Quadrotor::start_offset, "random starts are start + start_offset + U(-range, range)"),
      field("start_range", &Quadrotor::start_range, "half the width of the random starts", non_negative),
      field("state_weights", &Quadrotor::state_weights, "w of the reward exp(-sum w e^2 - w_u sum (u - hover)^2)",
            non_negative),
      field("action_weight", &Quadrotor::action_weight, "w_u of the reward", non_negative, "1/N^2"),
  };

  void check(const Place& place) const;
  PlantSpec spec() const;
  Cascade cascade() const;
  void reference(std::size_t sample, std::span<double> state) const noexcept;

  /// Hidden rows: at rest what was one substep ago is what is; else it follows from the rates.
  template <class T>
  void remember(T* state, bool moving) const noexcept {
    const double back = moving ? 1.0 / physics_rate : 0.0;
    state[kOldTheta] = state[4] - back * state[5];
    state[kOldX] = state[0] - back * state[1];
    state[kOldZ] = state[2] - back * state[3];
    state[kStepX] = state[0];
    state[kStepZ] = state[2];
    state[kContact] = state[0] * 0.0;
  }

  /// The rim of a tilted body comes down first.
  bool near_ground(std::span<const double> state) const noexcept {
    constexpr double kRadius = 0.06;  // m
    constexpr double kMargin = 0.002;
    return state[2] < floor + kRadius * absolute(sin_cos(state[4]).sin) + kMargin;
  }

  bool tracks() const { return task == "track"; }
  Limits hover_masses(double least_thrust, double most_thrust) const {
    return {2.0 * least_thrust / gravity, 2.0 * most_thrust / gravity};
  }

  enum Hidden { kOldTheta = kStates, kOldX, kOldZ, kStepX, kStepZ, kContact };

  template <class T>
  struct Law {
    T per_mass, per_inertia;
    double arm, gravity, floor, damping;
    bool late;

    Law(const Quadrotor& options, const T* parameters)
        : per_mass(1.0 / parameters[0]),
          per_inertia(1.0 / parameters[1]),
          arm(options.arm),
          gravity(options.gravity),
          floor(options.floor),
          damping(options.damping),
          late(options.artefacts.front() == 's') {}

    void start(T* state) const {
      state[kStepX] = state[0];
      state[kStepZ] = state[2];
    }

    [[gnu::always_inline]] inline void substep(T* state, const T* action, const T* force, double dt) const {
      const T thrust = action[0] + action[1];
      T moment = arm * (action[1] - action[0]);
      T direction = state[4];
      if (late) {
        direction = state[kOldTheta];
        moment = moment * sin_cos(state[4] - direction).cos + (state[kStepZ] - state[kOldZ]) * force[0] -
                 (state[kStepX] - state[kOldX]) * force[1];
        state[kOldTheta] = state[4];
        state[kOldX] = state[0];
        state[kOldZ] = state[2];
      }
      const auto [sine, cosine] = sin_cos(direction);
      T x_acc = (thrust * sine + force[0]) * per_mass;
      T z_acc = (thrust * cosine + force[1]) * per_mass - gravity;
      T turn = moment * per_inertia;
      if (damping > 0.0) damp(state, x_acc, z_acc, turn);
      state[1] = state[1] + dt * x_acc;
      state[3] = state[3] + dt * z_acc;
      state[5] = state[5] + dt * turn;
      state[0] = state[0] + dt * state[1];
      state[2] = state[2] + dt * state[3];
      state[4] = state[4] + dt * state[5];
      hold_floor(state);
    }

    void damp(const T* state, T& x_acc, T& z_acc, T& turn) const {
      const T speed = root(state[1] * state[1] + state[3] * state[3]);
      const T drag = damping + damping * speed;
      x_acc = x_acc - state[1] * drag;
      z_acc = z_acc - state[3] * drag;
      turn = turn - state[5] * (damping + damping * absolute(state[5]));
    }

    /// Inelastic: the body stays at the floor until a thrust lifts it.
    [[gnu::always_inline]] inline void hold_floor(T* state) const {
      const auto below = state[2] < floor;
      if (!any(below)) return;
      const T zero = state[2] * 0.0;
      state[2] = select(below, T(zero + floor), state[2]);
      state[3] = select(below, select(state[3] < 0.0, zero, state[3]), state[3]);
      state[kContact] = select(below, T(zero + 1.0), state[kContact]);
    }
  };
};

void Quadrotor::check(const Place& place) const {
  const double ratio = physics_rate / control_rate;
  if (ratio != std::round(ratio) || ratio < 1 || ratio > 1e6) {
    throw error_at(place, "'physics_rate' must be a whole multiple of 'control_rate', got ", physics_rate, " and ",
                   control_rate);
  }
  const auto six = [&](const std::vector<double>& list, const char* name) {
    if (list.size() == 6) return;
    throw error_at(place, "'", name, "' must have 6 numbers (x, x_dot, z, z_dot, theta, theta_dot), got ", list.size());
  };
  six(goal, "goal");
  six(start, "start");
  six(start_offset, "start_offset");
  six(start_range, "start_range");
  six(state_weights, "state_weights");
  if (trajectory_offset.size() != 2) {
    throw error_at(place, "'trajectory_offset' must have 2 numbers, got ", trajectory_offset.size());
  }
  if (thrust_low >= thrust_high) {
    throw error_at(place, "'thrust_low' must be below 'thrust_high', got ", thrust_low, " and ", thrust_high);
  }
  if (z_low >= z_high) throw error_at(place, "'z_low' must be below 'z_high', got ", z_low, " and ", z_high);
}

void Quadrotor::reference(std::size_t sample, std::span<double> state) const noexcept {
  std::ranges::copy(goal, state.begin());
  if (!tracks()) return;
  const double period = static_cast<double>(steps) / control_rate / trajectory_cycles;
  const double time = static_cast<double>(sample) / control_rate;
  const CurvePosition at = curve_position({trajectory, trajectory_scale, period}, time);
  const std::size_t a = trajectory_plane == "zx" ? 2 : 0;
  const std::size_t b = 2 - a;
  state[a] = trajectory_offset[0] + at.a;
  state[a + 1] = at.a_dot;
  state[b] = trajectory_offset[1] + at.b;
  state[b + 1] = at.b_dot;
  state[4] = 0.0;
  state[5] = 0.0;
}

PlantSpec Quadrotor::spec() const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double hover = hover_mass * gravity / 2.0;
  const double authority = act_scale * hover;
  PlantSpec spec;
  spec.state = {{"x", "m"}, {"x_dot", "m/s"}, {"z", "m"}, {"z_dot", "m/s"}, {"theta", "rad"}, {"theta_dot", "rad/s"}};
  spec.action = {{"T1", "N"}, {"T2", "N"}};
  spec.force = {{"fx", "N"}, {"fz", "N"}};
  spec.parameters = {{"mass", "kg", mass, hover_masses(thrust_low, thrust_high),
                      normalized_action ? hover_masses(std::max(thrust_low, hover - authority),
                                                       std::min(thrust_high, hover + authority))
                                        : hover_masses(thrust_low, thrust_high)},
                     {"inertia", "kg m^2", inertia}};
  spec.hidden = kHidden;
  spec.contact = kContact;
  spec.ground = true;
  spec.control_rate = control_rate;
  spec.physics_rate = physics_rate;
  spec.steps = steps;
  spec.horizon = tracks() ? static_cast<std::size_t>(horizon) : std::min<std::size_t>(horizon, 1);
  spec.references = tracks() ? static_cast<std::size_t>(steps) + (reference_index == "next" ? 1 : 0) : 1;
  spec.reference_lag = reference_index == "next" ? 0 : 1;
  spec.normalized_action = normalized_action;
  spec.action_scale = {normalized_action ? authority : 1.0, normalized_action ? authority : 1.0};
  spec.action_offset = {normalized_action ? hover : 0.0, normalized_action ? hover : 0.0};
  spec.action_low = {thrust_low, thrust_low};
  spec.action_high = {thrust_high, thrust_high};
  spec.start = start;
  spec.start_offset = start_offset;
  spec.start_range = start_range;
  spec.fail_low = {-x_limit, -kNever, z_low, -kNever, -theta_limit, -kNever};
  spec.fail_high = {x_limit, kNever, z_high, kNever, theta_limit, kNever};
  spec.wraps = {false, false, false, false, false, false};
  spec.state_weights = state_weights;
  spec.action_weight = action_weight;
  spec.action_goal = {mass * gravity / 2.0, mass * gravity / 2.0};
  spec.error_weights = {1, 0, 1, 0, 0, 0};
  spec.angle = 4;
  spec.cascade = cascade();
  return spec;
}

/// The gains with which the reference simulator's circle was recorded, at nominal mass and inertia.
Cascade Quadrotor::cascade() const {
  Cascade cascade{{2.1, 1.05, 0, 0, 0, 0}, 0.3, Eigen::MatrixXd(2, 6), Eigen::VectorXd(2)};
  const double lift = mass / 2.0;
  const double twist = inertia / (2.0 * arm);
  cascade.inner << 0, 0, 40.0 * lift, 13.0 * lift, -225.0 * twist, -30.0 * twist,  //
      0, 0, 40.0 * lift, 13.0 * lift, 225.0 * twist, 30.0 * twist;
  cascade.rest.setConstant(mass * gravity / 2.0);
  return cascade;
}

}  // namespace

Entry<Plant> plant_quadrotor() {
  return plant_entry<Quadrotor>("quadrotor", "Quadrotor in a vertical plane that tracks a curve or holds a point.",
                                "Glossop et al. 2022; safe-control-gym's quadrotor_2D in PyBullet (docs/plants.md 2)");
}

}  // namespace gust
