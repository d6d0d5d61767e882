#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gust/store/store.h"
#include "gust/study/plan/plan.h"

namespace gust {

/// Something in a store that is not as it should be.
struct StoreProblem {
  std::string path;
  std::string what;
};

/// What a look at every byte of a store found.
struct StoreCheck {
  std::size_t whole = 0;               ///< trials with right hashes and right content
  std::vector<StoreProblem> damaged;   ///< trials, and the store's own description
  std::vector<StoreProblem> leftover;  ///< what dead processes left, of no harm

  bool is_clean() const { return damaged.empty() && leftover.empty(); }
};

/// Reads all of a store and changes nothing. With the plan of a study, its trials must also be what the study asks for.
/// An Error if there is no store, or one of another format.
StoreCheck check_store(const std::filesystem::path& folder, const Plan* plan = nullptr);

/// Moves what is damaged to STORE/damaged, writes STORE/store.json again where it is missing or damaged and the
/// manifests of the trials say of which format they are, and removes what the dead left. Returns what it found;
/// afterwards check_store finds nothing.
StoreCheck repair_store(const std::filesystem::path& folder, const Plan* plan, const Store::Notice& notice);

/// The store in which a path lies, if it lies in one.
std::optional<std::filesystem::path> store_around(const std::filesystem::path& path);

/// Where the store of a result folder is, or the folder itself if it is a store.
std::filesystem::path store_in(const std::filesystem::path& folder);

}  // namespace gust
