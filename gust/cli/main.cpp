#include <cstdio>

#include "gust/cli/command.h"
#include "gust/core/error.h"

namespace {

int tell_error(const char* what) {
  gust::tell(what);
  return gust::kUsage;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr const char* kNoOutput = "standard output: cannot be written to";
  gust::hold_standard_files();
  try {
    const int exit_code = gust::run_command_line(argc, argv);
    return std::fflush(stdout) == 0 && std::ferror(stdout) == 0 ? exit_code : tell_error(kNoOutput);
  } catch (const gust::Error& error) {
    return tell_error(error.what());
  } catch (const std::exception& bug) {
    if (std::ferror(stdout) != 0) return tell_error(kNoOutput);  // what print throws where the buffer runs full
    gust::tell(gust::cat("internal error: ", bug.what(), "; please report it with the command and its input"));
    return gust::kTrialFailed;
  }
}
