#include <cstdio>

#include "gust/core/rng.h"
#include "gust/core/version.h"

int main() {
  std::printf("gust %s draws %.17g\n", gust::kVersion.data(), gust::Rng(1).uniform(0));
  return 0;
}
