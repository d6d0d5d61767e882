#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "gust/study/store.h"

namespace gust {

/// Keeps the state of a training in progress: STORE/checkpoints/<id>, replaced whole or not at all. Committing the
/// trial removes it.
void save_checkpoint(const Store& store, std::string_view id, std::string_view bytes);

/// The bytes last saved for the trial; nothing if there are none or if they are damaged.
std::optional<std::string> load_checkpoint(const Store& store, std::string_view id);

/// Forgets the checkpoint of a trial, if there is one.
void remove_checkpoint(const Store& store, std::string_view id);

/// Forgets the checkpoints of trials that are finished, which a second process may have left.
void remove_idle_checkpoints(const Store& store);

}  // namespace gust
