#include "gust/nn/product.h"

#include <fcntl.h>
#include <libxsmm.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <set>
#include <string>

#include "gust/nn/vec.h"

namespace gust {
namespace {

/// Whether libxsmm 1.17 adds up in order. With AVX-512 it cuts the sum over k into several when a block of rows is one
/// register wide, that is, when m or what is left of m after whole blocks of 64 rows is 1 … 16 (seen over all m and n
/// up to 256; product_test.cpp compares the bits).
bool adds_in_order(int m) { return m % 64 == 0 || m % 64 > 16; }

constexpr std::size_t kCompilerBytes = std::size_t{32} << 20;  // more than its tables and buffers take
constexpr std::size_t kKernelBytes = std::size_t{1} << 20;     // more than the code of a product takes

/// Whether so much memory is there and may be executed. libxsmm does not ask: without it, it returns a kernel that
/// cannot run.
bool can_execute(std::size_t bytes) {
  const int flags = MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE | PROT_EXEC, flags, -1, 0);
  if (memory == MAP_FAILED) return false;
  const bool executable = ::mprotect(memory, bytes, PROT_READ | PROT_EXEC) == 0;
  ::munmap(memory, bytes);
  return executable;
}

/// Starts libxsmm, for this processor whatever LIBXSMM_TARGET says: kernels below AVX2 multiply and add with two
/// roundings, to other bits.
bool start_compiler() {
  if (!can_execute(kCompilerBytes)) return false;
  libxsmm_init();
  const int processor = libxsmm_cpuid();
  libxsmm_set_target_archid(processor);
  return processor >= LIBXSMM_X86_AVX2 && libxsmm_get_target_archid() == processor;
}

/// Whether an address lies in memory that may be executed; yes where /proc does not tell.
bool is_executable(const void* address) {
  std::string maps;
  const int file = ::open("/proc/self/maps", O_RDONLY | O_CLOEXEC);
  if (file < 0) return true;
  char piece[4096];
  for (ssize_t count; (count = ::read(file, piece, sizeof piece)) > 0;)
    maps.append(piece, static_cast<std::size_t>(count));
  ::close(file);
  const auto wanted = reinterpret_cast<std::uintptr_t>(address);
  for (const char* line = maps.c_str(); *line != '\0';) {  // "7f1c5a000000-7f1c5a002000 r-xp 00000000 …"
    char* next = nullptr;
    const std::uintptr_t begin = std::strtoull(line, &next, 16);
    const std::uintptr_t end = *next == '-' ? std::strtoull(next + 1, &next, 16) : 0;
    if (wanted >= begin && wanted < end) return std::strlen(next) > 3 && next[3] == 'x';
    line = std::strchr(next, '\n');
    if (line++ == nullptr) break;
  }
  return false;
}

void (*compile(const ProductShape& shape))(const float*, const float*, float*, ...) {
  if (!adds_in_order(shape.m) || !products_are_compiled()) return nullptr;
  static std::mutex one_at_a_time;  // so that no other kernel takes the memory that was found
  const std::lock_guard lock(one_at_a_time);
  static std::set<const void*> known;  // kernels that can run
  if (!can_execute(kKernelBytes)) return nullptr;
  const int ldb = shape.b_transposed ? shape.n : shape.k;
  const float alpha = 1.0f;
  const float beta = shape.accumulate ? 1.0f : 0.0f;
  const int flags = shape.b_transposed ? LIBXSMM_GEMM_FLAG_TRANS_B : LIBXSMM_GEMM_FLAG_NONE;
  const auto kernel =
      libxsmm_smmdispatch(shape.m, shape.n, shape.k, &shape.m, &ldb, &shape.m, &alpha, &beta, &flags, nullptr);
  const void* code = reinterpret_cast<const void*>(kernel);
  if (kernel == nullptr || (!known.contains(code) && !is_executable(code))) return nullptr;
  known.insert(code);
  return kernel;
}

/// V rows times kColumns columns of C, held in registers; V is a scalar or a vector.
template <class V, int kColumns, class T>
void tile(const ProductShape& s, const T* a, const T* b, T* c) {
  const std::ptrdiff_t m = s.m;
  const std::ptrdiff_t next_k = s.b_transposed ? s.n : 1;
  const std::ptrdiff_t next_column = s.b_transposed ? 1 : s.k;
  V sum[kColumns];
  for (int j = 0; j < kColumns; ++j) sum[j] = s.accumulate ? load_as<V>(c + j * m) : V{};
  for (int k = 0; k < s.k; ++k) {
    const V column = load_as<V>(a + k * m);
    for (int j = 0; j < kColumns; ++j) sum[j] = fused(column, V{} + b[k * next_k + j * next_column], sum[j]);
  }
  for (int j = 0; j < kColumns; ++j) store_as(c + j * m, sum[j]);
}

/// V rows times all columns.
template <class V, class T>
void strip(const ProductShape& s, const T* a, const T* b, T* c) {
  const std::ptrdiff_t next_column = s.b_transposed ? 1 : s.k;
  int j = 0;
  for (; j + 8 <= s.n; j += 8) tile<V, 8>(s, a, b + j * next_column, c + std::ptrdiff_t{j} * s.m);
  for (; j < s.n; ++j) tile<V, 1>(s, a, b + j * next_column, c + std::ptrdiff_t{j} * s.m);
}

}  // namespace

bool products_are_compiled() {
  static const bool started = start_compiler();
  return started;
}

template <class T>
Product<T>::Product(ProductShape shape) : shape_(shape) {
  if constexpr (sizeof(T) == sizeof(float)) compiled_ = compile(shape);
}

template <class T>
void Product<T>::plain(const T* a, const T* b, T* c) const noexcept {
  constexpr int kWidth = static_cast<int>(kVecWidth<T>);
  int i = 0;
  for (; i + kWidth <= shape_.m; i += kWidth) strip<Vec<T>>(shape_, a + i, b, c + i);
  for (; i < shape_.m; ++i) strip<T>(shape_, a + i, b, c + i);
}

template class Product<float>;
template class Product<double>;

}  // namespace gust
