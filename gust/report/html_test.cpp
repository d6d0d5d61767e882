#include "gust/report/html.h"

#include <doctest/doctest.h>

#include <limits>

namespace gust {

TEST_CASE("one unit stands behind its number, several in brackets") {
  CHECK(unit_html("N") == "&nbsp;N");
  CHECK(unit_html("m, <rad>") == " (m, &lt;rad&gt;)");
  CHECK(unit_html("").empty());
}

TEST_CASE("escaped text holds no character that HTML gives a meaning") {
  CHECK(escaped("</script><a href=\"x\" id='y'>&") ==
        "&lt;/script&gt;&lt;a href=&quot;x&quot; id=&#39;y&#39;&gt;&amp;");
}

TEST_CASE("well-formed UTF-8 passes and broken bytes become replacement characters") {
  CHECK(clean_text("θ ≥ 0.5 𝄞") == "θ ≥ 0.5 𝄞");
  CHECK(clean_text("a\xFF\xC0\x80z") == "a���z");
  CHECK(clean_text("cut \xE2\x89") == "cut ��");
  CHECK(clean_text("\xED\xA0\x80") == "���");  // a surrogate
}

TEST_CASE("control characters and marks that turn the direction of writing become replacement characters") {
  CHECK(clean_text(std::string_view("a\0b\x1B", 4)) == "a�b�");
  CHECK(clean_text("file\xE2\x80\xAEgpj.exe") == "file�gpj.exe");
  CHECK(clean_text("two\r\nlines\tand a tab") == "two\nlines\tand a tab");
}

TEST_CASE("decimal keeps as many places as three digits of the scale need") {
  CHECK(decimal(0.45678, 0.5) == "0.457");
  CHECK(decimal(0.45678, 5) == "0.46");
  CHECK(decimal(45.678, 50) == "45.7");
  CHECK(decimal(4567.8, 5000) == "4568");
  CHECK(decimal(-0.0001, 1) == "0.00");
  CHECK(decimal(-1.5, 1) == "−1.50");
  CHECK(decimal(std::numeric_limits<double>::quiet_NaN(), 1) == "–");
  CHECK(decimal(std::numeric_limits<double>::infinity(), 1) == "∞");
  CHECK(decimal(3.2e9, 3.2e9) == "3.20e+09");
}

TEST_CASE("an interval is shown only where it is known and has width") {
  CHECK(interval_text({0.5, 0.25, 0.75}, 1) == "[0.25, 0.75]");
  CHECK(interval_text({0.5, 0.5, 0.5}, 1) == "");
  CHECK(interval_text({0.5, Page::kUnknown, Page::kUnknown}, 1) == "");
  CHECK(interval_text({2, 1, std::numeric_limits<double>::infinity()}, 1) == "[1.00, ∞]");
}

TEST_CASE("base64 agrees with the examples of RFC 4648") {
  CHECK(base64("") == "");
  CHECK(base64("f") == "Zg==");
  CHECK(base64("fo") == "Zm8=");
  CHECK(base64("foo") == "Zm9v");
  CHECK(base64("foob") == "Zm9vYg==");
  CHECK(base64("fooba") == "Zm9vYmE=");
  CHECK(base64("foobar") == "Zm9vYmFy");
  CHECK(base64("\xFF\xFE") == "//4=");
}

}  // namespace gust
