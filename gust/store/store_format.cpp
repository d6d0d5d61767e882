#include "gust/store/store_format.h"

#include <nlohmann/json.hpp>

#include "gust/core/version.h"
#include "gust/store/files.h"
#include "gust/store/store_manifest.h"

namespace gust {

void write_store_format(const std::filesystem::path& store) {
  const nlohmann::json format = {{"format", kStoreFormat}, {"gust", kVersion}};
  write_file_atomically(store / kFormatName, format.dump() + "\n");
}

}  // namespace gust
