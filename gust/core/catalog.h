#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gust/core/fields.h"

namespace gust {

/// An object made from options, and what it is made from, defaults included.
template <class T>
struct Made {
  std::shared_ptr<const T>
      object;  ///< shared because it never changes: a study, its sweeps and trials hold the same one
  std::string kind;
  Identity options;

  /// "kind(name = value, …)"; equal texts make equal objects.
  std::string canonical() const { return cat(kind, "(", options.text(), ")"); }

  const T* operator->() const { return object.get(); }
  const T& operator*() const { return *object; }
};

/// One kind of a catalogue: what it is called, what it does, its options and how to make it.
template <class T>
struct Entry {
  std::string name;
  std::string summary;
  std::string source;  ///< where it is defined: a paper, a section of docs/, or gust itself
  std::vector<FieldInfo> fields;
  std::function<Made<T>(const Table&)> make;  ///< the key "kind" is ignored; throws Error
};

/// Every kind of one sort (waveform, plant, agent, metric), in the order of that folder's list.inc.
template <class T>
class Catalog {
 public:
  Catalog(std::string sort, std::vector<Entry<T>> entries) : sort_(std::move(sort)), entries_(std::move(entries)) {}

  const std::string& sort() const { return sort_; }
  const std::vector<Entry<T>>& entries() const { return entries_; }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Entry<T>& entry : entries_) names.push_back(entry.name);
    return names;
  }

  /// The entry of a name; an unknown one is an Error at the place, with the nearest name.
  const Entry<T>& at(std::string_view name, const Place& place = {"gust"}) const {
    for (const Entry<T>& entry : entries_) {
      if (entry.name == name) return entry;
    }
    throw error_at(place, "unknown ", sort_, " '", name, "'", did_you_mean(name, names()), " (gust list ", sort_, "s)");
  }

  /// Makes what the table's key "kind" names.
  Made<T> make(const Table& table) const {
    const Value* kind = table.find("kind");
    if (kind == nullptr) throw error_at(table.place, "a ", sort_, " needs a 'kind': ", join(names(), ", "));
    return at(kind->as_text("kind"), kind->place).make(table);
  }

 private:
  std::string sort_;
  std::vector<Entry<T>> entries_;
};

/// The entry of a struct of options: `make_object(options)` gives the object.
template <class T, class Options, class Make>
Entry<T> make_entry(std::string name, std::string summary, std::string source, Make make_object) {
  Entry<T> entry{name, std::move(summary), std::move(source), describe_fields<Options>(), {}};
  entry.make = [name, make_object](const Table& table) {
    Options options;
    read_fields(options, table, name, {"kind"});
    return Made<T>{make_object(options), name, identity_of(options)};
  };
  return entry;
}

}  // namespace gust
