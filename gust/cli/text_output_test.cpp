#include "gust/cli/text_output.h"

#include <doctest/doctest.h>

using namespace gust;

TEST_CASE("a message quotes at most 200 characters, and has no longer word") {
  const std::string x(200, 'x'), quoted = "'a b c" + std::string(500, ' ') + "'";

  CHECK(shortened("f.toml:1:2: unknown key '" + x + "'; it's long") ==
        "f.toml:1:2: unknown key '" + x + "'; it's long");
  CHECK(shortened("'" + x + "yz' is") == "'" + x + "...' is");
  CHECK(shortened(x + "yz is") == x + "... is");
  CHECK(shortened(quoted) == quoted.substr(0, 201) + "...'");
  CHECK(shortened("\u00e4" + x).ends_with("x..."));
}

TEST_CASE("control characters are told, not sent, in ASCII and in UTF-8") {
  CHECK(printable("a\x1b[2Jb\r\n\x7f") == "a\\x1b[2Jb\\x0d\\x0a\\x7f");
  CHECK(printable("\xc2\x9b"
                  "31m") == "\\x9b31m");
  CHECK(printable("two\nlines\t", "\n") == "two\nlines\\x09");
  CHECK(printable("é · 100 % \xc2\xa0 caf\xe9") == "é · 100 % \xc2\xa0 caf\xe9");
}
