#pragma once

#include <filesystem>

namespace gust {

/// Writes STORE/store.json: the layout, and who made it.
void write_store_format(const std::filesystem::path& store);

}  // namespace gust
