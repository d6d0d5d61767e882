#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

#include "gust/study/text/study.h"

namespace gust::test {

/// A small study over regulators only, which runs in milliseconds.
inline constexpr std::string_view kSmallStudy = R"(schema = 1
name = "small"
seed = 7
plant = { kind = "cartpole", preset = "scg-default" }

[evaluate]
episodes = 3

[[policy]]
name = "lqr"
kind = "lqr"

[[policy]]
name = "nothing"
kind = "zero"

[[sweep]]
name = "push"
site = "action"
waveform = { kind = "step", offset = 2 }
levels = [0, 5, 30]

[[sweep]]
name = "noise"
site = "dynamics"
waveform = "white"
levels = { from = 0, to = 1, count = 2 }

[[claim]]
id = "falls"
where = { policy = "nothing" }
holds = "survival <= 0.8"

[report]
keep_traces = "worst 1, median 1"
)";

inline std::vector<StudyFile> no_files(const std::string&, const Place&) { return {}; }

inline Study small_study(const std::vector<std::string>& settings = {}, std::string_view text = kSmallStudy) {
  return parse_study(text, "small.toml", settings, no_files);
}

/// kSmallStudy with one piece of its text replaced.
inline std::string changed(const std::string& from, const std::string& to) {
  std::string text(kSmallStudy);
  return text.replace(text.find(from), from.size(), to);
}

/// An empty folder that vanishes with the object.
struct ScratchFolder {
  std::filesystem::path path;
  explicit ScratchFolder(const std::string& name)
      : path(std::filesystem::temp_directory_path() / (name + "-" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path);
  }
  ~ScratchFolder() { std::filesystem::remove_all(path); }
};

}  // namespace gust::test
