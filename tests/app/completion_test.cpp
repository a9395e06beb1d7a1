// The scripts of mocaplm completion, in the shells themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "common/text.h"

namespace fs = std::filesystem;

namespace mocaplm::completion_test {
namespace {

using Words = std::vector<std::string>;

bool has(const std::string& program) {
  return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0;
}

Words lines_of(const std::string& text) {
  Words lines;
  for (const std::string& line : split(text, '\n'))
    if (!line.empty()) lines.push_back(line);
  std::sort(lines.begin(), lines.end());
  return lines;
}

class Completion : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* shell : {"bash", "zsh"}) {
      const Ran ran = run_mocaplm(std::string("completion ") + shell);
      ASSERT_EQ(ran.code, 0) << ran.text;
      write_file(folder_ / shell, ran.text);
    }
    fs::create_directories(folder_ / "in/data");
    for (const char* name : {"in/a.npz", "in/b.BVH", "in/c d.bvh", "in/e.txt", "in/f.json"})
      write_file(folder_ / name, "");
  }

  // What bash offers after these words, the last one begun; in the folder in/.
  Words bash(const Words& words) const {
    std::string list;
    for (const std::string& word : words) list += " '" + word + "'";
    const Ran ran =
        run_shell("cd '" + (folder_ / "in").string() + "' && bash --norc -c '. " +
                  (folder_ / "bash").string() + "; COMP_WORDS=(mocaplm \"$@\"); " +
                  "COMP_CWORD=$#; _mocaplm; printf \"%s\\n\" \"${COMPREPLY[@]}\"' bash" + list);
    EXPECT_EQ(ran.code, 0) << ran.text;
    return lines_of(ran.text);
  }

  TemporaryFolder folder_;
};

TEST_F(Completion, BashCompletesCommandsAndOptions) {
  if (!has("bash")) GTEST_SKIP() << "bash is not here";
  EXPECT_EQ(bash({"ge"}), (Words{"generate", "gesture"}));
  EXPECT_EQ(bash({"--v"}), (Words{"--version"}));
  EXPECT_EQ(bash({"emulate", ""}), (Words{"fit", "sample", "test"}));
  EXPECT_EQ(bash({"emulate", "fit", "--scheme", "PWI", "--spl"}), (Words{"--split"}));
  EXPECT_EQ(bash({"synth", "--ge"}), (Words{"--genres"}));
  EXPECT_EQ(bash({"nothing", "--ge"}), (Words{}));
  EXPECT_EQ(bash({"synth", "--seed", ""}), (Words{}));
}

TEST_F(Completion, BashCompletesValuesThatAreEnumerated) {
  if (!has("bash")) GTEST_SKIP() << "bash is not here";
  EXPECT_EQ(bash({"filter", "--keep", ""}), (Words{"band", "low"}));
  EXPECT_EQ(bash({"filter", "--keep", "=", "b"}), (Words{"band"}));
  EXPECT_EQ(bash({"filter", "--keep", "="}), (Words{"band", "low"}));
  EXPECT_EQ(bash({"completion", ""}), (Words{"bash", "zsh"}));
  EXPECT_EQ(bash({"emulate", "fit", "--split", "t"}), (Words{"test", "train"}));
}

TEST_F(Completion, BashCompletesFilesByTheirEndings) {
  if (!has("bash")) GTEST_SKIP() << "bash is not here";
  EXPECT_EQ(bash({"view", ""}), (Words{"a.npz", "b.BVH", "c d.bvh", "data"}));
  EXPECT_EQ(bash({"view", "a.npz", "c"}), (Words{"c d.bvh"}));
  EXPECT_EQ(bash({"query", "--index", ""}), (Words{"data"}));  // a folder
  EXPECT_EQ(bash({"tokenize", "--tokenizer", ""}), (Words{"data", "f.json"}));
  EXPECT_EQ(bash({"view", "a.npz", "--title", ""}), (Words{}));
  EXPECT_EQ(bash({"view", "data", "--clip", ""}), (Words{}));  // a clip's name
  EXPECT_EQ(bash({"import", "--label-regex", ""}), (Words{}));
  EXPECT_EQ(bash({"import", "--map", ""}), (Words{"data", "f.json"}));
  EXPECT_EQ(bash({"gesture", "play", "--model", ""}), (Words{"data", "f.json"}));
  if (!fs::exists(MOCAPLM_BINARY_DIR "/mocaplm-torch")) return;
  EXPECT_EQ(bash({"train", "--from", ""}), (Words{"data"}));
}

TEST_F(Completion, BashOffersEveryOptionOfEveryCommand) {
  if (!has("bash")) GTEST_SKIP() << "bash is not here";
  const Json all = parse_json(run_mocaplm("declarations").text, "declarations");
  for (const Json& command : all) {
    Words names, words = split(command["command"].get<std::string>(), ' ');
    for (const Json& option : command["options"])
      for (const Json& name : option["names"]) names.push_back(name);
    std::sort(names.begin(), names.end());
    words.push_back("-");
    EXPECT_EQ(bash(words), names) << command["command"];
  }
}

// zsh completes only at a terminal: it gets one of its own. $1: the script, $2: folder, $3: words.
constexpr const char* kDrive = R"zsh(
zmodload zsh/zpty
zpty z zsh -f -i
zpty -w z 'PS1=; unsetopt zle_bracketed_paste; autoload -Uz compinit; compinit -u -D'
zpty -w z "source $1; cd $2; LISTMAX=1000; print READY$((1))"
zpty -r -m z all '*READY1*'
zpty -w -n z "$3"$'\t'
sleep 1
zpty -w -n z $'\C-a\C-kprint DONE$((1))\n'
zpty -r -m z all '*DONE1*'
print -r -- "$all"
)zsh";

TEST_F(Completion, ZshCompletes) {
  if (!has("zsh")) GTEST_SKIP() << "zsh is not here";
  EXPECT_EQ(run_shell("zsh -n '" + (folder_ / "zsh").string() + "'").text, "");
  write_file(folder_ / "drive.zsh", kDrive);
  const auto zsh = [&](const std::string& words) {
    std::string command = "timeout 60 zsh -f";
    for (const std::string& word : {(folder_ / "drive.zsh").string(), (folder_ / "zsh").string(),
                                    (folder_ / "in").string(), words})
      command += " '" + word + "'";
    return run_shell(command).text;
  };
  EXPECT_NE(zsh("mocaplm gener").find("generate"), std::string::npos);
  const std::string parts = zsh("mocaplm emulate ");
  for (const char* part : {"fit", "sample", "test"})
    EXPECT_NE(parts.find(part), std::string::npos) << parts;
  EXPECT_NE(zsh("mocaplm filter --keep b").find("band"), std::string::npos);
}

}  // namespace
}  // namespace mocaplm::completion_test
