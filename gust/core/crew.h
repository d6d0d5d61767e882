#pragma once

#include <cstddef>
#include <functional>

namespace gust {

/// Runs `work` on so many threads at once, this one among them, or on as many as the system lets us have. What one of
/// them throws is thrown here, after all have ended.
void run_crew(std::size_t threads, const std::function<void()>& work);

/// Does the items 0 to count - 1, each once, on so many threads. Each thread makes a worker of its own and gives it
/// items as they come. All are done, also if some throw; then the error of the lowest of these is thrown.
using ItemWorker = std::function<void(std::size_t item)>;
void for_each_item(std::size_t threads, std::size_t count, const std::function<ItemWorker()>& make_worker);

}  // namespace gust
