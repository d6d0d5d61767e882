#include "gust/cli/output_file.h"

#include <unistd.h>

#include <algorithm>
#include <string>

#include "gust/core/error.h"
#include "gust/onnx/data.h"
#include "gust/store/files.h"
#include "gust/store/files_posix.h"
#include "gust/study/summary/export.h"
#include "gust/study/trials/store_check.h"

namespace gust {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHead = 4096;  // bytes that tell the kind; of an SQLite file the page with its tables

fs::path real_path(const fs::path& file) {
  std::error_code unknown;
  return fs::weakly_canonical(fs::absolute(link_target(file), unknown), unknown);
}

std::string head_of(const fs::path& file) {
  const Descriptor opened = open_to_read(file);
  std::string head(kHead, '\0');
  const ssize_t count = ::read(opened.get(), head.data(), head.size());
  head.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return head;
}

bool has(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

bool is_of_kind(const fs::path& file, OutputKind kind) {
  const std::string head = head_of(file);
  switch (kind) {
    case OutputKind::csv:
      return head.starts_with(kExportHead);
    case OutputKind::sqlite:
      return head.starts_with(std::string_view("SQLite format 3\0", 16)) && has(head, "CREATE TABLE episodes");
    case OutputKind::onnx:
      return has(read_file(file, kOnnxBytes), "gust.version");
    case OutputKind::pack:
      return head.starts_with("gust pack ");
    case OutputKind::page:
      return has(head, "name=\"generator\" content=\"gust ");
  }
  return false;
}

std::string_view name_of(OutputKind kind) {
  static constexpr std::string_view kNames[] = {"table", "SQLite table", "policy", "pack", "page"};
  return kNames[static_cast<int>(kind)];
}

/// Where a path leads, which is in no store.
fs::path check_outside_store(const fs::path& path, std::string_view named) {
  const fs::path place = real_path(path);
  if (const auto store = store_around(place))
    throw Error(cat(named, ": '", path.string(), "' lies in the store ", store->string(), "; choose another folder"));
  return place;
}

/// What makes a result folder, and is written by `gust run` alone.
bool is_part_of_results(const fs::path& file) {
  const fs::path folder = file.parent_path();
  std::error_code unknown;
  const auto is_result = [&](const fs::path& at) {
    return (fs::exists(at / "inputs.json", unknown) && fs::exists(at / "study.toml", unknown)) ||
           fs::exists(at / "reproduction.json", unknown);
  };
  const std::string name = file.filename().string();
  if (folder.filename() == "inputs" && is_result(folder.parent_path())) return true;
  const std::string_view parts[] = {"inputs.json", "study.toml", "reproduction.json", "claims.csv"};
  return is_result(folder) && std::ranges::find(parts, name) != std::end(parts);
}

}  // namespace

void check_output(const fs::path& file, OutputKind kind, std::string_view named, bool force) {
  check_folder_of(file, named);
  if (is_stream(file)) return;
  const fs::path place = check_outside_store(file, named);
  if (is_part_of_results(place))
    throw Error(cat(named, ": '", file.string(), "' is a part of the results there; choose another name"));
  std::error_code unknown;
  if (!fs::exists(place, unknown) || fs::is_empty(place, unknown) || force) return;
  const bool has_force = kind != OutputKind::pack && kind != OutputKind::page;
  if (!is_of_kind(place, kind))
    throw Error(cat(named, ": '", file.string(), "' exists and is no ", name_of(kind), " of gust; choose another name",
                    has_force ? ", or --force to replace it" : ""));
}

void make_output_folder(const fs::path& folder, std::string_view named) {
  make_folders(check_outside_store(folder, named));
}

bool is_same_output(const fs::path& a, const fs::path& b) { return real_path(a) == real_path(b); }

}  // namespace gust
