// mocaplm man: the manual page, made of the declared options.
#include <cstdio>

#include "app/commands.h"
#include "app/declarations.h"
#include "common/text.h"

namespace mocaplm {

namespace {

// Plain text for roff: backslashes and hyphens as they are typed, no line that looks like a
// request.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return !out.empty() && (out[0] == '.' || out[0] == '\'') ? "\\&" + out : out;
}

std::string option_text(const DeclaredOption& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back("\\fB" + escaped(name) + "\\fR");
  std::string head = join(names, ", ");
  const std::string value = option.value + (option.many ? "..." : "");
  if (option.names.empty())
    head = "\\fI" + escaped(option.place) + "\\fR";
  else if (!option.value.empty())
    head += " \\fI" + escaped(value) + "\\fR";
  const std::string limits = option.limits();
  return ".TP\n" + head + "\n" +
         escaped(option.help + (limits.empty() ? "" : " (" + limits + ")") +
                 (option.required ? " [required]" : "")) +
         "\n";
}

std::string command_text(const DeclaredCommand& command) {
  std::string text = ".SS " + escaped("mocaplm " + command.name) + "\n" + escaped(command.help) +
                     ".\n.PP\n.B " + escaped(command.usage()) + "\n";
  std::string group;
  for (const DeclaredOption& option : command.options) {
    if (!option.names.empty() && option.names.back() == "--help") continue;
    if (option.group != group) text += ".PP\n" + escaped(option.group) + ":\n";
    group = option.group;
    text += option_text(option);
  }
  for (const Example& example : command.examples)
    text += ".PP\n" + escaped("Example: " + example.what) + ":\n.PP\n.RS 4\n.EX\n" +
            escaped("mocaplm " + example.words) + "\n.EE\n.RE\n";
  return text;
}

std::string walk_text() {
  std::string text;
  for (const Example& step : walk_examples())
    text += ".TP\n" + escaped("mocaplm " + step.words) + "\n" + escaped(step.what) + ".\n";
  return text;
}

std::string man_page(const CLI::App& app, const std::vector<DeclaredCommand>& commands) {
  std::string text =
      ".\\\" Made by mocaplm man from the declared options.\n"
      ".TH MOCAPLM 1 \"\" \"mocaplm " MOCAPLM_VERSION
      "\" \"User Commands\"\n"
      ".SH NAME\nmocaplm \\- motion capture as a language\n"
      ".SH SYNOPSIS\n.B mocaplm\n.I COMMAND\n.RI [ OPTIONS ]\n"
      ".SH DESCRIPTION\n" +
      escaped(app.get_description()) + "\n.SH THE WALK\n" + walk_text() + ".SH COMMANDS\n";
  for (const DeclaredCommand& command : commands) text += command_text(command);
  return text +
         ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\na fault of the program\n.TP\n2\n"
         "the command line asks for what cannot be\n.TP\n3\n"
         "a file is not what it must be; the message names the place\n"
         ".SH FILES\nA model is a folder, a dataset another; tables are also written as JSON with\n"
         ".BR \\-\\-json .\n.B mocaplm info\nsays what a file is.\n"
         ".SH NOTES\nWhat needs LibTorch lies in\n.BR mocaplm\\-torch ,\n"
         "which this program starts.\n";
}

}  // namespace

void add_man_page(CLI::App& app) {
  CLI::App* command = app.add_subcommand("man", "print the manual page")->group("");
  command->callback([&app] { std::fputs(man_page(app, all_declarations(app)).c_str(), stdout); });
}

}  // namespace mocaplm
