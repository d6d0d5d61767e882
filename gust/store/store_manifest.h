#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gust {

/// The layout of stores, manifests and packs that this program writes, and the only one it reads.
inline constexpr int kStoreFormat = 1;

/// What a manifest is called in the folder of its trial.
inline constexpr std::string_view kManifestName = "manifest.json";

/// What a store calls its description, and what it has measured of time.
inline constexpr std::string_view kFormatName = "store.json";
inline constexpr std::string_view kTimingsName = "timings.json";

/// One file of a trial.
struct StoredFile {
  std::string name;
  std::uint64_t size = 0;  ///< bytes
  std::string hash;        ///< 128-bit XXH3 of the content, 32 hexadecimal digits

  bool operator==(const StoredFile&) const = default;
};

/// What a finished trial says of itself: manifest.json.
struct Manifest {
  std::string kind;
  std::string id;
  std::string text;               ///< the canonical text, of which the trial is a pure function
  std::string gust;               ///< version of the program that made it
  std::vector<StoredFile> files;  ///< in the order in which they were written

  bool operator==(const Manifest&) const = default;
};

/// The bytes of manifest.json; equal manifests give equal bytes. They carry their own hash.
std::string manifest_bytes(const Manifest& manifest);

/// Reads a manifest. Anything amiss, from a wrong hash to a file name that leaves the folder, is an Error that begins
/// with `name`.
Manifest parse_manifest(std::string_view bytes, std::string_view name);

/// The files in which two results of one trial differ, or that only one of them has. Networks carry the version of the
/// program, so between two versions they are not compared.
std::vector<std::string> differing_files(const Manifest& a, const Manifest& b);

/// What is said of two such results, with the place of each.
std::string disagreement_text(const Manifest& a, const Manifest& b, std::string_view place_a, std::string_view place_b);

/// Whether a text may name a trial or a file of one: letters, digits, '.', '_', '-', '+', '=', at most 200, and
/// no dot in front.
bool valid_store_name(std::string_view name);

/// Whether a text may name a kind of trials: as above, but for the folders that every store has.
bool valid_store_kind(std::string_view name);

}  // namespace gust
