// page_fixture KIND: writes one of the invented pages of fixture.h to stdout, for the browser tests.
#include <functional>
#include <iostream>
#include <map>

#include "tests/page/fixture.h"

int main(int count, char** arguments) {
  using gust::render_page;
  using gust::render_reproduction;
  const std::map<std::string, std::function<std::string()>> kinds = {
      {"demo", [] { return render_page(gust::demo_page()); }},
      {"hostile", [] { return render_page(gust::hostile_page()); }},
      {"large", [] { return render_page(gust::large_page()); }},
      {"single", [] { return render_page(gust::single_page()); }},
      {"empty", [] { return render_page({}); }},
      {"reproduction", [] { return render_reproduction(gust::reproduction_page()); }},
      {"large-reproduction", [] { return render_reproduction(gust::large_reproduction()); }}};
  const auto kind = kinds.find(count == 2 ? arguments[1] : "");
  if (kind == kinds.end()) {
    std::cerr << "page_fixture KIND, one of";
    for (const auto& [name, make] : kinds) std::cerr << ' ' << name;
    std::cerr << '\n';
    return 2;
  }
  std::cout << kind->second();
}
