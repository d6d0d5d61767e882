#include "gust/core/crew.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace gust {

void run_crew(std::size_t threads, const std::function<void()>& work) {
  std::vector<std::exception_ptr> errors(std::max<std::size_t>(threads, 1));
  const auto run = [&](std::size_t member) {
    try {
      work();
    } catch (...) {
      errors[member] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> crew;
    crew.reserve(errors.size());
    try {
      while (crew.size() + 1 < errors.size()) crew.emplace_back(run, crew.size() + 1);
    } catch (const std::system_error&) {  // no more threads: those that are there do the work
    }
    run(0);
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

void for_each_item(std::size_t threads, std::size_t count, const std::function<ItemWorker()>& make_worker) {
  std::vector<std::exception_ptr> errors(count);
  std::atomic<std::size_t> next = 0;
  run_crew(threads, [&] {
    const ItemWorker work = make_worker();
    for (std::size_t item = next++; item < count; item = next++) {
      try {
        work(item);
      } catch (...) {
        errors[item] = std::current_exception();
      }
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace gust
