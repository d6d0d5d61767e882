#include "gust/cli/environment.h"

#include <pthread.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "gust/cli/signals.h"
#include "gust/cli/text_output.h"
#include "gust/nn/product.h"

namespace gust {
namespace {

constexpr std::size_t kStackBytes = std::size_t{8} << 20;

struct Call {
  int (*work)(int, char**);
  int argc;
  char** argv;
  int result;
};

void* make_call(void* pointer) {
  Call& call = *static_cast<Call*>(pointer);
  call.result = call.work(call.argc, call.argv);
  return nullptr;
}

}  // namespace

void settle_environment() {
  std::vector<std::string> foreign;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    if (text.starts_with("LIBXSMM_")) foreign.emplace_back(text.substr(0, text.find('=')));
  }
  for (const std::string& name : foreign) ::unsetenv(name.c_str());
}

void warn_of_plain_products() {
  if (products_are_compiled()) return;
  tell(
      "warning: memory may not be executed here (systemd's MemoryDenyWriteExecute, SELinux, ulimit -v), so networks "
      "run "
      "in plain code: slower, to the same bits");
}

int on_roomy_stack(int (*work)(int, char**), int argc, char** argv) {
  Call call{work, argc, argv, 0};
  pthread_t thread{};
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  pthread_setattr_default_np(&attributes);  // of all threads to come
  const bool made = pthread_create(&thread, &attributes, make_call, &call) == 0;
  pthread_attr_destroy(&attributes);
  if (!made) return work(argc, argv);
  leave_signals_to_others();
  pthread_join(thread, nullptr);
  return call.result;
}

}  // namespace gust
