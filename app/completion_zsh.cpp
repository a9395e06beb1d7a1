#include "app/completion.h"
#include "common/text.h"

namespace mocaplm {

namespace {

// Inside '...[help]...': zsh takes ] for the end and knows no way around that.
std::string in_brackets(const std::string& help) {
  std::string out = "[";
  for (const char c : help) {
    if (c == '\'')
      out += "'\\''";
    else
      out += c == '[' ? '(' : c == ']' ? ')' : c;
  }
  return out + "]";
}

// The values of an option: a list, files, or nothing to choose from.
std::string action(const DeclaredOption& option) {
  if (!option.choices.empty()) return "(" + join(option.choices, " ") + ")";
  const FileKind files = file_kind(option);
  if (!files.any) return " ";
  if (files.folders) return "_files -/";
  if (files.endings.empty()) return "_files";
  return "_files -g \"(#i)*.(" + join(files.endings, "|") + ")\"";
}

std::string specification(const DeclaredOption& option) {
  if (option.names.empty())
    return std::string(" \\\n    '") + (option.many ? "*" : "") + ":" + option.place + ":" +
           action(option) + "'";
  std::string all;
  const std::string others = option.names.size() > 1 ? "(" + join(option.names, " ") + ")" : "";
  for (const std::string& name : option.names) {
    all += " \\\n    '" + (option.many ? "*" : others) + name;
    if (option.value.empty())
      all += in_brackets(option.help) + "'";
    else
      all += (name.rfind("--", 0) == 0 ? "=" : "+") + in_brackets(option.help) + ":" +
             option.value + ":" + action(option) + "'";
  }
  return all;
}

std::string function_name(std::string command) {
  for (char& c : command)
    if (c == ' ') c = '_';
  return "_mocaplm_" + command;
}

std::string described(const std::string& name, const std::string& help) {
  std::string text = name + ":" + help, out;
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return " '" + out + "'";
}

// A choice of commands, then the chosen one's function.
std::string chooser(const std::string& function, const std::string& flags,
                    const std::vector<const DeclaredCommand*>& commands) {
  std::string list, cases;
  for (const DeclaredCommand* command : commands) {
    const std::string name = command->name.substr(command->name.rfind(' ') + 1);
    list += described(name, command->help);
    cases += "        (" + name + ") " + function_name(command->name) + " ;;\n";
  }
  return function +
         "() {\n  local curcontext=$curcontext state line\n  local -a commands\n"
         "  typeset -A opt_args\n  commands=(" +
         list + ")\n  _arguments -C" + flags +
         " '1: :->command' '*:: :->rest'\n  case $state in\n"
         "    (command) _describe -t commands command commands ;;\n"
         "    (rest)\n      case $words[1] in\n" +
         cases + "      esac ;;\n  esac\n}\n\n";
}

std::vector<const DeclaredCommand*> parts_of(const std::string& parent,
                                             const std::vector<DeclaredCommand>& commands) {
  std::vector<const DeclaredCommand*> parts;
  for (const DeclaredCommand& command : commands) {
    const std::size_t space = command.name.find(' ');
    if (parent.empty() ? space == std::string::npos : command.name.substr(0, space) == parent)
      if (command.name != parent) parts.push_back(&command);
  }
  return parts;
}

}  // namespace

std::string zsh_completion(const std::vector<DeclaredCommand>& commands) {
  std::string script =
      "#compdef mocaplm\n# Completion of mocaplm for zsh, made by: mocaplm completion zsh\n\n";
  for (const DeclaredCommand& command : commands) {
    if (!command.parts.empty()) {
      script += chooser(function_name(command.name), " '--help[print help]'",
                        parts_of(command.name, commands));
      continue;
    }
    script += function_name(command.name) + "() {\n  _arguments -s";
    for (const DeclaredOption& option : command.options) script += specification(option);
    script += "\n}\n\n";
  }
  return script +
         chooser("_mocaplm", " '--help[print help]' '--version[print the version]'",
                 parts_of("", commands)) +
         "if [[ $funcstack[1] == _mocaplm ]]; then\n  _mocaplm \"$@\"\nelse\n"
         "  compdef _mocaplm mocaplm\nfi\n";
}

}  // namespace mocaplm
