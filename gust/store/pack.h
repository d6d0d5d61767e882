#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <istream>
#include <string_view>

#include "gust/store/store.h"

namespace gust {

/// What went into a pack or came out of it.
struct PackCount {
  std::size_t trials = 0;       ///< written
  std::size_t present = 0;      ///< left alone, because the store already had them whole
  std::size_t damaged = 0;      ///< left out of the pack
  std::size_t disagreeing = 0;  ///< of those present: the pack has another result for them
  std::uint64_t bytes = 0;      ///< size of the pack
};

/// What is wrong with the content of a trial whose hashes are right; empty if nothing is.
using DamageOf = std::function<std::string(const StoredTrial&)>;

/// Writes every finished trial of a store, or those of one kind, into one compressed file. Equal trials give equal
/// bytes, whatever the order in which they were made. A damaged trial is left out, counted and reported.
PackCount pack_store(const Store& store, const std::filesystem::path& file, std::string_view only_kind = {},
                     const DamageOf& damage_of = {});

/// Reads a pack to its end. One that is damaged, or made to do harm, is an Error.
void check_pack(const std::filesystem::path& file);

/// Adds the trials of a pack to a store. Trials that the store has whole are never touched; where the pack has another
/// result for one, the store's notice names both. The Errors of check_pack are this one's too; the whole trials before
/// the damage stay.
PackCount unpack_store(const std::filesystem::path& file, const Store& store);

/// What read_pack meets, in the order of the file; this one pays no heed.
class PackVisitor {
 public:
  virtual ~PackVisitor() = default;
  virtual void trial(const Manifest& /*manifest*/) {}      ///< begins a trial
  virtual void file(const StoredFile& /*file*/) {}         ///< begins a file of it
  virtual void bytes(std::string_view /*bytes*/) {}        ///< the next piece of that file
  virtual void trial_end(const Manifest& /*manifest*/) {}  ///< all hashes of the trial were right
};

/// Reads a pack from front to back with bounded memory; `name` begins its Errors.
void read_pack(std::istream& stream, std::string_view name, PackVisitor& visitor);

}  // namespace gust
