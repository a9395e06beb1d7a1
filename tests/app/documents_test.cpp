// README.md and docs/ speak of commands and options that the program has, and link to what is
// there.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "app/command_line.h"
#include "common/files.h"
#include "common/text.h"
#include "support/refusal.h"

namespace fs = std::filesystem;

namespace mocaplm::documents_test {
namespace {

const fs::path kRoot = MOCAPLM_SOURCE_DIR;
// Commands whose first word is a command of its own, with its own options.
const std::set<std::string> kWithParts = {"emulate", "gesture"};
const std::set<std::string> kWithTorch = {"train",  "classify",    "evaluate", "experiment",
                                          "infill", "interpolate", "demo"};

std::vector<fs::path> documents() {
  std::vector<fs::path> files = {kRoot / "README.md"};
  for (const auto& entry : fs::directory_iterator(kRoot / "docs"))
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::smatch> matches(const std::string& text, const std::regex& expression) {
  return {std::sregex_iterator(text.begin(), text.end(), expression), std::sregex_iterator()};
}

struct Mention {
  std::string where, command, part;
  std::vector<std::string> options;
};

// Every "mocaplm COMMAND ..." up to the end of its line or of its quotation, with its options.
std::vector<Mention> mentions() {
  static const std::regex call("mocaplm ([a-z]+)([^`#\\n]*)"), option("--[a-z][a-z0-9-]*");
  static const std::regex part("^ +([a-z]+)");
  std::vector<Mention> all;
  for (const fs::path& file : documents()) {
    const std::string text = std::regex_replace(read_file(file), std::regex("\\\\\\n"), " ");
    for (const std::smatch& match : matches(text, call)) {
      Mention mention{file.filename().string() + ": " + match.str(0), match.str(1), "", {}};
      const std::string rest = match.str(2);
      std::smatch first;
      if (kWithParts.count(mention.command) && std::regex_search(rest, first, part))
        mention.part = first.str(1);
      for (const std::smatch& one : matches(rest, option)) mention.options.push_back(one.str());
      all.push_back(mention);
    }
  }
  return all;
}

// The commands as `mocaplm --help` lists them; above them stands the walk.
std::set<std::string> commands() {
  static const std::regex line("\\n  ([a-z]+) +[a-z]");
  const std::string help = run_mocaplm("--help").text;
  std::set<std::string> names;
  for (const std::smatch& match : matches(help, line))
    if (match.str(1) != "mocaplm") names.insert(match.str(1));
  return names;
}

bool has_option(const std::string& help, const std::string& option) {
  return std::regex_search(help, std::regex(option + "(?![a-z0-9-])"));
}

void check_options(bool with_torch) {
  const std::set<std::string> known = commands();
  std::map<std::string, std::string> help;
  int checked = 0;
  for (const Mention& mention : mentions()) {
    if (known.count(mention.command) == 0 || kWithTorch.count(mention.command) != with_torch)
      continue;
    const std::string command = mention.command + " " + mention.part;
    if (help.count(command) == 0) {
      const Ran ran = run_mocaplm(command + " --help");
      ASSERT_EQ(ran.code, 0) << ran.text;
      help[command] = ran.text;
    }
    for (const std::string& option : mention.options) {
      EXPECT_TRUE(has_option(help[command], option))
          << mention.where << "\n'mocaplm " << command << "' has no " << option;
      ++checked;
    }
  }
  EXPECT_GT(checked, 3) << "the documents hardly show a command";
}

}  // namespace

TEST(Documents, ReadmeListsEveryCommand) {
  static const std::regex row("\\n\\| `([a-z]+)` \\|");
  const std::string readme = read_file(kRoot / "README.md");
  std::set<std::string> listed;
  for (const std::smatch& match : matches(readme, row)) listed.insert(match.str(1));
  EXPECT_EQ(listed, commands());
}

TEST(Documents, ShowOptionsThatExist) {
  check_options(false);
}

TEST(Documents, ShowOptionsOfTheCommandsWithTorchThatExist) {
  if (!fs::exists(MOCAPLM_BINARY_DIR "/mocaplm-torch"))
    GTEST_SKIP() << "mocaplm-torch is not built here";
  check_options(true);
}

TEST(Documents, LinkToFilesThatAreThere) {
  static const std::regex link("\\]\\(([^)#:]+)(#[^)]*)?\\)");
  for (const fs::path& file : documents()) {
    const std::string text = read_file(file);
    for (const std::smatch& match : matches(text, link))
      EXPECT_TRUE(fs::exists(file.parent_path() / match.str(1)))
          << file << " links to " << match.str(1);
  }
}

// A reader finds every page from the first one.
TEST(Documents, AreListedInTheReadmeOrTheIndex) {
  const std::string readme = read_file(kRoot / "README.md"),
                    index = read_file(kRoot / "docs/index.md");
  EXPECT_TRUE(contains(readme, "(docs/index.md)"));
  for (const fs::path& file : documents()) {
    const std::string name = file.filename().string();
    if (file.parent_path() == kRoot || name == "index.md") continue;
    EXPECT_TRUE(contains(readme, "(docs/" + name + ")") || contains(index, "(" + name + ")"))
        << "neither README.md nor docs/index.md links to docs/" << name;
  }
}

TEST(Documents, NameConfigsThatAreThere) {
  static const std::regex config("configs/([a-z_]+\\.json)");
  for (const fs::path& file : documents()) {
    const std::string text = read_file(file);
    for (const std::smatch& match : matches(text, config))
      EXPECT_TRUE(fs::exists(kRoot / match.str(0))) << file << " names " << match.str(0);
  }
  const std::string settings = read_file(kRoot / "docs/settings.md");
  for (const auto& entry : fs::directory_iterator(kRoot / "configs"))
    EXPECT_NE(settings.find("`" + entry.path().filename().string() + "`"), std::string::npos)
        << "docs/settings.md does not name " << entry.path();
}

}  // namespace mocaplm::documents_test
