#include "gust/core/identity.h"

#include <doctest/doctest.h>

using namespace gust;

TEST_CASE("an identity is told in order, without a name or with another value for one") {
  Identity identity;
  identity.add("steps", "400");
  identity.add("warm_steps", "7");
  identity.add("kind", "\"a, steps = 1\"");

  CHECK(identity.text() == "steps = 400, warm_steps = 7, kind = \"a, steps = 1\"");
  CHECK(identity.without("steps").text() == "warm_steps = 7, kind = \"a, steps = 1\"");
  CHECK(identity.with("warm_steps", "8").text() == "steps = 400, warm_steps = 8, kind = \"a, steps = 1\"");
  CHECK(identity.with("cold_steps", "8").text() == identity.text());
  CHECK(Identity{}.text().empty());
}
