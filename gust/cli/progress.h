#pragma once

#include <functional>

#include "gust/study/trials/executor.h"

namespace gust {

/// Does the work on this thread and meanwhile shows on stderr how far it is: a bar with the time that is left where
/// stderr is a terminal, otherwise a line every ten percent. What takes less than a second shows nothing.
void show_progress(const Progress& progress, const std::function<void()>& work);

}  // namespace gust
