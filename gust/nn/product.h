#pragma once

namespace gust {

/// C (m x n) = A (m x k) B (k x n), or C += A B. All are column-major without gaps; with b_transposed, B lies in memory
/// as its transpose (n x k).
struct ProductShape {
  int m = 0;
  int n = 0;
  int k = 0;
  bool b_transposed = false;
  bool accumulate = false;
};

/// Whether products of floats are compiled for this machine. They are not where memory may not be executed, as under
/// systemd's MemoryDenyWriteExecute; then the plain code runs, to the same bits. Nothing of the environment decides it.
bool products_are_compiled();

/// One small matrix product, compiled for its shape and for this machine when it is made.
///
/// Every element of C is one chain of fused multiply-adds in ascending k that starts at zero, or at the old element.
/// So its bits depend neither on m and n, nor on the machine, nor on how a long k is cut into accumulating products.
/// Cheap to copy; equal shapes share their code.
template <class T>
class Product {
 public:
  Product() = default;
  explicit Product(ProductShape shape);

  void operator()(const T* a, const T* b, T* c) const noexcept {
    compiled_ != nullptr ? compiled_(a, b, c) : plain(a, b, c);
  }

  /// The same product in plain code, to the same bits.
  void plain(const T* a, const T* b, T* c) const noexcept;

  /// Whether libxsmm runs it; the plain code is slower.
  bool compiled() const { return compiled_ != nullptr; }

 private:
  using Compiled = void (*)(const T*, const T*, T*, ...);

  ProductShape shape_;
  Compiled compiled_ = nullptr;
};

}  // namespace gust
