// mocaplm completion: a script for bash or zsh.
#include "app/completion.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "common/text.h"

namespace mocaplm {

namespace {

bool has_word(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

std::string in_quotes(const std::string& text) {
  return "'" + text + "'";  // names of commands and options hold no quotes
}

// What may follow: words to choose from and files, as two variables of the script.
std::string settings_of(const DeclaredOption& option) {
  if (!option.choices.empty()) return "words=" + in_quotes(join(option.choices, " "));
  const FileKind files = file_kind(option);
  if (!files.any) return ":";
  return "files=" + in_quotes(files.folders           ? "/"
                              : files.endings.empty() ? "*"
                                                      : join(files.endings, "|"));
}

// 'synth') options='--out --seed'; files='npz|bvh' ;;
std::string command_line(const DeclaredCommand& command) {
  std::vector<std::string> options;
  std::string rest = command.parts.empty() ? "" : "; words=" + in_quotes(join(command.parts, " "));
  for (const DeclaredOption& option : command.options) {
    options.insert(options.end(), option.names.begin(), option.names.end());
    if (option.names.empty()) rest = "; " + settings_of(option);
  }
  return "    " + in_quotes(command.name) + ") options=" + in_quotes(join(options, " ")) + rest +
         " ;;\n";
}

// Options that take a value, those with the same values together.
std::string value_lines(const std::vector<DeclaredCommand>& commands) {
  std::vector<std::string> order;
  std::map<std::string, std::string> patterns;
  for (const DeclaredCommand& command : commands)
    for (const DeclaredOption& option : command.options) {
      if (option.value.empty()) continue;
      for (const std::string& name : option.names) {
        const std::string settings = settings_of(option);
        std::string& all = patterns[settings];
        if (all.empty()) order.push_back(settings);
        all += (all.empty() ? "" : "|") + in_quotes(command.name + " " + name);
      }
    }
  std::string lines;
  for (const std::string& settings : order)
    lines += "    " + patterns[settings] + ")\n      " + settings + " ;;\n";
  return lines;
}

constexpr const char* kBashFiles = R"(
# Folders, and files with the endings $1 ("npz|bvh"; "*": any, "/": none).
_mocaplm_files() {
  local name
  compopt -o filenames 2> /dev/null
  while IFS= read -r name; do
    if [[ -d ${name/#\~/$HOME} || $1 == '*' || ( $1 != / && ${name,,} =~ \.($1)$ ) ]]; then
      COMPREPLY+=("$name")
    fi
  done < <(compgen -f -- "$cur")
}
)";

constexpr const char* kBashEnd = R"(
_mocaplm() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]}
  local command= word words= files= options= i
  COMPREPLY=()
  # --option=value is three words.
  if [[ $cur == = ]]; then cur=; elif [[ $prev == = ]]; then prev=${COMP_WORDS[COMP_CWORD - 2]}; fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    word=${COMP_WORDS[i]}
    _mocaplm_is_command "$command $word" || break
    command=${command:+$command }$word
  done
  if ! _mocaplm_value; then
    _mocaplm_command
    if [[ $cur == -* ]]; then
      words=$options
      files=
    fi
  fi
  if [[ -n $files ]]; then
    _mocaplm_files "$files"
  else
    COMPREPLY=($(compgen -W "$words" -- "$cur"))
  fi
}

complete -F _mocaplm mocaplm
)";

}  // namespace

FileKind file_kind(const DeclaredOption& option) {
  FileKind kind;
  kind.folders = option.value == "FOLDER";
  kind.any =
      kind.folders || option.value == "FILE" || option.value == "PATH" || option.value == "OUT";
  if (!kind.any || kind.folders) return kind;
  const std::string name = option.names.empty() ? "" : option.names.front();
  const bool json = name == "--json" || name == "--config" || has_word(option.help, "JSON map");
  kind.endings = json ? std::vector<std::string>{"json"} : endings_in(option.help);
  return kind;
}

std::string bash_completion(const std::vector<DeclaredCommand>& commands) {
  std::string names, first, lines;
  for (const DeclaredCommand& command : commands) {
    const bool part = has_word(command.name, " ");
    names += (names.empty() ? "" : "|") + in_quotes(part ? command.name : " " + command.name);
    if (!part) first += (first.empty() ? "" : " ") + command.name;
    lines += command_line(command);
  }
  return "# Completion of mocaplm for bash, made by: mocaplm completion bash\n" +
         std::string(kBashFiles) +
         "\n# Whether \"COMMAND WORD\" names a command.\n_mocaplm_is_command() {\n  case $1 in\n   "
         " " +
         names + ") return 0 ;;\n  esac\n  return 1\n}\n" +
         "\n# What may follow the option $prev of $command; fails when it takes no value.\n"
         "_mocaplm_value() {\n  case \"$command $prev\" in\n" +
         value_lines(commands) + "    *) return 1 ;;\n  esac\n}\n" +
         "\n# What may stand anywhere after $command.\n_mocaplm_command() {\n  case $command in\n"
         "    '') options='--help --version'; words='" +
         first + "' ;;\n" + lines + "  esac\n}\n" + kBashEnd;
}

void add_completion(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("completion", "print a script that completes commands in bash or zsh");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "the shell")->required()->check(one_of({"bash", "zsh"}));
  command->callback([&app, shell] {
    std::string note;
    const std::vector<DeclaredCommand> all = all_declarations(app, &note);
    std::fputs((*shell == "bash" ? bash_completion(all) : zsh_completion(all)).c_str(), stdout);
    if (!note.empty())
      std::fprintf(stderr, "note: options of train and the like are left out: %s\n", note.c_str());
  });
  CLI::App* declared = app.add_subcommand("declarations", "all commands as JSON")->group("");
  declared->callback(
      [&app] { std::printf("%s\n", to_json(all_declarations(app)).dump(2).c_str()); });
}

}  // namespace mocaplm
