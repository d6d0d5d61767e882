#pragma once

#include <filesystem>
#include <string_view>

namespace gust {

/// What a command writes where the user says.
enum class OutputKind { csv, sqlite, onnx, pack, page };

/// Throws Error, which begins with `named`, unless a file of this kind may be written there: over nothing, over an
/// empty file, or over what gust wrote as the same kind; over anything else if `force`. Never into a store, and never
/// over the parts of a result folder. Devices and pipes are written through.
void check_output(const std::filesystem::path& file, OutputKind kind, std::string_view named, bool force = false);

/// Makes a folder for output, and those above it. Throws Error, which begins with `named`, if it lies in a store.
void make_output_folder(const std::filesystem::path& folder, std::string_view named);

/// Whether two paths lead to one file, which need not be there.
bool is_same_output(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace gust
