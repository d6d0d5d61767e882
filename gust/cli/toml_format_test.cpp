#include "gust/cli/toml_format.h"

#include <doctest/doctest.h>

#include <sstream>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/setup/preset_files.h"
#include "gust/setup/presets.h"
#include "gust/setup/toml.h"

namespace gust {
namespace {

/// All that a value holds, as text.
std::string content(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value.data)) return cat("\"", *text, "\"");
  std::string all;
  if (const auto* list = std::get_if<Value::List>(&value.data)) {
    for (const Value& item : *list) all += content(item) + ",";
    return "[" + all + "]";
  }
  if (const auto* table = std::get_if<Table>(&value.data)) {
    for (const std::string& key : table->keys()) all += cat(key, "=", content(*table->find(key)), ";");
    return "{" + all + "}";
  }
  if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "true" : "false";
  return cat(value.as_number("a test"));
}

std::string content_of(const std::string& text) { return content({parse_toml(text, "a.toml"), {"a.toml"}}); }

std::size_t widest(const std::string& text) {
  std::size_t most = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) most = std::max(most, text_width(line));
  return most;
}

TEST_CASE("a TOML text in narrow lines says the same") {
  const std::string text =
      "# a comment that is wider than the terminal on which it is shown\n"
      "[plant]\n"
      "length   = 0.5           # m. A comment that makes its line too wide\n"
      "summary = \"a text with a # and = that is too wide for one line of it\"\n"
      "agent = { kind = \"ppo\", randomise = { pole_length = { kind = \"normal\", mean = 0.5 } }, seeds = [1, 2] }\n"
      "short = 1\n";

  const std::string narrow = wrapped_toml(text, 40);

  CHECK(widest(narrow) <= 40);
  CHECK(content_of(narrow) == content_of(text));
  CHECK(narrow.find("# m. A comment that makes its line too\n# wide\nlength   = 0.5\n") != std::string::npos);
  CHECK(wrapped_toml(text, 200) == text);
}

TEST_CASE("all presets fit 78 columns and say the same") {
  for (const Preset& preset : presets()) {
    CAPTURE(preset.name);
    const std::string text(preset_file(preset.name)), narrow = wrapped_toml(text, 78);
    CHECK(widest(narrow) <= 78);
    CHECK(content_of(narrow) == content_of(text));
  }
}

}  // namespace
}  // namespace gust
