#include <algorithm>

#include "gust/core/hash.h"
#include "gust/study/policies/file_policy.h"
#include "gust/study/policies/policy_entry.h"

namespace gust {
namespace {

struct Onnx final : PolicySource {
  Written file{"required", "text"};
  Written output{"found", "text"};
  Written alpha{"the file's own", "number"};
  Written observe{"all, in the plant's order", "list"};
  Written act{"the preset's", "text or table"};
  Written units{"the preset's", "text"};

  static constexpr std::string_view kFileEnding = ".onnx";
  static constexpr std::tuple kFields = {
      field(
          "file", &Onnx::file,
          "a path or a pattern such as policies/*.onnx, relative to the study; ** is all folders below. Several files "
          "count as seeds, byte-equal ones as one"),
      field("output", &Onnx::output, "the output of the file that is the action, where it has several"),
      field("alpha", &Onnx::alpha, "the risk level to act at, of a policy that takes one", kLevels),
      field("observe", &Onnx::observe, "what the network sees, in its order, with sign, unit or scale (docs/study.md)"),
      field("act", &Onnx::act, "what its outputs are: a unit, or { unit, scale, offset } (docs/study.md)"),
      field("units", &Onnx::units, "the unit of its actions: normalised, %, or the plant's, such as N"),
  };

  void prepare(const PolicyContext& context) override {
    if (alpha) read_value(use_.alpha.emplace(), *alpha, "alpha", alpha.range);
    if (output) use_.output = output->as_text("output");
    use_.interface = read_interface(interface_table(), context.spec());
    interface_text_ = use_.interface.canonical(context.spec());
    if (!file) throw error_at(context.place, "an onnx policy needs a 'file'");
    const std::string& pattern = file->as_text("file");
    files_ = context.find(pattern, file->place);
    if (files_.empty()) throw error_at(file->place, "no file matches '", pattern, "'");
    leave_out_copies();
    for (const StudyFile& one : files_) {
      const FilePolicy read = file_policy(one.bytes, one.path, context.setup, use_of(one));
      foreign_ = foreign_ || read.foreign;
      if (unit_warning_.empty()) unit_warning_ = read.unit_warning;
    }
  }

  /// A file is its bytes, and those of the files that hold its weights.
  std::string canonical(const PolicyMember& member) const override {
    std::string text = cat("onnx ", hash_hex(files_[member.index].bytes));
    for (const auto& [name, bytes] : files_[member.index].data) text += cat(" data ", hash_hex(bytes));
    return cat(text, "\n", use_.output.empty() ? "" : cat("output ", use_.output, "\n"), level_text(use_.alpha),
               interface_text_);
  }

  std::vector<std::string> members() const override {
    std::vector<std::string> paths;
    for (const StudyFile& one : files_) paths.push_back(one.path);
    return paths;
  }

  bool foreign() const override { return foreign_; }

  std::vector<std::string> warnings() const override {
    std::vector<std::string> warnings;
    for (const auto& [copy, original] : copies_)
      warnings.push_back(cat(copy, " equals ", original, " byte for byte; the two are one policy and count once"));
    if (!unit_warning_.empty()) warnings.push_back(unit_warning_);
    return warnings;
  }

  std::unique_ptr<Policy> make(const Setup& setup, const PolicyMember& member) const override {
    const StudyFile& one = files_[member.index];
    return onnx_policy(one.bytes, one.path, setup, use_of(one));
  }

 private:
  Table interface_table() const {
    Table table;
    const std::pair<const char*, const Written*> keys[] = {{"observe", &observe}, {"act", &act}, {"units", &units}};
    for (const auto& [key, written] : keys) {
      if (*written) table.set(key, **written);
    }
    return table;
  }

  PolicyUse use_of(const StudyFile& one) const {
    PolicyUse use = use_;
    use.data = &one.data;
    return use;
  }

  /// Files of one content are one policy, not several seeds: the first of them stays.
  void leave_out_copies() {
    std::vector<StudyFile> kept;
    for (StudyFile& one : files_) {
      const auto same = std::ranges::find_if(
          kept, [&](const StudyFile& other) { return other.bytes == one.bytes && other.data == one.data; });
      if (same == kept.end())
        kept.push_back(std::move(one));
      else
        copies_.emplace_back(one.path, same->path);
    }
    files_ = std::move(kept);
  }

  std::vector<StudyFile> files_;
  std::vector<std::pair<std::string, std::string>> copies_;  // files left out, each with the one that it equals
  PolicyUse use_;
  std::string interface_text_;
  bool foreign_ = false;
  std::string unit_warning_;  // of the first file whose unit nobody says
};

}  // namespace

PolicyKind policy_onnx() {
  return policy_entry<Onnx>({"onnx",
                             "A network from an ONNX file, gust's own or another program's; several files are seeds of "
                             "one policy.",
                             "docs/formats.md",
                             "[[policy]]\nname = \"theirs\"\nkind = \"onnx\"\nfile = \"policies/*.onnx\"\nobserve = "
                             "[\"theta\", \"theta_dot=deg/s\", \"-x\", \"x_dot\"]\nunits = \"N\""});
}

}  // namespace gust
