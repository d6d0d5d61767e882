#include <algorithm>
#include <limits>

#include "gust/control/policy_interface.h"
#include "gust/control/tracking.h"
#include "gust/core/math.h"
#include "gust/study/policies/policy_entry.h"

namespace gust {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// One loop as it is written, in the units of the user.
struct PidLoop {
  Written of{"required", "text"};
  Written to{"the only action", "text"};
  double kp = 0;
  double ki = 0;
  double kd = 0;
  double filter = 0;
  double low = -kNoLimit;
  double high = kNoLimit;
  std::string windup = "clamp";
  double tracking = 0;
  std::string derivative = "error";

  static constexpr std::tuple kFields = {
      field("of", &PidLoop::of, "the state that the loop controls"),
      field(
          "to", &PidLoop::to,
          "what it gives: an action, by default the only one, or a state, to whose reference it is added, and which a "
          "later loop controls: a cascade"),
      field("kp", &PidLoop::kp, "proportional gain", anything, "output per unit of the state"),
      field("ki", &PidLoop::ki, "integral gain", anything, "kp per s"),
      field("kd", &PidLoop::kd, "derivative gain", anything, "kp times s"),
      field("filter", &PidLoop::filter, "time constant of the low-pass filter of the derivative; 0 filters nothing",
            non_negative, "s"),
      field("low", &PidLoop::low, "least output, below 'high'", anything, "output"),
      field("high", &PidLoop::high, "greatest output", anything, "output"),
      field("windup", &PidLoop::windup,
            "what the integral does at a limit: clamp holds it, where it would go on beyond; back pulls it back with "
            "the time constant 'tracking'; none lets it grow",
            one_of("clamp|back|none")),
      field("tracking", &PidLoop::tracking, "time constant of windup = \"back\"; 0 is kp / ki", non_negative, "s"),
      field("derivative", &PidLoop::derivative,
            "of what: the error, or the measurement alone, which steps of the reference do not kick",
            one_of("error|measurement")),
  };
};

/// One loop as it is computed, in SI units.
struct LoopLaw {
  enum class Windup { kClamp, kBack, kNone };

  std::size_t of = 0;  ///< state
  bool to_action = true;
  std::size_t to = 0;  ///< action, or state
  double kp = 0, ki = 0, kd = 0, filter = 0, low = 0, high = 0;
  Windup windup = Windup::kClamp;
  double tracking = 0;
  bool on_measurement = false;
  std::size_t integral = 0, slope = 0, last = 0;  ///< rows of the memory, of loops with ki or kd
};

/// docs/policies.md 4.
class PidPolicy final : public Policy {
 public:
  PidPolicy(const Plant& plant, std::vector<LoopLaw> loops, std::vector<double> rest, std::vector<Component> memory)
      : loops_(std::move(loops)),
        rest_(std::move(rest)),
        components_(std::move(memory)),
        observations_(plant.spec().observations()),
        knots_(reference_knots(plant, {})),
        scale_(plant.spec().action_scale),
        offset_(plant.spec().action_offset),
        period_(1.0 / plant.spec().control_rate),
        aim_(plant.spec().state.size()),
        action_(rest_.size()) {}

  std::size_t observations() const override { return observations_; }
  std::size_t actions() const override { return rest_.size(); }
  std::vector<Component> memory() const override { return components_; }
  Rows<const double> remembered() const override { return memory_.view(); }

  void act(Rows<const double> observation, std::span<const std::int64_t> step, Rows<double> action) override {
    const bool all_anew = memory_.lanes() != action.lanes;
    if (all_anew) memory_ = Matrix<double>(components_.size(), action.lanes);
    for (std::size_t lane = 0; lane < action.lanes; ++lane) {
      const FeedbackKnot& knot = knots_[std::min(static_cast<std::size_t>(step[lane]), knots_.size() - 1)];
      for (std::size_t i = 0; i < aim_.size(); ++i) aim_[i] = knot.state[static_cast<Eigen::Index>(i)];
      action_ = rest_;
      for (const LoopLaw& loop : loops_) {
        const double value = observation.at(loop.of, lane);
        const double output = run(loop, lane, value, all_anew || step[lane] == 0);
        (loop.to_action ? action_ : aim_)[loop.to] += output;
      }
      for (std::size_t i = 0; i < action_.size(); ++i) action.at(i, lane) = (action_[i] - offset_[i]) / scale_[i];
    }
  }

 private:
  double run(const LoopLaw& loop, std::size_t lane, double value, bool anew) {
    const double error = aim_[loop.of] - value;
    double integral = 0, slope = 0;
    if (loop.ki != 0) integral = anew ? 0.0 : memory_.at(loop.integral, lane);
    if (loop.kd != 0) slope = derivative(loop, lane, loop.on_measurement ? value : error, anew);
    const double wanted = loop.kp * error + integral + slope;
    const double output = clip(wanted, loop.low, loop.high);
    if (loop.ki != 0) memory_.at(loop.integral, lane) = integral + growth(loop, error, wanted, output);
    return output;
  }

  double derivative(const LoopLaw& loop, std::size_t lane, double input, bool anew) {
    const double last = anew ? input : memory_.at(loop.last, lane);
    const double before = anew ? 0.0 : memory_.at(loop.slope, lane);
    const double gain = loop.on_measurement ? -loop.kd : loop.kd;
    const double slope = (loop.filter * before + gain * (input - last)) / (loop.filter + period_);
    memory_.at(loop.last, lane) = input;
    memory_.at(loop.slope, lane) = slope;
    return slope;
  }

  /// What the integral takes up for the next step.
  double growth(const LoopLaw& loop, double error, double wanted, double output) const {
    const double step = loop.ki * period_ * error;
    if (loop.windup == LoopLaw::Windup::kBack) return step + period_ / loop.tracking * (output - wanted);
    const bool beyond = (wanted > loop.high && step > 0) || (wanted < loop.low && step < 0);
    return loop.windup == LoopLaw::Windup::kClamp && beyond ? 0.0 : step;
  }

  std::vector<LoopLaw> loops_;
  std::vector<double> rest_;
  std::vector<Component> components_;
  std::size_t observations_;
  std::vector<FeedbackKnot> knots_;
  std::vector<double> scale_, offset_;
  double period_;
  std::vector<double> aim_, action_;  // scratch: what the loops of one lane aim at and give
  Matrix<double> memory_;
};

std::vector<std::string> names_of(const std::vector<Component>& components) {
  std::vector<std::string> names;
  for (const Component& component : components) names.push_back(component.name);
  return names;
}

struct Pid final : PolicySource, PidLoop {
  Written loops{"the one loop of the keys above", "list of tables"};
  Written units{"SI units", "table or text"};
  Written u0{"what holds the goal", "list of numbers"};

  static constexpr std::tuple kFields = std::tuple_cat(
      PidLoop::kFields,
      std::tuple{
          field("loops", &Pid::loops,
                "several loops, each a table of the keys above, computed in this order; outputs to one action add up"),
          field("units", &Pid::units,
                "units by name of state and action, { theta = \"deg\", force = \"%\" }, or one unit of all actions"),
          field("u0", &Pid::u0,
                "the action without an output, in the unit of the actions; by default what holds the goal")});

  void prepare(const PolicyContext& context) override {
    const PlantSpec& spec = context.equations("pid").spec();
    const NamedUnits named = read_units(units ? &*units : nullptr, spec);
    if (!loops) add_loop(*this, context.place, named, spec);
    const bool one = of || to || canonical_fields<PidLoop>(*this) != canonical_fields(PidLoop{});
    if (loops && one) throw error_at(loops->place, "the keys of one loop stand beside 'loops'; put them into it");
    if (loops && loops->as_list("loops").empty()) throw error_at(loops->place, "'loops' must have at least one loop");
    for (const Value& item : loops ? loops->as_list("loops") : Value::List{}) {
      PidLoop loop;
      read_fields(loop, item.as_table("loops"), "a loop of a policy of kind pid");
      add_loop(loop, item.place, named, spec);
    }
    for (std::size_t i = 0; i < loops_.size(); ++i) check_cascade(i, spec);
    const std::vector<double> own =
        numbers_or(u0, "u0", std::vector<double>(spec.action.size()), join(names_of(spec.action), ", "));
    rest_ = spec.action_goal;
    for (std::size_t i = 0; u0 && i < own.size(); ++i)
      rest_[i] = named.action[i].scale * own[i] + named.action[i].offset;
  }

  std::string canonical(const PolicyMember&) const override {
    static constexpr std::string_view kWindups[] = {"clamp", "back", "none"};
    std::string text = "pid";
    for (const LoopLaw& loop : loops_) {
      text += cat(" loop ", loop.of, loop.to_action ? " action " : " state ", loop.to, " kp ", loop.kp, " ki ", loop.ki,
                  " kd ", loop.kd, " filter ", loop.filter, " low ", loop.low, " high ", loop.high, " windup ",
                  kWindups[static_cast<int>(loop.windup)], " tracking ", loop.tracking, " derivative ",
                  loop.on_measurement ? "measurement" : "error");
    }
    return cat(text, " u0 ", canonical_text(rest_), "\n");
  }

  std::unique_ptr<Policy> make(const Setup& setup, const PolicyMember&) const override {
    return std::make_unique<PidPolicy>(setup.equations("pid", {}), loops_, rest_, memory_);
  }

 private:
  void add_loop(const PidLoop& written, const Place& place, const NamedUnits& named, const Interface& spec) {
    LoopLaw loop;
    loop.of = named_in(spec.state, written.of, "of", place);
    aim_at(loop, written, place, spec);
    const double output = loop.to_action ? named.action[loop.to].scale : 1 / named.state[loop.to];
    const double gain = output * named.state[loop.of];
    loop.kp = gain * written.kp;
    loop.ki = gain * written.ki;
    loop.kd = gain * written.kd;
    loop.filter = written.filter;
    if (!(written.low < written.high))
      throw error_at(place, "'low' must be less than 'high', got ", written.low, " and ", written.high);
    loop.low = output * written.low;
    loop.high = output * written.high;
    set_windup(loop, written, place);
    loop.on_measurement = written.derivative == "measurement";
    if (loop.kp == 0 && loop.ki == 0 && loop.kd == 0)
      throw error_at(place, "the loop of ", spec.state[loop.of].name, " does nothing; give it a 'kp', 'ki' or 'kd'");
    for (const LoopLaw& other : loops_) {
      if (other.of == loop.of && other.to_action == loop.to_action && other.to == loop.to)
        throw error_at(place, "two loops are of ", spec.state[loop.of].name, " to the same output; make them one");
    }
    remember(loop, spec);
    loops_.push_back(loop);
    places_.push_back(place);
  }

  /// Which of the components a key names.
  static std::size_t named_in(const std::vector<Component>& components, const Written& written, std::string_view key,
                              const Place& loop) {
    const std::vector<std::string> names = names_of(components);
    if (!written) throw error_at(loop, "a loop of a pid policy needs '", key, "'; choose from ", join(names, ", "));
    const std::string& name = written->as_text(key);
    const auto at = std::ranges::find(names, name);
    if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
    throw error_at(written->place, "'", key, "': unknown component '", name, "'", did_you_mean(name, names),
                   "; choose from ", join(names, ", "));
  }

  static void aim_at(LoopLaw& loop, const PidLoop& written, const Place& place, const Interface& spec) {
    if (!written.to && spec.action.size() == 1) return;  // the only action
    std::vector<Component> all = spec.action;
    all.insert(all.end(), spec.state.begin(), spec.state.end());
    loop.to = named_in(all, written.to, "to", place);
    loop.to_action = loop.to < spec.action.size();
    if (!loop.to_action) loop.to -= spec.action.size();
  }

  static void set_windup(LoopLaw& loop, const PidLoop& written, const Place& place) {
    loop.windup = written.windup == "clamp"  ? LoopLaw::Windup::kClamp
                  : written.windup == "back" ? LoopLaw::Windup::kBack
                                             : LoopLaw::Windup::kNone;
    if (loop.windup != LoopLaw::Windup::kBack) return;
    loop.tracking = written.tracking > 0 ? written.tracking : written.ki == 0 ? 1.0 : written.kp / written.ki;
    if (!(loop.tracking > 0))
      throw error_at(place, "windup = \"back\" needs a 'tracking' > 0, since kp / ki is ", loop.tracking);
  }

  /// What the loop keeps from one control step to the next.
  void remember(LoopLaw& loop, const Interface& spec) {
    const Component& of = spec.state[loop.of];
    const Component& to = loop.to_action ? spec.action[loop.to] : spec.state[loop.to];
    const std::string which = cat(" of ", of.name, " to ", to.name);
    const auto add = [&](std::string_view what, const std::string& unit) {
      memory_.push_back({cat(what, which), unit});
      return memory_.size() - 1;
    };
    if (loop.ki != 0) loop.integral = add("integral", to.unit);
    if (loop.kd == 0) return;
    loop.slope = add("derivative", to.unit);
    loop.last = add(loop.on_measurement ? "last value" : "last error", of.unit);
  }

  /// A loop that gives a reference stands before every loop that follows it, and there is one.
  void check_cascade(std::size_t outer, const Interface& spec) const {
    if (loops_[outer].to_action) return;
    const std::string& state = spec.state[loops_[outer].to].name;
    bool followed = false;
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      if (loops_[i].of != loops_[outer].to) continue;
      if (i <= outer)
        throw error_at(places_[i], "the loop of ", state, " must come after the one that gives its reference");
      followed = true;
    }
    if (!followed) throw error_at(places_[outer], "no loop is of ", state, ", whose reference this one gives");
  }

  std::vector<LoopLaw> loops_;
  std::vector<Place> places_;  // where each is written
  std::vector<double> rest_;
  std::vector<Component> memory_;
};

}  // namespace

PolicyKind policy_pid() {
  return policy_entry<Pid>(
      {"pid",
       "Loops with proportional, integral and derivative parts about the reference, side by side or in a cascade, with "
       "a filtered derivative, limits and anti-windup.",
       "docs/policies.md 4",
       "[[policy]]\nname  = \"bench pid\"\nkind  = \"pid\"\nunits = { theta = \"deg\", force = \"N\" }\nloops = [\n"
       "  { of = \"x\", to = \"theta\", kp = 4.6, kd = 8.6, filter = 0.04, low = -6, high = 6 },\n"
       "  { of = \"theta\", to = \"force\", kp = -1.6, ki = -0.2, kd = -0.26, derivative = \"measurement\", low = -10, "
       "high = "
       "10 },\n]"});
}

}  // namespace gust
