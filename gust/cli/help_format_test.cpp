#include "gust/cli/help_format.h"

#include <doctest/doctest.h>

namespace gust {
namespace {

TEST_CASE("an example is broken before options, so that a shell reads the same command") {
  CHECK(wrapped_command("  gust run a.toml --out b", 25) == "  gust run a.toml --out b");
  CHECK(wrapped_command("  gust run a.toml --out b", 24) == "  gust run a.toml \\\n      --out b");
  CHECK(wrapped_command("  gust eval x --sweep 'a b' --level 1", 30) ==
        "  gust eval x --sweep 'a b' \\\n      --level 1");
  CHECK(wrapped_command("  gust preview studies/demo.toml", 10) == "  gust preview studies/demo.toml");
}

TEST_CASE("items of a list are wrapped in their column, or below their name where it is narrow") {
  const std::string_view line = "  steps     control steps; the file has one record more than that";
  CHECK(wrapped_item(line, 80) == line);
  CHECK(wrapped_item(line, 45) == "  steps     control steps; the file has one\n            record more than that");
  CHECK(wrapped_item(line, 40) == "  steps\n      control steps; the file has one\n      record more than that");
  CHECK(wrapped_item("  obs0, …   what the controller saw, as it was", 40) ==
        "  obs0, …\n      what the controller saw, as it was");
  CHECK(wrapped_item("  one name that has no text beside it", 20) == "  one name that has no text beside it");
}

}  // namespace
}  // namespace gust
