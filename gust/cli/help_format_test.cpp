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

}  // namespace
}  // namespace gust
