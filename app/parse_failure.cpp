#include "app/parse_failure.h"

#include <vector>

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

}  // namespace

std::string parse_failure(const CLI::App& app, int argc, char** argv,
                          const CLI::ParseError& error) {
  const Named named = named_command(app, argc, argv);
  const std::string more = "\nTry '" + named.words + " --help'.";
  const std::vector<std::string> commands = command_names(*named.app);
  if (!named.unknown.empty())
    return "there is no command \"" + named.unknown + "\"" + did_you_mean(named.unknown, commands) +
           " (commands: " + join(commands, ", ") + ")" + more;
  const std::string option = unknown_option(app);
  if (!option.empty()) {
    std::vector<std::string> names;
    add_option_names(*named.app, names);
    const std::string nearest = nearest_name(option.substr(option.find_first_not_of('-')), names);
    return named.words + " has no option \"" + option + "\"" +
           (nearest.empty() ? "" : ", did you mean \"--" + nearest + "\"?") + more;
  }
  if (!commands.empty()) return "give a command: " + join(commands, ", ") + more;
  return error.what() + more;
}

}  // namespace mocaplm
