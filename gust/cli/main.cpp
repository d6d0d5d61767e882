#include <unistd.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "gust/cli/command.h"
#include "gust/cli/environment.h"
#include "gust/cli/signals.h"
#include "gust/core/error.h"

namespace {

constexpr std::string_view kNoMemory =
    "out of memory; what was finished is kept, and the same command goes on from there";

/// Where an exception cannot be caught, as one in the destructor of a JSON value, the last word is a sentence too.
[[noreturn]] void end_with_a_sentence() {
  bool memory = false;
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    memory = true;
  } catch (...) {
  }
  const std::string_view texts[] = {
      "gust: ", memory ? kNoMemory : "internal error: please report it with the command and its input", "\n"};
  for (const std::string_view text : texts) {
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
  }
  ::_exit(gust::kTrialFailed);
}

int tell_error(const char* what) {
  gust::tell(what);
  return gust::kUsage;
}

int run(int argc, char** argv) {
  constexpr const char* kNoOutput = "standard output: cannot be written to";
  try {
    const int exit_code = gust::run_command_line(argc, argv);
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
    return exit_code != gust::kDone ? exit_code : tell_error(kNoOutput);  // else it is told already
  } catch (const gust::Error& error) {
    return tell_error(error.what());
  } catch (const std::bad_alloc&) {
    gust::tell(kNoMemory);
    return gust::kTrialFailed;
  } catch (const std::exception& bug) {
    if (std::ferror(stdout) != 0) return tell_error(kNoOutput);  // what print throws where the buffer runs full
    gust::tell(gust::cat("internal error: ", bug.what(), "; please report it with the command and its input"));
    return gust::kTrialFailed;
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::set_terminate(end_with_a_sentence);
  gust::end_at_signals();
  gust::hold_standard_files();
  gust::settle_environment();
  return gust::on_roomy_stack(run, argc, argv);
}
