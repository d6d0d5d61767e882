#pragma once

namespace gust {

/// Takes from the environment what would reach the work: the settings of libxsmm, which also prints and writes files
/// when it is told to, and the sizes of stacks. What is documented for gust stays. To be called before any thread runs.
void settle_environment();

/// Runs a program's work on a stack of a known size, whatever `ulimit -s` says, and gives what it returns; on the
/// caller's own stack where no thread can be had.
int on_roomy_stack(int (*work)(int, char**), int argc, char** argv);

/// Tells, if matrix products cannot be compiled here, that networks train slower.
void warn_of_plain_products();

}  // namespace gust
