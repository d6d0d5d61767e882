#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace gust {

/// Hands out memory on cache lines, where every load of a whole register is cheap.
template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kLine{64};

  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}  // NOLINT: every allocator is the same

  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), kLine)); }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, kLine); }
  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};

/// A vector that starts on a cache line.
template <class T>
using Buffer = std::vector<T, CacheLineAllocator<T>>;

}  // namespace gust
