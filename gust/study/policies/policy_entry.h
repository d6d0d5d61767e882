#pragma once

#include <optional>
#include <tuple>

#include "gust/study/policies/policy_source.h"

namespace gust {

/// The value of a key that can be read only once the plant and the files are known, as it was written.
struct Written {
  std::string_view standard;  ///< the default in words, for the catalogue: "required", "the reward's"
  std::string_view type;      ///< "list of numbers"
  std::optional<Value> value = {};
  Range range = {};

  explicit operator bool() const { return value.has_value(); }
  const Value& operator*() const { return *value; }
  const Value* operator->() const { return &*value; }
  /// Whether both are at the default.
  bool operator==(const Written& other) const { return !value && !other.value; }
};

inline void read_value(Written& to, const Value& value, std::string_view, const Range& range) {
  to.value = value;
  to.range = range;
}
inline std::string canonical_text(const Written& written) { return std::string(written.standard); }
inline std::string_view type_text(const Written& written) { return written.type; }

/// As many numbers as `standard` has, which it is where nothing is written; a single number stands for a list of one.
/// An Error at the place for another count, with what the numbers are of.
std::vector<double> numbers_or(const Written& written, std::string_view key, std::vector<double> standard,
                               std::string_view of = {});

/// What the catalogue tells of a kind.
struct PolicyWords {
  std::string name;
  std::string summary;
  std::string source;
  std::string example;
};

/// The kind of a PolicySource whose keys are its `kFields`. `static constexpr std::string_view kFileEnding` says that
/// files with this ending are such policies, `static constexpr bool kTrained = true` that it has to be trained.
template <class Source>
PolicyKind policy_entry(PolicyWords words) {
  PolicyKind kind{words.name, std::move(words.summary), std::move(words.source), std::move(words.example), {}, {}};
  kind.fields = describe_fields<Source>();
  if constexpr (requires { Source::kFileEnding; }) kind.file_ending = Source::kFileEnding;
  if constexpr (requires { Source::kTrained; }) kind.trained = Source::kTrained;
  kind.read = [name = std::move(words.name)](const Table& table, const PolicyContext& context) {
    auto source = std::make_shared<Source>();
    read_fields(*source, table, cat("a policy of kind ", name), {"name", "kind"});
    source->prepare(context);
    return source;
  };
  return kind;
}

}  // namespace gust
