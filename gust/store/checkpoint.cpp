#include "gust/store/checkpoint.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "gust/core/error.h"
#include "gust/core/hash.h"
#include "gust/store/files.h"

namespace gust {
namespace {

namespace fs = std::filesystem;

// A checkpoint is this line, the hash of everything after it as 32 digits, the identity of its trial, a line break, and
// the bytes.
constexpr std::string_view kMagic = "gust checkpoint 1\n";
constexpr std::size_t kHashDigits = 32;
constexpr std::size_t kMostBytes = std::size_t{4} << 30;  // a replay buffer is the greatest part

fs::path folder_of_checkpoints(const Store& store) { return store.folder() / "checkpoints"; }

fs::path path_of(const Store& store, std::string_view id) {
  GUST_CHECK(valid_store_name(id));
  return folder_of_checkpoints(store) / id;
}

}  // namespace

bool has_checkpoint(const Store& store, std::string_view id) {
  std::error_code error;
  return fs::exists(path_of(store, id), error);
}

void save_checkpoint(const Store& store, std::string_view id, std::string_view bytes) {
  const fs::path path = path_of(store, id);
  const fs::path aside = store.aside();
  const std::string content = cat(id, "\n", bytes);
  make_folders(path.parent_path());
  OutputFile file(aside);
  file.append(kMagic);
  file.append(hash_hex(content));
  file.append(content);
  file.close();
  if (::rename(aside.c_str(), path.c_str()) != 0) throw file_error(path, "cannot write");
}

std::optional<std::string> load_checkpoint(const Store& store, std::string_view id) {
  const fs::path path = path_of(store, id);
  std::error_code error;
  if (!fs::exists(path, error)) return std::nullopt;
  std::string whole;
  try {
    whole = read_file(path, kMostBytes);
  } catch (const Error&) {  // as good as none: the training begins anew
    return std::nullopt;
  }
  std::string_view rest = whole;
  if (!rest.starts_with(kMagic)) return std::nullopt;
  rest.remove_prefix(kMagic.size());
  const std::string_view hash = rest.substr(0, kHashDigits);
  rest.remove_prefix(hash.size());
  const std::string owner = cat(id, "\n");
  if (hash_hex(rest) != hash || !rest.starts_with(owner)) return std::nullopt;
  return std::string(rest.substr(owner.size()));
}

void remove_checkpoint(const Store& store, std::string_view id) { ::unlink(path_of(store, id).c_str()); }

void remove_idle_checkpoints(const Store& store) {
  std::error_code error;
  if (!fs::exists(folder_of_checkpoints(store), error)) return;
  for (const auto& [kind, id] : store.trials()) remove_checkpoint(store, id);
}

}  // namespace gust
