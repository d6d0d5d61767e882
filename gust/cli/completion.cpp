#include "gust/cli/completion.h"

#include <map>

#include "gust/cli/catalogue.h"
#include "gust/cli/command.h"
#include "gust/core/text.h"
#include "gust/study/policies/policy_source.h"

namespace gust {
namespace {

/// What may be typed after a command.
struct Completed {
  struct Option {
    std::string name;
    std::string about;
    bool takes_value = false;
    std::vector<std::string> values;  ///< empty: a file, a number or free text
  };
  std::string name;
  std::string about;
  std::vector<Option> options;
  std::vector<std::string> words;  ///< that may be typed without an option
};

using Words = std::map<std::string, std::vector<std::string>>;

/// The words that are known for an option or a place: "--plant", "eval".
Words known_words(const std::vector<CatalogueKind>& kinds) {
  Words words;
  const auto names = [&](std::string_view kind) {
    std::vector<std::string> list;
    for (const CatalogueItem& item : find_kind(kinds, kind).items) list.push_back(item.name);
    return list;
  };
  for (const char* kind : {"plant", "preset", "waveform", "effect", "site"}) words[cat("--", kind)] = names(kind);
  words["--terminate"] = {"yes", "no"};
  words["--start"] = {"nominal", "random"};
  words["--color"] = {"auto", "always", "never"};
  for (const PolicyKind& kind : policy_kinds()) {
    if (!kind.trained) words["eval"].push_back(kind.name);
  }
  words["train"] = names("agent");
  words["help"] = names("command");
  words["completion"] = {"bash", "zsh", "fish"};
  for (const CatalogueKind& kind : kinds) {
    words["list"].push_back(kind.plural);
    words["describe"].push_back(kind.name);
    for (const CatalogueItem& item : kind.items) words["describe"].push_back(item.name);
  }
  return words;
}

/// The first line, without what would end a quotation of any of the shells.
std::string short_text(const std::string& text) {
  std::string to;
  for (const char letter : text.substr(0, text.find('\n'))) {
    if (std::string_view("'\"`$\\[]:").find(letter) == std::string_view::npos) to += letter;
  }
  return to;
}

std::vector<Completed> completed_commands(const CLI::App& program) {
  const Words words = known_words(catalogue(program));
  const auto look_up = [&](const std::string& key) {
    const auto found = words.find(key);
    return found == words.end() ? std::vector<std::string>{} : found->second;
  };
  std::vector<Completed> commands;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    Completed one{command->get_name(), short_text(command->get_description()), {}, look_up(command->get_name())};
    for (const std::string& name : command_names(*command)) one.words.push_back(name);
    for (const CLI::App* app : {command, &program}) {
      for (const CLI::Option* option : app->get_options()) {
        if (option->get_lnames().empty()) continue;
        const std::string name = "--" + option->get_lnames().front();
        one.options.push_back(
            {name, short_text(option->get_description()), option->get_items_expected_max() > 0, look_up(name)});
      }
    }
    commands.push_back(std::move(one));
  }
  return commands;
}

std::string option_list(const Completed& command) {
  std::vector<std::string> names;
  for (const Completed::Option& option : command.options) names.push_back(option.name);
  return join(names, " ");
}

std::string bash_script(const std::vector<Completed>& commands) {
  std::string names, cases;
  std::map<std::string, std::string> values;
  for (const Completed& command : commands) {
    names += (names.empty() ? "" : " ") + command.name;
    cases +=
        cat("    ", command.name, ") options='", option_list(command), "' words='", join(command.words, " "), "' ;;\n");
    for (const Completed::Option& option : command.options) {
      if (!option.values.empty()) values[option.name] = join(option.values, " ");
    }
  }
  std::string value_cases;
  for (const auto& [name, list] : values) {
    value_cases += cat("    ", name, ") COMPREPLY=($(compgen -W '", list, "' -- \"$typed\")); return ;;\n");
  }
  return cat(
      "# bash completion of gust: source <(gust completion bash)\n"
      "_gust() {\n"
      "  local typed=\"${COMP_WORDS[COMP_CWORD]}\" before=\"${COMP_WORDS[COMP_CWORD-1]}\" options='' words=''\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then COMPREPLY=($(compgen -W '",
      names,
      "' -- \"$typed\")); return; fi\n"
      "  case \"$before\" in\n",
      value_cases,
      "  esac\n"
      "  case \"${COMP_WORDS[1]}\" in\n",
      cases,
      "  esac\n"
      "  if [[ $typed == -* ]]; then COMPREPLY=($(compgen -W \"$options\" -- \"$typed\"))\n"
      "  else COMPREPLY=($(compgen -W \"$words\" -- \"$typed\") $(compgen -f -- \"$typed\")); fi\n"
      "}\n"
      "complete -o filenames -F _gust gust\n");
}

std::string zsh_script(const std::vector<Completed>& commands) {
  std::string names, cases;
  for (const Completed& command : commands) {
    names += cat("    '", command.name, ":", command.about, "'\n");
    std::string arguments;
    for (const Completed::Option& option : command.options) {
      const std::string values = option.values.empty() ? "_files" : cat("(", join(option.values, " "), ")");
      arguments += cat(" \\\n      '*", option.name, "[", option.about, "]",
                       option.takes_value ? cat(":value:", values) : "", "'");
    }
    const std::string words =
        command.words.empty() ? "*:file:_files" : cat("*: :{ compadd ", join(command.words, " "), "; _files }");
    cases += cat("    ", command.name, ") _arguments", arguments, " \\\n      '", words, "' ;;\n");
  }
  return cat(
      "#compdef gust\n"
      "# zsh completion of gust: source <(gust completion zsh), or keep it as _gust in a folder of $fpath\n"
      "_gust() {\n"
      "  local -a commands=(\n",
      names,
      "  )\n"
      "  if (( CURRENT == 2 )); then _describe command commands; return; fi\n"
      "  local command=$words[2]\n"
      "  shift words; (( CURRENT-- ))\n"
      "  case $command in\n",
      cases,
      "  esac\n"
      "}\n"
      "compdef _gust gust\n");
}

std::string fish_script(const std::vector<Completed>& commands) {
  std::string text = "# fish completion of gust: gust completion fish | source\n";
  for (const Completed& command : commands) {
    text += cat("complete -c gust -n __fish_use_subcommand -a ", command.name, " -d '", command.about, "'\n");
    const std::string when = cat("complete -c gust -n '__fish_seen_subcommand_from ", command.name, "'");
    if (!command.words.empty()) text += cat(when, " -a '", join(command.words, " "), "'\n");
    for (const Completed::Option& option : command.options) {
      const std::string values = option.values.empty() ? "" : cat(" -x -a '", join(option.values, " "), "'");
      const std::string required = option.takes_value && option.values.empty() ? " -r" : "";
      text += cat(when, " -l ", option.name.substr(2), values, required, " -d '", option.about, "'\n");
    }
  }
  return text;
}

}  // namespace

std::string completion_script(const CLI::App& program, const std::string& shell) {
  const std::vector<Completed> commands = completed_commands(program);
  if (shell == "bash") return bash_script(commands);
  if (shell == "zsh") return zsh_script(commands);
  if (shell == "fish") return fish_script(commands);
  const std::vector<std::string> shells = {"bash", "zsh", "fish"};
  throw Error(cat("unknown shell '", shell, "'", did_you_mean(shell, shells), "; known are ", join(shells, ", ")));
}

}  // namespace gust
