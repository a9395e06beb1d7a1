#include "app/declarations.h"

#include <algorithm>

#include "app/between.h"
#include "app/torch_part.h"
#include "common/text.h"

namespace mocaplm {

namespace {

// "{a,b}" of one_of, "{auto->0,y->1}" of CLI11's own.
std::vector<std::string> choices_in(const std::string& type) {
  const std::string listed = between(type, "{", "}");
  std::vector<std::string> names;
  if (listed.empty()) return names;
  for (const std::string& name : split(listed, ','))
    names.push_back(name.substr(0, name.find("->")));
  return names;
}

// "INT in [1 - 96]" of CLI::Range.
std::string range_in(const std::string& type) {
  std::string range = between(type, " in [", "]");
  const std::size_t at = range.find(" - ");
  return at == std::string::npos ? "" : range.replace(at, 3, " to ");
}

// What a text is, as the option's help says it to the user.
std::string text_name(const DeclaredOption& option) {
  const auto says = [&](const char* word) { return option.help.find(word) != std::string::npos; };
  const std::string name = option.names.empty() ? "" : option.names.front();
  if (says("OUT.") || says("stem of")) return "OUT";
  const bool folder = says("folder"),
             file = says("file") || !endings_in(option.help).empty() || name == "--json";
  if (folder && file) return "PATH";
  return folder ? "FOLDER" : file ? "FILE" : "TEXT";
}

// "TEXT" is CLI11's; any other name the command gave it, by type_name.
std::string value_name(const std::string& type, const DeclaredOption& option) {
  const std::string kind = type.substr(0, type.find(':'));
  if (kind == "INT" || kind == "UINT") return "N";
  if (kind == "FLOAT") return "X";
  if (!option.choices.empty()) return "NAME";
  return kind == "TEXT" ? text_name(option) : kind;
}

DeclaredOption declared(const CLI::Option& option, const std::string& group) {
  DeclaredOption d;
  for (const std::string& name : option.get_snames()) d.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) d.names.push_back("--" + name);
  d.many = option.get_expected_max() >= CLI::detail::expected_max_vector_size;
  if (d.names.empty()) d.place = option.get_name(true);
  if (d.names.empty() && d.many && d.place.find("...") == std::string::npos) d.place += "...";
  d.help = option.get_description();
  const std::string type = option.get_type_name();
  if (option.get_type_size() != 0 && option.get_expected_max() != 0) {  // no flag
    d.choices = choices_in(type);
    d.range = range_in(type);
    d.value = value_name(type, d);
  }
  d.initial = option.get_default_str();
  if (d.initial.size() > 1 && d.initial.front() == '[' && d.initial.back() == ']')
    d.initial = join(split(d.initial.substr(1, d.initial.size() - 2), ','), ", ");
  d.group = group;
  d.required = option.get_required();
  return d;
}

void add_options(const CLI::App& app, const std::string& group,
                 std::vector<DeclaredOption>& options) {
  for (const CLI::Option* option : app.get_options())
    // A group of options has a --help of its own, which is the command's.
    if (!option->get_group().empty() && (group.empty() || option != app.get_help_ptr()))
      options.push_back(declared(*option, group));
  for (const CLI::App* other : option_groups_of(app)) {
    const std::string about = other->get_description();
    add_options(*other, other->get_group() + (about.empty() ? "" : ", " + about), options);
  }
}

}  // namespace

std::vector<std::string> endings_in(const std::string& help) {
  std::vector<std::string> found;
  for (const char* ending : {"npz", "pkl", "bvh", "glb", "vrma", "csv", "json", "html", "svg",
                             "txt", "gif", "mp4", "png"})
    if (help.find(std::string(".") + ending) != std::string::npos) found.push_back(ending);
  return found;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* one) { return !one->get_name().empty(); });
}

std::vector<const CLI::App*> option_groups_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* one) { return one->get_name().empty(); });
}

const CLI::App* find_command(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : commands_of(app))
    if (command->get_name() == name) return command;
  return nullptr;
}

std::string DeclaredOption::limits() const {
  std::vector<std::string> parts;
  if (!choices.empty()) parts.push_back(join(choices, ", "));
  if (!range.empty()) parts.push_back(range);
  if (!initial.empty()) parts.push_back("default " + initial);
  return join(parts, "; ");
}

std::string DeclaredCommand::usage() const {
  std::string words = "mocaplm " + name;
  for (const DeclaredOption& option : options)
    if (option.required && !option.names.empty())
      words += " " + option.names.front() + (option.value.empty() ? "" : " " + option.value);
  words += parts.empty() ? " [OPTIONS]" : " " + join(parts, "|") + " [OPTIONS]";
  for (const DeclaredOption& option : options)
    if (option.names.empty())
      words += " " + (option.required ? option.place : "[" + option.place + "]");
  return words;
}

DeclaredCommand declaration(const CLI::App& app, const std::string& name) {
  DeclaredCommand command;
  command.name = name;
  command.help = app.get_description();
  add_options(app, "", command.options);
  for (const CLI::App* part : commands_of(app)) command.parts.push_back(part->get_name());
  if (const CommandGuide* guide = guide_of(name)) {
    command.group = guide->group;
    command.examples = guide->examples;
  }
  return command;
}

std::vector<DeclaredCommand> declarations(const CLI::App& app) {
  std::vector<DeclaredCommand> all;
  for (const CLI::App* command : commands_of(app)) {
    if (is_hidden(*command)) continue;
    all.push_back(declaration(*command, command->get_name()));
    for (const CLI::App* part : commands_of(*command))
      all.push_back(declaration(*part, command->get_name() + " " + part->get_name()));
  }
  return all;
}

std::vector<DeclaredCommand> all_declarations(const CLI::App& app, std::string* note) {
  std::vector<DeclaredCommand> all = declarations(app);
  const TorchAnswer answer = ask_torch_part("declarations");
  if (note != nullptr) *note = answer.failure;
  if (answer.failure.empty())
    for (const DeclaredCommand& other :
         declarations_from_json(answer.json, torch_part_path().string()))
      for (DeclaredCommand& one : all)
        if (one.name == other.name) one = other;
  const auto place = [](const DeclaredCommand& command) {
    const CommandGuide* guide = guide_of(command.name);
    return guide == nullptr ? command_guides().size()
                            : static_cast<std::size_t>(guide - command_guides().data());
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return all;
}

Json to_json(const std::vector<DeclaredCommand>& commands) {
  Json all = Json::array();
  for (const DeclaredCommand& command : commands) {
    Json options = Json::array();
    for (const DeclaredOption& o : command.options)
      options.push_back({{"names", o.names},
                         {"place", o.place},
                         {"value", o.value},
                         {"choices", o.choices},
                         {"range", o.range},
                         {"default", o.initial},
                         {"help", o.help},
                         {"group", o.group},
                         {"required", o.required},
                         {"many", o.many}});
    Json examples = Json::array();
    for (const Example& example : command.examples)
      examples.push_back({{"words", example.words}, {"what", example.what}});
    all.push_back({{"command", command.name},
                   {"group", command.group},
                   {"help", command.help},
                   {"parts", command.parts},
                   {"options", options},
                   {"examples", examples}});
  }
  return all;
}

std::vector<DeclaredCommand> declarations_from_json(const Json& json, const std::string& place) {
  std::vector<DeclaredCommand> commands;
  for (const Json& item : json) {
    JsonObject object(item, place);
    DeclaredCommand command;
    command.name = object.text("command");
    command.group = object.text("group");
    command.help = object.text("help");
    command.parts = object.texts("parts");
    for (const Json& declared : object.raw("options")) {
      JsonObject option(declared, place + ": " + command.name);
      command.options.push_back({option.texts("names"), option.text("place"), option.text("value"),
                                 option.texts("choices"), option.text("range"),
                                 option.text("default"), option.text("help"), option.text("group"),
                                 option.boolean("required"), option.boolean("many")});
    }
    for (const Json& shown : object.raw("examples")) {
      JsonObject example(shown, place + ": " + command.name);
      command.examples.push_back({example.text("words"), example.text("what")});
    }
    commands.push_back(command);
  }
  return commands;
}

}  // namespace mocaplm
