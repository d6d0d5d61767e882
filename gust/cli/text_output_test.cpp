#include "gust/cli/text_output.h"

#include <doctest/doctest.h>

using namespace gust;

TEST_CASE("control characters are told, not sent, in ASCII and in UTF-8") {
  CHECK(printable("a\x1b[2Jb\r\n\x7f") == "a\\x1b[2Jb\\x0d\\x0a\\x7f");
  CHECK(printable("\xc2\x9b"
                  "31m") == "\\x9b31m");
  CHECK(printable("two\nlines\t", "\n") == "two\nlines\\x09");
  CHECK(printable("é · 100 % \xc2\xa0 caf\xe9") == "é · 100 % \xc2\xa0 caf\xe9");
}
