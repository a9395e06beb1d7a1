#include "app/help.h"

#include <algorithm>

#include "app/declarations.h"
#include "app/guide.h"
#include "common/text.h"

namespace mocaplm {

namespace {

constexpr std::size_t kWidth = 80;

// Words in lines that begin at `column`; the first line has begun already.
std::string wrapped(const std::string& text, std::size_t column) {
  std::string out;
  std::size_t at = column;
  for (const std::string& word : split(text, ' ')) {
    if (at > column && at + 1 + word.size() > kWidth) {
      out += "\n" + std::string(column, ' ');
      at = column;
    } else if (at > column) {
      out += " ";
      ++at;
    }
    out += word;
    at += word.size();
  }
  return out;
}

// A command after two spaces, broken where a shell goes on reading.
std::string command_line(const std::string& command) {
  constexpr std::size_t kMost = kWidth - 4;  // the spaces, and " \\" at the end
  if (command.size() + 2 <= kWidth) return command;
  // Before an option, so that its value stays beside it.
  const std::size_t option = command.rfind(" --", kMost);
  const std::size_t space = option != std::string::npos ? option : command.rfind(' ', kMost);
  return command.substr(0, space) + " \\\n      " + command.substr(space + 1);
}

// A name, and from `column` on what it is: on the next line where the name is longer.
std::string entry(const std::string& name, const std::string& text, std::size_t column) {
  std::string line = "  " + name;
  if (line.size() + 2 > column) line += "\n" + std::string(column, ' ');
  if (line.size() < column) line.resize(column, ' ');
  return line + wrapped(text, column) + "\n";
}

std::string option_entry(const DeclaredOption& option) {
  std::string name = option.names.empty() ? option.place : join(option.names, ", ");
  if (!option.names.empty() && !option.value.empty())
    name += " " + option.value + (option.many ? "..." : "");
  const std::string limits = option.limits();
  return entry(name,
               option.help + (limits.empty() ? "" : " (" + limits + ")") +
                   (option.required ? " [required]" : ""),
               26);
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string command_page(const CLI::App& app, const std::string& full_name) {
  const std::string name = full_name.substr(full_name.find(' ') + 1);  // without the program's
  const DeclaredCommand command = declaration(app, name);
  std::string page = "Usage: " + wrapped(command.usage(), 7) + "\n\n" +
                     wrapped(capitalised(command.help) + ".", 0) + "\n";
  for (const std::string& part : command.parts)
    page += (part == command.parts.front() ? "\nCommands\n" : "") +
            entry(part, find_command(app, part)->get_description(), 16);
  std::string group = "\n";
  for (const DeclaredOption& option : command.options) {
    if (option.group != group) {
      group = option.group;
      page += "\n" + (group.empty() ? "Options" : "Options: " + group) + "\n";
    }
    page += option_entry(option);
  }
  if (!command.examples.empty()) page += "\nExamples\n";
  for (const Example& example : command.examples)
    page += "  " + command_line("mocaplm " + example.words) + "\n      " +
            wrapped(example.what, 6) + "\n";
  return page;
}

std::string general_page(const CLI::App& app) {
  std::string page = wrapped(app.get_description(), 0) + "\n\n";
  for (const Example& step : walk_examples()) page += entry("mocaplm " + step.words, step.what, 46);
  std::string group;
  // In the guide's order.
  for (const CommandGuide& guide : command_guides()) {
    const CLI::App* command = find_command(app, guide.command);
    if (command == nullptr || guide.group.empty()) continue;
    if (guide.group != group) page += "\n" + guide.group + "\n";
    group = guide.group;
    page += entry(guide.command, command->get_description(), 15);
  }
  return page +
         "\nmocaplm COMMAND --help: options, examples; mocaplm --version: what is installed.\n"
         "More: man mocaplm, and docs/ in the source.\n";
}

}  // namespace

std::string HelpPages::make_help(const CLI::App* app, std::string name,
                                 CLI::AppFormatMode /*mode*/) const {
  return app->get_parent() == nullptr ? general_page(*app) : command_page(*app, name);
}

}  // namespace mocaplm
