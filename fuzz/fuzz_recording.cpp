#include <cstdint>
#include <exception>
#include <string_view>

#include "gust/control/validate.h"

/// Input: a recording's JSON file, a line of four dashes, its CSV file. Whatever it is, reading gives a recording or
/// one Error; and a short recording can be validated.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  constexpr std::string_view kSeparator = "\n----\n";
  const std::size_t at = input.find(kSeparator);
  const std::string_view json = input.substr(0, at);
  const std::string_view csv = at == input.npos ? std::string_view{} : input.substr(at + kSeparator.size());
  try {
    const gust::Recording recording = gust::read_recording({json, "fuzz.json"}, {csv, "fuzz.csv"});
    const gust::PlantSpec& spec = recording.plant->spec();
    constexpr double kSoon = 1e5;  // substeps that take no noticeable time
    if (spec.physics_rate / spec.control_rate * static_cast<double>(spec.steps) > kSoon) return 0;
    const gust::Validation result = gust::validate(recording, {});
    if (result.one_step.size() != spec.state.size()) std::terminate();
  } catch (const gust::Error&) {
  }
  return 0;
}
