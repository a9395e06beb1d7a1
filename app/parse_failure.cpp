#include "app/parse_failure.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "app/between.h"
#include "app/declarations.h"
#include "common/suggest.h"
#include "common/text.h"

namespace mocaplm {

namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands_of(app))
    if (!is_hidden(*command)) names.push_back(command->get_name());
  return names;
}

void add_option_names(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  for (const CLI::App* group : option_groups_of(app)) add_option_names(*group, names);
}

// The command that the words name so far, "mocaplm emulate", and its declaration.
struct Named {
  const CLI::App* app = nullptr;
  std::string words = "mocaplm";
  std::string unknown;  // the word in the place of a command that is none
};

Named named_command(const CLI::App& app, int argc, char** argv) {
  Named named;
  named.app = &app;
  for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
    if (command_names(*named.app).empty()) break;
    const CLI::App* next = find_command(*named.app, argv[i]);
    if (next == nullptr) {
      named.unknown = argv[i];
      break;
    }
    named.app = next;
    named.words += std::string(" ") + argv[i];
  }
  return named;
}

// The first word left over that looks like an option, without its value.
std::string unknown_option(const CLI::App& app) {
  for (const std::string& word : app.remaining(true))
    if (word[0] == '-' && word.find_first_not_of('-') != std::string::npos)
      return word.substr(0, word.find('='));
  return "";
}

// What an option takes, in words.
std::string taken(const DeclaredOption& option) {
  if (!option.choices.empty()) return "one of " + join(option.choices, ", ");
  if (option.value.empty()) return "true or false";
  if (option.value != "N" && option.value != "X") return option.value;
  const std::string number = option.value == "N" ? "whole number" : "number";
  return (option.many ? "a list of " + number + "s" : "a " + number) +
         (option.range.empty() ? "" : " from " + option.range);
}

// What the parser says of an option's value, with CLI11's types and rounded limits put in words.
std::string value_failure(const DeclaredCommand& command, const std::string& said) {
  const std::string unread = "Could not convert: ";
  const bool is_unread = said.rfind(unread, 0) == 0;
  const std::string name =
      is_unread ? between(said, unread, " = ") : said.substr(0, said.find(": "));
  const auto option =
      std::find_if(command.options.begin(), command.options.end(), [&](const DeclaredOption& one) {
        return std::find(one.names.begin(), one.names.end(), name) != one.names.end();
      });
  if (option == command.options.end()) return said;
  if (said.find(" required ") != std::string::npos && said.find(" missing") != std::string::npos)
    return name + " needs a value: " + taken(*option);
  if (said.find(": At Most 1 ") != std::string::npos) return name + " can be given only once";
  std::string given = between(said, ": Value ", " not in range");
  if (given.empty()) given = between(said, ": Check ", " value in ");
  if (is_unread) given = said.substr(said.find(" = ") + 3);
  return given.empty() ? said : name + ": \"" + given + "\" is not " + taken(*option);
}

// The nearest long name to an option that there is not; the very name where only a hyphen lacks.
std::string nearest_option(const CLI::App& app, const std::string& option) {
  std::vector<std::string> names;
  add_option_names(app, names);
  const std::string bare = option.substr(option.find_first_not_of('-'));
  if (std::find(names.begin(), names.end(), bare) != names.end()) return bare;
  return nearest_name(bare, names);
}

}  // namespace

std::string parse_failure(const CLI::App& app, int argc, char** argv,
                          const CLI::ParseError& error) {
  const Named named = named_command(app, argc, argv);
  const std::string more = "\nTry '" + named.words + " --help'.";
  const std::vector<std::string> commands = command_names(*named.app);
  if (!named.unknown.empty()) {
    const std::string near = did_you_mean(named.unknown, commands);
    std::error_code error_code;
    if (named.app == &app && near.empty() && std::filesystem::exists(named.unknown, error_code))
      return "\"" + named.unknown +
             "\" is no command but a file or folder; mocaplm info says which" + more;
    return "there is no command \"" + named.unknown + "\"" +
           (near.empty() ? "; commands: " + join(commands, ", ") : near) + more;
  }
  const std::string option = unknown_option(app);
  if (!option.empty()) {
    const std::string nearest = nearest_option(*named.app, option);
    return named.words + " has no option \"" + option + "\"" +
           (nearest.empty() ? "" : ", did you mean \"--" + nearest + "\"?") + more;
  }
  if (!commands.empty()) return "give a command: " + join(commands, ", ") + more;
  const std::vector<std::string> rest = app.remaining(true);
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError) && !rest.empty())
    return named.words + " has no use for \"" + rest.front() + "\"" + more;
  return value_failure(declaration(*named.app, named.words), error.what()) + more;
}

}  // namespace mocaplm
