// page_fixture KIND: writes one of the invented pages of fixture.h to stdout, for the browser tests.
#include <iostream>
#include <map>

#include "tests/page/fixture.h"

int main(int count, char** arguments) {
  const std::map<std::string, gust::Page (*)()> kinds = {{"demo", gust::demo_page},
                                                         {"hostile", gust::hostile_page},
                                                         {"large", gust::large_page},
                                                         {"single", gust::single_page},
                                                         {"empty", [] { return gust::Page{}; }}};
  const auto kind = kinds.find(count == 2 ? arguments[1] : "");
  if (kind == kinds.end()) {
    std::cerr << "page_fixture demo|hostile|large|single|empty\n";
    return 2;
  }
  std::cout << gust::render_page(kind->second());
}
