#include "gust/cli/settings.h"

#include <doctest/doctest.h>

namespace gust {
namespace {

TEST_CASE("settings go to the first group that knows their key, as the values that they read like") {
  Table first, second;
  const SettingGroup groups[] = {{&first, {"mask", "steps"}}, {&second, {"steps", "goal", "name"}}};

  sort_settings({"steps=3", "goal=1,0.5", "name=a=b", "mask=0010"}, groups, "");

  CHECK(first.find("steps")->as_int("steps") == 3);
  CHECK(first.find("mask")->as_text("mask") == "0010");
  CHECK(second.find("goal")->as_numbers("goal") == std::vector<double>{1, 0.5});
  CHECK(second.find("name")->as_text("name") == "a=b");
  CHECK_FALSE(second.contains("steps"));
}

TEST_CASE("settings without key or value, with unknown keys or given twice are errors") {
  Table table;
  const SettingGroup groups[] = {{&table, {"frequency"}}};
  const auto error = [&](const std::string& text) {
    try {
      sort_settings({"frequency=1", text}, groups, "; and a hint");
    } catch (const Error& caught) {
      table = Table{};
      return std::string(caught.what());
    }
    return std::string("no error");
  };

  CHECK(error("frequency") == "--set: 'frequency' must read key=value");
  CHECK(error("=1") == "--set: '=1' must read key=value");
  CHECK(error("frequency=") == "--set: 'frequency=' must read key=value");
  CHECK(error("frequency=2") == "--set: 'frequency' is given twice");
  CHECK(error("frequncy=2") == "--set: unknown key 'frequncy'; did you mean 'frequency'?; and a hint");
}

}  // namespace
}  // namespace gust
