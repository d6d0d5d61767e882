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

std::string checkpoint_text(std::string_view owner, std::string_view state) {
  std::string text;  // made in place: the state may have hundreds of megabytes
  text.reserve(kMagic.size() + kHashDigits + owner.size() + 1 + state.size());
  text.append(kMagic).append(kHashDigits, '0').append(owner).append("\n").append(state);
  const std::string hash = hash_hex(std::string_view(text).substr(kMagic.size() + kHashDigits));
  return text.replace(kMagic.size(), kHashDigits, hash);
}

std::optional<std::string> checkpoint_state(std::string_view text, std::string_view owner) {
  if (!text.starts_with(kMagic)) return std::nullopt;
  text.remove_prefix(kMagic.size());
  const std::string_view hash = text.substr(0, kHashDigits);
  text.remove_prefix(hash.size());
  const std::string head = cat(owner, "\n");
  if (hash_hex(text) != hash || !text.starts_with(head)) return std::nullopt;
  return std::string(text.substr(head.size()));
}

void save_checkpoint(const Store& store, std::string_view id, std::string_view bytes) {
  const fs::path path = path_of(store, id);
  const fs::path aside = store.aside();
  make_folders(path.parent_path());
  OutputFile file(aside);
  file.append(checkpoint_text(id, bytes));
  file.close();
  if (::rename(aside.c_str(), path.c_str()) != 0) throw file_error(path, "cannot write");
}

std::optional<std::string> load_checkpoint(const Store& store, std::string_view id) {
  const fs::path path = path_of(store, id);
  std::error_code error;
  if (!fs::exists(path, error)) return std::nullopt;
  try {
    return checkpoint_state(read_file(path, kCheckpointBytes), id);
  } catch (const Error&) {  // as good as none: the training begins anew
    return std::nullopt;
  }
}

void remove_checkpoint(const Store& store, std::string_view id) { ::unlink(path_of(store, id).c_str()); }

void remove_idle_checkpoints(const Store& store) {
  std::error_code error;
  if (!fs::exists(folder_of_checkpoints(store), error)) return;
  for (const auto& [kind, id] : store.trials()) remove_checkpoint(store, id);
}

}  // namespace gust
