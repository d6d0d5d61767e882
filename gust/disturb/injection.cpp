#include "gust/disturb/injection.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gust {
namespace {

constexpr std::string_view kSiteNames[] = {"observation", "action", "dynamics"};

std::vector<std::string> names_of(const std::vector<Component>& components) {
  std::vector<std::string> names;
  for (const Component& component : components) names.push_back(component.name);
  return names;
}

std::size_t channel_index(const std::vector<std::string>& names, const std::string& name, const Place& place) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
  throw error_at(place, "unknown channel '", name, "'", did_you_mean(name, names), "; the site has ",
                 join(names, ", "));
}

/// "all", a name, a list of names, or a table of factors.
std::vector<double> read_channels(const Value& value, const std::vector<std::string>& names) {
  if (const auto* text = std::get_if<std::string>(&value.data); text && *text == "all") {
    return std::vector<double>(names.size(), 1.0);
  }
  std::vector<double> factors(names.size(), 0.0);
  if (const auto* table = std::get_if<Table>(&value.data)) {
    for (const auto& [name, factor] : table->items) {
      factors[channel_index(names, name, factor.place)] = factor.as_number(name);
    }
  } else if (std::holds_alternative<std::string>(value.data)) {
    factors[channel_index(names, value.as_text("channels"), value.place)] = 1.0;
  } else {
    for (const Value& name : value.as_list("channels")) {
      factors[channel_index(names, name.as_text("channels"), name.place)] = 1.0;
    }
  }
  return factors;
}

/// One factor per channel, or a word of digits such as "10".
std::vector<double> read_mask(const Value& value, std::size_t channels) {
  std::vector<double> mask;
  const auto* number = std::get_if<std::int64_t>(&value.data);
  const std::string digits = number                                            ? cat(*number)
                             : std::holds_alternative<std::string>(value.data) ? value.as_text("mask")
                                                                               : "";
  if (digits.empty()) {
    mask = value.as_numbers("mask");
  } else {
    for (const char digit : digits) {
      if (digit != '0' && digit != '1')
        throw error_at(value.place, "'mask' must be made of 0 and 1, got '", digits, "'");
      mask.push_back(digit - '0');
    }
  }
  if (mask.size() != channels) {
    throw error_at(value.place, "'mask' must have ", channels, " entries, one a channel, got ", mask.size());
  }
  return mask;
}

std::int64_t read_step(const Table& table, const char* key, std::int64_t standard, std::int64_t last) {
  const Value* value = table.find(key);
  if (value == nullptr) return standard;
  const std::int64_t step = value->as_int(key);
  if (step < 0 || step > last) {
    throw error_at(value->place, "'", key, "' must lie within the episode, 0 to ", last, ", got ", step);
  }
  return step;
}

/// A kind by its name alone, or a table with its options.
template <class T>
Made<T> read_kind(const Value& value, const Catalog<T>& catalog, const char* what) {
  if (const auto* name = std::get_if<std::string>(&value.data)) {
    Table table{{{"kind", Value{*name, value.place}}}, value.place};
    return catalog.make(table);
  }
  return catalog.make(value.as_table(what));
}

/// The waveform or the effect that a table names, one of the two.
void read_shape(const Table& table, Injection& injection) {
  const Value* waveform = table.find("waveform");
  const Value* effect = table.find("effect");
  if (waveform && effect) throw error_at(effect->place, "a disturbance has a 'waveform' or an 'effect', not both");
  if (!waveform && !effect)
    throw error_at(table.place,
                   "a disturbance needs a 'waveform' (gust list waveforms) or an 'effect' (gust list effects)");
  if (waveform) injection.waveform = read_kind(*waveform, waveforms(), "waveform");
  if (effect) injection.effect = read_kind(*effect, effects(), "effect");
}

/// An effect maps a channel or does not.
void check_effect_channels(const Injection& injection, const Value& channels) {
  if (!injection.is_effect()) return;
  for (const double factor : injection.factors) {
    if (factor != 0 && factor != 1)
      throw error_at(channels.place, "an effect maps a channel or leaves it alone: factors are 0 or 1, got ", factor);
  }
}

/// A wave that the control rate is too slow to show: sampled, it is another one or none.
void check_frequency(const Value& waveform, const Injection& injection, double rate) {
  const double frequency = injection.frequency();
  if (frequency < rate / 2) return;
  const double alias = std::abs(std::remainder(frequency, rate));
  const std::string what = alias == 0          ? std::string("it vanishes")
                           : alias == rate / 2 ? std::string("two samples a period leave nothing of its shape")
                                               : fmt::format("it acts as one of {:.6g} Hz", alias);
  const auto* table = std::get_if<Table>(&waveform.data);
  const Value* key = table ? table->find("frequency") : nullptr;
  throw error_at(key ? key->place : waveform.place, "a ", injection.waveform.kind, " of ", frequency,
                 " Hz is sampled at ", rate, " Hz: ", what, "; its frequency must be below ", rate / 2,
                 " Hz, half the control rate");
}

}  // namespace

std::string_view site_name(Site site) { return kSiteNames[static_cast<int>(site)]; }

Site site_from(std::string_view name, const Place& place) {
  for (const Site site : kSites) {
    if (name == site_name(site)) return site;
  }
  const std::vector<std::string> names(std::begin(kSiteNames), std::end(kSiteNames));
  throw error_at(place, "unknown site '", name, "'", did_you_mean(name, names), "; sites are ", join(names, ", "));
}

const std::vector<Component>& channels_of(Site site, const Interface& spec) {
  switch (site) {
    case Site::kObservation:
      return spec.measured();
    case Site::kAction:
      return spec.action;
    default:
      return spec.force;
  }
}

std::vector<std::string> sites_of(const Interface& spec) {
  std::vector<std::string> names;
  for (const Site site : kSites) {
    if (!channels_of(site, spec).empty()) names.emplace_back(site_name(site));
  }
  return names;
}

std::string Injection::canonical() const {
  const std::string window =
      end == std::numeric_limits<std::int64_t>::max() ? cat("[", start, ", end)") : cat("[", start, ", ", end, ")");
  return cat(site_name(site), " ", shape(), " channels ", canonical_text(factors), " during ", window);
}

std::string level_complaint(const Injection& injection, double level) {
  if (!injection.is_effect() || level >= 0) return {};
  return cat("the level of a ", injection.kind(), " is 0 or more ", injection.effect->unit(), ", got ", level);
}

std::string together_complaint(std::span<const Injection> injections) {
  for (const Site site : kSites) {
    const auto splits = [&](const Injection& injection) {
      return injection.site == site && injection.is_effect() && injection.effect->may_split();
    };
    if (std::ranges::count_if(injections, splits) < 2) continue;
    const std::string& kind = std::ranges::find_if(injections, splits)->kind();
    return cat("the ", site_name(site), " site has two effects such as ", kind,
               ", which change a signal within a control step; give one");
  }
  return {};
}

Injection read_injection(const Table& table, const Interface& spec, const std::vector<std::string>& also) {
  std::vector<std::string> known = {"site", "waveform", "effect", "channels", "mask", "start", "end", "level"};
  known.insert(known.end(), also.begin(), also.end());
  check_keys(table, known, "a disturbance");
  const Value* site = table.find("site");
  if (site == nullptr) throw error_at(table.place, "a disturbance needs a 'site': observation, action or dynamics");

  Injection injection;
  injection.site = site_from(site->as_text("site"), site->place);
  read_shape(table, injection);
  const std::vector<std::string> names = names_of(channels_of(injection.site, spec));
  if (names.empty())
    throw error_at(site->place, "the plant has no site '", site_name(injection.site), "'; its sites are ",
                   join(sites_of(spec), ", "));
  injection.factors.assign(names.size(), 1.0);
  for (const char* key : {"channels", "mask"}) {
    const Value* channels = table.find(key);
    if (channels == nullptr) continue;
    injection.factors =
        key == std::string_view("mask") ? read_mask(*channels, names.size()) : read_channels(*channels, names);
    check_effect_channels(injection, *channels);
  }
  injection.start = read_step(table, "start", 0, spec.steps - 1);
  injection.end = read_step(table, "end", injection.end, spec.steps);
  if (injection.end <= injection.start) {
    throw error_at(table.find("end")->place, "'end' must be after 'start', got ", injection.end, " and ",
                   injection.start);
  }
  const Value* waveform = table.find("waveform");
  if (injection.onset() >= spec.steps) {
    throw error_at(waveform->place, "the waveform's 'offset' must lie within the episode of ", spec.steps,
                   " control steps, got ", injection.onset());
  }
  if (waveform) check_frequency(*waveform, injection, spec.control_rate);
  if (const Value* level = table.find("level")) {
    injection.level = level->as_number("level");
    const std::string complaint = level_complaint(injection, injection.level);
    if (!complaint.empty()) throw error_at(level->place, complaint);
  }
  return injection;
}

Signals::Signals(std::span<const Injection> injections, const Interface& spec, Rng episode, const WaveHistory& history)
    : length_(static_cast<std::size_t>(spec.steps) + 1) {
  std::size_t channels = 0;
  for (const Injection& injection : injections) {
    first_.push_back(channels);
    channels += injection.factors.size();
  }
  values_.resize(channels * length_);
  ends_.resize(channels);
  if (history.before) ends_ = history.before->ends_;
  GUST_CHECK(ends_.size() == channels && (history.levels.empty() || history.levels.size() == injections.size()));

  std::array<std::uint64_t, std::size(kSites)> seen{};
  for (std::size_t i = 0; i < injections.size(); ++i) {
    const Injection& injection = injections[i];
    const Rng stream = episode.split(site_name(injection.site)).split(seen[static_cast<int>(injection.site)]++);
    const bool shifted = injection.site == Site::kObservation;
    if (injection.is_effect()) continue;  // it maps the signal and adds nothing
    for (std::size_t c = 0; c < injection.factors.size(); ++c) {
      const std::span<double> out(values_.data() + (first_[i] + c) * length_, length_);
      if (injection.scales()) {
        injection.waveform->fill(out, spec.control_rate, stream.split(c));
      } else {
        // One value a control step, and one more for the observation of reset; no step sees what lies behind them.
        const std::span<double> calls = shifted ? out : out.first(length_ - 1);
        const double level = history.levels.empty() ? 1.0 : history.levels[i];
        injection.waveform->go_on(ends_[first_[i] + c], calls, level, stream.split(c));
        out.back() = calls.back();
      }
      if (shifted && !injection.waveform->random()) std::copy_backward(out.begin(), out.end() - 1, out.end());
      for (std::size_t k = 0; k < length_; ++k) {
        const auto step = static_cast<std::int64_t>(shifted && k > 0 ? k - 1 : k);
        const bool on = step >= injection.start && step < injection.end;
        out[k] = on ? out[k] * injection.factors[c] : 0.0;
      }
    }
  }
}

bool all_scale(std::span<const Injection> injections) { return std::ranges::all_of(injections, &Injection::scales); }

std::shared_ptr<const Signals> SignalSequence::at(std::int64_t episode) {
  if (injections_.empty()) return nullptr;
  if (last_ && episode == next_ - 1) return last_;
  if (all_scale(injections_)) next_ = episode;
  if (episode < next_) next_ = 0;
  while (next_ <= episode) {
    const WaveHistory history{levels_, next_ > 0 ? last_.get() : nullptr};
    const Rng stream = episodes_.split(static_cast<std::uint64_t>(next_++));
    last_ = std::make_shared<Signals>(injections_, spec_, stream, history);
  }
  return last_;
}

}  // namespace gust
