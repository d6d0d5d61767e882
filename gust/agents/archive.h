#pragma once

#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "gust/core/error.h"

namespace gust {

// The state of a training as bytes. A class lists its fields once, in `archive(archive, self)`: with a Saver and a
// constant self the list writes, with a Loader it reads. Numbers are kept bit for bit, in the order of bytes of the
// machine.

/// Appends fields to bytes.
class Saver {
 public:
  template <class T>
  void number(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void text(const std::string& value) {
    number(static_cast<std::uint64_t>(value.size()));
    bytes_ += value;
  }
  /// Numbers whose count the reader knows.
  template <class T>
  void block(std::span<T> values) {
    number(static_cast<std::uint64_t>(values.size()));
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  /// Any count of numbers.
  template <class T>
  void list(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    block(std::span(values));
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Reads fields back. An Error for bytes that a Saver of the same fields did not write.
class Loader {
 public:
  explicit Loader(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  void number(T& value) {
    static_assert(std::is_arithmetic_v<T>);
    std::memcpy(&value, next(sizeof value), sizeof value);
  }
  void text(std::string& value) {
    const std::size_t size = count(1);
    value.assign(next(size), size);
  }
  template <class T>
  void block(std::span<T> values) {
    if (count(sizeof(T)) != values.size()) fail();
    if (!values.empty()) std::memcpy(values.data(), next(values.size_bytes()), values.size_bytes());
  }
  template <class T>
  void list(std::vector<T>& values) {
    values.resize(count(sizeof(T)));
    const std::span<T> all(values);
    if (!all.empty()) std::memcpy(all.data(), next(all.size_bytes()), all.size_bytes());
  }
  /// Rows of a width, as many as were written in one block; no memory is taken before their bytes are seen.
  template <class Numbers>
  void rows(Numbers& values, std::size_t count_of_rows, std::size_t width) {
    const std::size_t numbers = count(sizeof(values[0]));
    if (numbers != count_of_rows * width) fail();
    values.resize(numbers);
    if (numbers > 0) std::memcpy(values.data(), next(numbers * sizeof(values[0])), numbers * sizeof(values[0]));
  }
  /// Call when all fields are read.
  void finish() const {
    if (!bytes_.empty()) fail();
  }
  [[noreturn]] static void fail() {
    throw Error("checkpoint: not the state of this training; delete it to train from the start");
  }

 private:
  const char* next(std::size_t size) {
    if (size > bytes_.size()) fail();
    const char* at = bytes_.data();
    bytes_.remove_prefix(size);
    return at;
  }
  std::size_t count(std::size_t size_of_one) {
    std::uint64_t values = 0;
    number(values);
    if (values > bytes_.size() / size_of_one) fail();
    return values;
  }

  std::string_view bytes_;
};

}  // namespace gust
