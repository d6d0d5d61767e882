#pragma once

#include <cstddef>
#include <functional>

namespace gust {

/// Runs `work` on so many threads at once, this one among them, or on as many as the system lets us have. What one of
/// them throws is thrown here, after all have ended.
void run_crew(std::size_t threads, const std::function<void()>& work);

}  // namespace gust
