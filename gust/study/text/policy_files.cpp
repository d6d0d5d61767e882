#include "gust/study/text/policy_files.h"

#include "gust/core/error.h"
#include "gust/store/files.h"

namespace gust {
namespace {

namespace fs = std::filesystem;

/// Where links end; an empty path if there is nothing.
fs::path real_path(const fs::path& path) {
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  return error ? fs::path() : real;
}

bool is_there(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(fs::symlink_status(path, unknown));
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// A regular file in the folder. What is no regular file is not opened: a pipe would wait for a writer.
std::string read_beside(const fs::path& folder, const std::string& name, std::size_t most) {
  const fs::path path = real_path(folder / name);
  if (path.empty()) throw Error(cat("its weights are in the file '", name, "', which is not beside it"));
  if (path.parent_path() != real_path(folder)) {
    throw Error(
        cat("its weights are in the file '", name, "', a link that leads out of the folder; copy the file there"));
  }
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) {
    throw Error(cat("its weights are in '", name, "', which is no regular file"));
  }
  if (fs::file_size(path, error) > most && !error) {
    throw Error(cat("its weights are in the file '", name,
                    "', which is too large; the limit for all data files of a "
                    "policy is ",
                    kOnnxDataBytes, " bytes"));
  }
  return read_file(path, most);
}

}  // namespace

std::string read_policy_file(const fs::path& path) { return read_file(path, kOnnxBytes); }

OnnxData read_onnx_data(const fs::path& path, std::string_view bytes) {
  OnnxData data;
  if (path.extension() != ".onnx") return data;
  std::size_t left = kOnnxDataBytes;
  for (const std::string& name : onnx_data_files(bytes, path.string())) {
    fs::path folder = folder_of(path);
    if (!is_there(folder / name) && fs::is_symlink(path)) folder = real_path(path).parent_path();
    try {
      left -= data.emplace(name, read_beside(folder, name, left)).first->second.size();
    } catch (const Error& error) {
      throw Error(cat(path.string(), ": ", error.what()));
    }
  }
  return data;
}

}  // namespace gust
