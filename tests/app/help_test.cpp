// What the program says of itself: help, version, man page, and what it says to a slip of the hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "common/text.h"
#include "support/refusal.h"

namespace fs = std::filesystem;

namespace mocaplm::help_test {
namespace {

bool has_torch() {
  return fs::exists(MOCAPLM_BINARY_DIR "/mocaplm-torch");
}

// All commands with their options and examples, the parts with LibTorch where they are built.
const Json& declared() {
  static const Json all = parse_json(run_mocaplm("declarations").text, "declarations");
  return all;
}

std::size_t widest(const std::string& text) {
  std::size_t most = 0;
  for (const std::string& line : split(text, '\n')) most = std::max(most, line.size());
  return most;
}

// Lines that a backslash breaks, as a shell reads them.
std::string unbroken(std::string text) {
  const std::string broken = " \\\n      ";
  for (std::size_t at; (at = text.find(broken)) != std::string::npos;)
    text.replace(at, broken.size(), " ");
  return text;
}

TEST(Help, FitsAScreenAndNamesEveryCommand) {
  const Ran ran = run_mocaplm("--help");
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_LE(std::count(ran.text.begin(), ran.text.end(), '\n'), 40) << ran.text;
  EXPECT_LE(widest(ran.text), 80u) << ran.text;
  ASSERT_GE(declared().size(), 17u);
  std::size_t last = 0;
  for (const Json& command : declared()) {
    const std::string name = command["command"];
    if (contains(name, " ")) continue;
    // In one order everywhere.
    const std::size_t at = ran.text.find("\n  " + name + "  ");
    ASSERT_NE(at, std::string::npos) << name << " is not in\n" << ran.text;
    EXPECT_GT(at, last) << name;
    last = at;
  }
  for (const char* part : {"mocaplm import", "mocaplm train", "mocaplm generate", "docs/"})
    EXPECT_TRUE(contains(ran.text, part)) << part;
}

// A command's own page says what the general one says of it; it fits 80 columns, too.
TEST(Help, OfEveryCommandHasTwoExamples) {
  if (!has_torch()) GTEST_SKIP() << "mocaplm-torch is not built here";
  const std::string general = run_mocaplm("--help").text;
  for (const Json& command : declared()) {
    const std::string name = command["command"], help = command["help"];
    const Ran ran = run_mocaplm(name + " --help");
    ASSERT_EQ(ran.code, 0) << ran.text;
    EXPECT_LE(widest(ran.text), 80u) << ran.text;
    EXPECT_TRUE(contains(ran.text, "Usage: mocaplm " + name)) << ran.text;
    if (!contains(name, " ")) {
      EXPECT_TRUE(contains(general, "  " + name + std::string(13 - name.size(), ' ') + help))
          << name << ": " << help << "\n"
          << general;
    }
    ASSERT_EQ(command["examples"].size(), 2u) << name << " needs two examples, see app/guide.cpp";
    for (const Json& example : command["examples"]) {
      const std::string words = example["words"];
      EXPECT_EQ(words.rfind(name, 0), 0u) << words << " is no example of " << name;
      EXPECT_TRUE(contains(unbroken(ran.text), "  mocaplm " + words + "\n")) << words;
      EXPECT_FALSE(example["what"].get<std::string>().empty()) << words;
    }
  }
}

TEST(Help, TellsRangesDefaultsAndWhatIsRequired) {
  const std::string synth = run_mocaplm("synth --help").text;
  EXPECT_TRUE(contains(synth, "Usage: mocaplm synth --out FOLDER [OPTIONS]")) << synth;
  EXPECT_TRUE(contains(synth, "(1 to 3; default 3)")) << synth;
  EXPECT_TRUE(contains(run_mocaplm("filter --help").text, "(low, band; default low)"));
  EXPECT_TRUE(contains(run_mocaplm("emulate --help").text, "\n  sample "));
  EXPECT_TRUE(contains(run_mocaplm("tokenize --help").text, "--lapped, --no-lapped"));
}

// What an option takes is called by what it is, so far as the option's help says it.
TEST(Help, NamesWhatAnOptionTakes) {
  const auto value = [](const std::string& command, const std::string& name) -> std::string {
    for (const Json& one : declared())
      if (one["command"] == command)
        for (const Json& option : one["options"])
          for (const Json& own : option["names"])
            if (own == name) return option["value"];
    return "none such";
  };
  EXPECT_EQ(value("synth", "--seed"), "N");
  EXPECT_EQ(value("synth", "--seconds"), "X");
  EXPECT_EQ(value("synth", "--overwrite"), "");
  EXPECT_EQ(value("synth", "--out"), "FOLDER");
  EXPECT_EQ(value("synth", "--json"), "FILE");
  EXPECT_EQ(value("import", "--label-regex"), "REGEX");
  EXPECT_EQ(value("import", "--map"), "FILE");
  EXPECT_EQ(value("view", "--clip"), "NAME");
  EXPECT_EQ(value("view", "--title"), "TEXT");
  EXPECT_EQ(value("convert", "--to"), "NAME");
  EXPECT_EQ(value("tokenize", "--out"), "PATH");
  EXPECT_EQ(value("tokenize", "--report"), "SETTINGS");
  EXPECT_EQ(value("generate", "--model"), "FOLDER");
  EXPECT_EQ(value("generate", "--stream"), "FILE");
  EXPECT_EQ(value("generate", "--out"), "OUT");
  EXPECT_EQ(value("filter", "--out"), "OUT");
  EXPECT_EQ(value("gesture play", "--model"), "FILE");
  if (!has_torch()) GTEST_SKIP() << "mocaplm-torch is not built here";
  EXPECT_EQ(value("train", "--from"), "FOLDER");
  EXPECT_EQ(value("train", "--config"), "FILE");
  EXPECT_EQ(value("train", "--balance"), "TEXT");
  EXPECT_EQ(value("experiment", "--out"), "FOLDER");
}

// Only what the parser of a command says, for the examples have no files here.
TEST(Help, ExamplesAreParsed) {
  if (!has_torch()) GTEST_SKIP() << "mocaplm-torch is not built here";
  TemporaryFolder folder;
  for (const Json& command : declared())
    for (const Json& example : command["examples"]) {
      std::string words = example["words"];
      words = words.substr(0, words.find(" >"));
      // --help stops after the words before it were understood; --version is no option of commands.
      const Ran ran = run_mocaplm(words + " --no-such-option");
      EXPECT_EQ(ran.code, 2) << words << "\n" << ran.text;
      EXPECT_TRUE(contains(ran.text, "has no option \"--no-such-option\"")) << words << "\n"
                                                                            << ran.text;
    }
}

TEST(Version, NamesInstructionsThreadsAndLibTorch) {
  const Ran ran = run_mocaplm("--version");
  ASSERT_EQ(ran.code, 0) << ran.text;
  for (const char* part : {"mocaplm ", "instructions: ", "threads: ", "LibTorch: "})
    EXPECT_TRUE(contains(ran.text, part)) << part << "\n" << ran.text;
  if (has_torch()) {
    EXPECT_TRUE(contains(ran.text, "CUDA")) << ran.text;
  }
}

// The light program alone, as a package without LibTorch would hold it.
TEST(Version, SaysWhereThePartWithLibTorchIsMissing) {
  TemporaryFolder folder;
  const fs::path alone = folder / "mocaplm";
  fs::copy_file(MOCAPLM_BINARY_DIR "/mocaplm", alone);
  EXPECT_TRUE(contains(run_program(alone.string(), "--version").text, "not installed"));
  const Ran train = run_program(alone.string(), "train --out x");
  EXPECT_EQ(train.code, 1);
  EXPECT_TRUE(contains(train.text, "mocaplm doctor")) << train.text;
  const Ran doctor = run_program(alone.string(), "doctor");
  EXPECT_EQ(doctor.code, 0) << doctor.text;
  EXPECT_TRUE(contains(doctor.text, "scripts/build")) << doctor.text;
  const Ran completion = run_program(alone.string(), "completion bash");
  EXPECT_EQ(completion.code, 0);
  EXPECT_TRUE(contains(completion.text, "note: options of train")) << completion.text;
}

TEST(Slips, NearestCommandOptionAndValueAreNamed) {
  const auto says = [](const std::string& words, const std::string& part) {
    const Ran ran = run_mocaplm(words);
    EXPECT_EQ(ran.code, 2) << words << "\n" << ran.text;
    EXPECT_TRUE(contains(ran.text, part)) << words << "\n" << ran.text;
  };
  says("genrate", "did you mean \"generate\"?");
  says("gen", "did you mean \"generate\"?");
  says("xyz", "Try 'mocaplm --help'");
  says("/dev/null", "mocaplm info says which");
  says("emulate smaple", "did you mean \"sample\"?");
  says("emulate", "give a command: fit, sample, test");
  says("synth --out x --dancer 2", "did you mean \"--dancers\"?");
  says("synth --out x --dancer=2", "mocaplm synth has no option \"--dancer\"");
  says("synth --ouut x", "did you mean \"--out\"?");
  says("synth", "Try 'mocaplm synth --help'");
  says("filter x.npz --keep bnad", "--keep: \"bnad\" is not known, did you mean \"band\"?");
  says("filter x.npz --keep other", "One of: low, band");
  says("generate --model x --precision bf61", "did you mean \"bf16\"?");
  says("--hepl", "did you mean \"--help\"?");
  says("query --index x -fps 30", "has no option \"-fps\", did you mean \"--fps\"?");
  says("", "mocaplm import mocap/ --out data");  // the whole help
  if (!has_torch()) GTEST_SKIP() << "mocaplm-torch is not built here";
  says("train --out x --n-layers 2", "did you mean \"--n-layer\"?");
  says("train --out x --position custm", "did you mean \"custom\"?");
}

TEST(Slips, ValuesAreAskedForInWords) {
  const auto says = [](const std::string& words, const std::string& part) {
    const Ran ran = run_mocaplm(words);
    EXPECT_EQ(ran.code, 2) << words << "\n" << ran.text;
    EXPECT_TRUE(contains(ran.text, "mocaplm: " + part + "\n")) << words << "\n" << ran.text;
  };
  says("synth --out", "--out needs a value: FOLDER");
  says("filter x.npz --keep=", "--keep needs a value: one of low, band");
  says("filter x.npz --to-hz", "--to-hz needs a value: a number from 0 to 5000");
  says("synth --out x --dancers 9", "--dancers: \"9\" is not a whole number from 1 to 3");
  says("generate --model x --seconds -4", "--seconds: \"-4\" is not a number from 0.05 to 3600");
  says("evaluate --data x --horizons a", "--horizons: \"a\" is not a list of numbers");
  says("view x --out y.html --up w", "--up: \"w\" is not known. One of: auto, x, y, z, -x, -y, -z");
  says("synth --out x --out y", "--out can be given only once");
  says("synth --out x extra", "mocaplm synth has no use for \"extra\"");
}

TEST(Slips, KeysAndValuesOfSettingsFilesAreNamed) {
  if (!has_torch()) GTEST_SKIP() << "mocaplm-torch is not built here";
  TemporaryFolder folder;
  const auto says = [&](const std::string& settings, const std::string& part) {
    write_file(folder / "s.json", settings);
    const Ran ran =
        run_mocaplm("train --config '" + (folder / "s.json").string() + "' --data '" +
                    folder.path().string() + "' --out '" + (folder / "run").string() + "'");
    EXPECT_EQ(ran.code, 3) << ran.text;
    EXPECT_TRUE(contains(ran.text, part)) << ran.text;
  };
  says(R"({"model": {"n_layers": 2}})", "did you mean \"n_layer\"?");
  says(R"({"modle": {}})", "did you mean \"model\"?");
  says(R"({"model": {"position": "absolut"}})", "did you mean \"absolute\"?");
}

TEST(ManPage, NamesEveryCommandAndIsSoundRoff) {
  const Ran ran = run_mocaplm("man");
  ASSERT_EQ(ran.code, 0) << ran.text;
  for (const Json& command : declared())
    EXPECT_TRUE(contains(ran.text, ".SS mocaplm " + command["command"].get<std::string>() + "\n"))
        << command["command"];
  if (std::system("command -v man groff > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "man and groff are not here to read the page";
  TemporaryFolder folder;
  const std::string page = (folder / "mocaplm.1").string();
  write_file(page, ran.text);
  const Ran read = run_shell("LC_ALL=C MANWIDTH=80 man --warnings -P cat -l '" + page + "' > '" +
                             page + ".txt'");
  EXPECT_EQ(read.code, 0);
  EXPECT_EQ(read.text, "");
  EXPECT_TRUE(contains(read_file(page + ".txt"), "mocaplm generate --model FOLDER [OPTIONS]"));
}

}  // namespace
}  // namespace mocaplm::help_test
