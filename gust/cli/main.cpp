#include <cstdio>
#include <new>

#include "gust/cli/command.h"
#include "gust/cli/environment.h"
#include "gust/cli/signals.h"
#include "gust/core/error.h"

namespace {

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
    gust::tell("out of memory; what was finished is kept, and the same command goes on from there");
    return gust::kTrialFailed;
  } catch (const std::exception& bug) {
    if (std::ferror(stdout) != 0) return tell_error(kNoOutput);  // what print throws where the buffer runs full
    gust::tell(gust::cat("internal error: ", bug.what(), "; please report it with the command and its input"));
    return gust::kTrialFailed;
  }
}

}  // namespace

int main(int argc, char** argv) {
  gust::end_at_signals();
  gust::hold_standard_files();
  gust::settle_environment();
  return gust::on_roomy_stack(run, argc, argv);
}
