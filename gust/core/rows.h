#pragma once

#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

namespace gust {

/// A view of a batch: rows are components, columns are lanes, and the lanes of a row lie side by side.
template <class T>
struct Rows {
  T* data = nullptr;
  std::size_t rows = 0;
  std::size_t lanes = 0;
  std::size_t stride = 0;  ///< distance between two rows, at least lanes

  T& at(std::size_t row, std::size_t lane) const { return data[row * stride + lane]; }
  std::span<T> row(std::size_t index) const { return {data + index * stride, lanes}; }
  Rows first_rows(std::size_t count) const { return {data, count, lanes, stride}; }

  operator Rows<const T>() const  // NOLINT: a view of constants is what readers ask for
    requires(!std::is_const_v<T>)
  {
    return {data, rows, lanes, stride};
  }
};

/// An owning batch. The stride is rounded up to a multiple of kPadLanes and the padding is initialised, so that a
/// kernel may run over whole packs.
template <class T>
class Matrix {
 public:
  static constexpr std::size_t kPadLanes = 16;

  Matrix() = default;
  Matrix(std::size_t rows, std::size_t lanes, T value = T{})
      : rows_(rows), lanes_(lanes), stride_(padded(lanes)), data_(rows * stride_, value) {}

  Rows<T> view() { return {data_.data(), rows_, lanes_, stride_}; }
  Rows<const T> view() const { return {data_.data(), rows_, lanes_, stride_}; }
  T& at(std::size_t row, std::size_t lane) { return data_[row * stride_ + lane]; }
  const T& at(std::size_t row, std::size_t lane) const { return data_[row * stride_ + lane]; }
  std::span<T> row(std::size_t index) { return view().row(index); }
  std::span<const T> row(std::size_t index) const { return view().row(index); }
  std::size_t rows() const { return rows_; }
  std::size_t lanes() const { return lanes_; }

  static std::size_t padded(std::size_t lanes) { return (lanes + kPadLanes - 1) / kPadLanes * kPadLanes; }

 private:
  std::size_t rows_ = 0;
  std::size_t lanes_ = 0;
  std::size_t stride_ = 0;
  std::vector<T> data_;
};

}  // namespace gust
