#include <cstdint>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "gust/core/text.h"
#include "gust/onnx/onnx.h"
#include "gust/store/store_manifest.h"
#include "gust/study/plan/plan.h"

namespace {

/// Takes what stands before the next separator off the front of the input.
std::string_view take_section(std::string_view& input) {
  constexpr std::string_view kSeparator = "\n----\n";
  const std::size_t at = input.find(kSeparator);
  const std::string_view section = input.substr(0, at);
  input.remove_prefix(at == input.npos ? input.size() : at + kSeparator.size());
  return section;
}

/// A policy that fits the cart-pole; made anew it has the same bytes.
const std::string& small_policy() {
  static const std::string bytes = gust::write_onnx({gust::Mlp<float>({{4, 2, 1}})}, {});
  return bytes;
}

/// Finds the small policy by its name, nothing for names that say so, and else the file that the input ends with.
std::vector<gust::StudyFile> find(const std::string& pattern, const std::string& file) {
  if (pattern == "policy.onnx") return {{pattern, small_policy()}};
  if (pattern == "two*.onnx") return {{"two-1.onnx", small_policy()}, {"two-2.onnx", small_policy()}};
  if (pattern.starts_with("no")) return {};
  return {{pattern, file}};
}

/// The trials of a study can be named, each by a name that the store takes. Large studies are left out: what their
/// trials say is as long as their levels.
void plan(const gust::Study& study) {
  constexpr std::size_t kMost = 10'000;  // levels in all trials
  std::size_t levels = 0;
  for (const gust::Sweep& sweep : study.sweeps) {
    for (const gust::Sweep::Axis& axis : sweep.axes) levels += axis.values.size() + 1;
  }
  std::size_t members = 0;
  for (const gust::StudyPolicy& policy : study.policies) members += policy.count();
  if (members == 0) std::terminate();
  if ((levels + 1) * members > kMost) return;
  const gust::Plan plan = gust::expand(study, {});
  if (plan.trials.size() < members) std::terminate();
  for (const gust::Trial& trial : plan.trials) {
    if (!gust::valid_store_name(trial.id)) std::terminate();
  }
}

}  // namespace

/// Input: a study's text, settings as for --set, one a line, and a file that its patterns find, with a line of four
/// dashes between them. Whatever it is, reading gives a study whose trials can be named, or one Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::string_view text = take_section(input);
  const std::string_view lines = take_section(input);
  const std::string file(input);
  const std::vector<std::string> settings = gust::split_text(lines, '\n');
  try {
    plan(gust::parse_study(text, "fuzz.toml", settings,
                           [&](const std::string& pattern, const gust::Place&) { return find(pattern, file); }));
  } catch (const gust::Error&) {
  }
  return 0;
}
