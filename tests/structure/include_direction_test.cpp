// The directories of docs/architecture.md include each other only along its arrows, LibTorch stays
// where training is, and files stay short.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>

#include "common/files.h"
#include "common/text.h"

namespace fs = std::filesystem;

namespace mocaplm::include_direction_test {

namespace {

constexpr std::size_t kMaxLines = 500;

struct Directory {
  std::string name;
  std::vector<std::string> may_include;  // beside itself; "*": everything
  bool may_use_torch = false;
};

// The picture in docs/architecture.md. A directory stands below all those that it may include.
const std::vector<Directory> kDirectories = {
    {"common", {}},
    {"numeric", {"common"}},
    {"gesture", {"common", "numeric"}},
    {"motion", {"common", "numeric"}},
    {"spectral", {"common", "numeric", "motion"}},
    {"spectral/interpolate", {"common", "numeric", "motion", "spectral"}, true},
    {"emulator", {"common", "numeric", "motion"}},
    {"tokenizer", {"common", "numeric", "motion"}},
    {"model", {"common"}},
    {"model/transformer/cpu", {}},
    {"model/transformer", {"common", "model", "model/transformer/cpu"}, true},
    {"train", {"common", "motion", "tokenizer", "model", "model/transformer"}, true},
    {"generate", {"common", "motion", "tokenizer", "model"}},
    {"classify",
     {"common", "numeric", "motion", "tokenizer", "model", "model/transformer", "train"},
     true},
    {"evaluate/generated", {"common", "motion", "tokenizer", "model", "generate"}},
    {"evaluate",
     {"common", "numeric", "motion", "tokenizer", "model", "model/transformer", "generate",
      "evaluate/generated"},
     true},
    {"infill", {"common", "motion", "tokenizer", "model", "model/transformer"}, true},
    {"experiments",
     {"common", "motion", "tokenizer", "model", "train", "classify", "evaluate"},
     true},
    {"viewer", {"common", "motion"}},
    {"render", {"common", "motion"}},
    {"emulator/evaluation", {"common", "numeric", "motion", "emulator", "viewer"}},
    {"app", {"*"}},
    {"tests", {"*"}, true},
    {"bench", {"*"}, true},
};

const Directory* find_directory(const std::string& name) {
  for (const Directory& directory : kDirectories)
    if (directory.name == name) return &directory;
  return nullptr;
}

// The entry of a path relative to the root: the longest that it begins with.
const Directory* directory_of(const std::string& path) {
  for (std::size_t end = path.rfind('/'); end != std::string::npos && end > 0;
       end = path.rfind('/', end - 1))
    if (const Directory* found = find_directory(path.substr(0, end))) return found;
  return nullptr;
}

bool allowed(const Directory& from, const Directory& to) {
  const auto& may = from.may_include;
  return &from == &to || (may.size() == 1 && may[0] == "*") ||
         std::find(may.begin(), may.end(), to.name) != may.end();
}

bool is_torch(const std::string& include) {
  static const std::regex torch("^(torch|ATen|c10|caffe2)/.*");
  return std::regex_match(include, torch);
}

// What is wrong with the file's #include lines: "train/x.h:3: ...".
std::vector<std::string> wrong_includes(const std::string& file, const std::string& text) {
  const Directory* from = directory_of(file);
  if (from == nullptr) return {file + ": its directory is not in docs/architecture.md's picture"};
  static const std::regex include("^\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  std::vector<std::string> wrong;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::smatch match;
    if (line.find('#') == std::string::npos || !std::regex_match(line, match, include)) continue;
    const std::string to_file = match[2];
    const std::string place = file + ":" + std::to_string(number) + ": ";
    if (is_torch(to_file) && !from->may_use_torch)
      wrong.push_back(place + "<" + to_file + ">: " + from->name + "/ must not use LibTorch");
    if (match[1] == "<" || from->name == "tests" || is_torch(to_file)) continue;
    const Directory* to = directory_of(to_file);
    if (to == nullptr)
      wrong.push_back(place + "\"" + to_file + "\" is not a path from the repository's root");
    else if (!allowed(*from, *to))
      wrong.push_back(place + "\"" + to_file + "\": " + from->name + "/ must not include " +
                      to->name + "/");
  }
  return wrong;
}

bool is_source(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".h" || extension == ".cpp" || extension == ".in";
}

// Every source of the program, relative to the root: in the table's directories and in any other
// one that is built. What else somebody keeps beside them (an unpacked LibTorch, a build) is not
// looked at.
std::vector<std::string> sources() {
  const fs::path root = MOCAPLM_SOURCE_DIR;
  std::vector<std::string> files;
  for (const auto& top : fs::directory_iterator(root)) {
    const std::string name = top.path().filename().string();
    const bool built = find_directory(name) != nullptr || fs::exists(top.path() / "CMakeLists.txt");
    if (!top.is_directory() || !built) continue;
    for (const auto& entry : fs::recursive_directory_iterator(top.path()))
      if (entry.is_regular_file() && is_source(entry.path()))
        files.push_back(fs::relative(entry.path(), root).generic_string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string source_text(const std::string& file) {
  return read_file(fs::path(MOCAPLM_SOURCE_DIR) / file);
}

std::string one_a_line(const std::vector<std::string>& complaints) {
  return "\n" + join(complaints, "\n");
}

}  // namespace

TEST(IncludeDirection, EveryIncludePointsAlongAnArrow) {
  const std::vector<std::string> files = sources();
  ASSERT_GT(files.size(), 50u) << "the sources were not found below " MOCAPLM_SOURCE_DIR;
  std::vector<std::string> wrong;
  for (const std::string& file : files)
    for (const std::string& complaint : wrong_includes(file, source_text(file)))
      wrong.push_back(complaint);
  EXPECT_TRUE(wrong.empty()) << one_a_line(wrong);
}

TEST(IncludeDirection, NoSourceIsLong) {
  std::vector<std::string> wrong;
  for (const std::string& file : sources()) {
    const std::string text = source_text(file);
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    if (lines > kMaxLines)
      wrong.push_back(file + ": " + std::to_string(lines) + " lines, at most " +
                      std::to_string(kMaxLines) + " are allowed");
  }
  EXPECT_TRUE(wrong.empty()) << one_a_line(wrong);
}

// Two headers that define a type of the same name make one program with two meanings of it, and no
// compiler says so.
TEST(IncludeDirection, NoTypeIsDefinedByTwoHeaders) {
  static const std::regex definition("^(struct|class|enum class|enum) (\\w+)[^;]*\\{.*");
  std::map<std::string, std::string> defined;
  std::vector<std::string> wrong;
  for (const std::string& file : sources()) {
    if (fs::path(file).extension() != ".h" || file.rfind("tests/", 0) == 0) continue;
    std::istringstream lines(source_text(file));
    std::smatch match;
    for (std::string line; std::getline(lines, line);) {
      if (line.find('{') == std::string::npos || !std::regex_match(line, match, definition))
        continue;
      const auto [first, fresh] = defined.emplace(match[2], file);
      if (!fresh) wrong.push_back(file + ": " + match.str(2) + " is also in " + first->second);
    }
  }
  EXPECT_TRUE(wrong.empty()) << one_a_line(wrong);
}

// The table itself: no circles, since a directory may only include those that stand above it.
TEST(IncludeDirection, TableHasNoCircles) {
  std::vector<std::string> above = {"*"};
  for (const Directory& directory : kDirectories) {
    for (const std::string& to : directory.may_include)
      EXPECT_NE(std::find(above.begin(), above.end(), to), above.end())
          << directory.name << " -> " << to;
    above.push_back(directory.name);
  }
}

TEST(IncludeDirection, TableAgreesWithTheDocument) {
  const std::string text = source_text("docs/architecture.md");
  for (const Directory& directory : kDirectories) {
    const bool any = directory.may_include == std::vector<std::string>{"*"};
    std::string row = any ? "everything" : join(directory.may_include, ", ");
    if (row.empty()) row = "-";
    const std::string end = "| " + row + " | " + (directory.may_use_torch ? "yes" : "no") + " |";
    const std::size_t begin = text.find("\n| `" + directory.name + "/` |");
    ASSERT_NE(begin, std::string::npos) << "docs/architecture.md has no row for " << directory.name;
    const std::string found = text.substr(begin + 1, text.find('\n', begin + 1) - begin - 1);
    EXPECT_NE(found.find(end), std::string::npos) << "docs/architecture.md says:\n  " << found
                                                  << "\nbut this test's table ends in:\n  " << end;
  }
}

TEST(IncludeDirection, FindsWhatIsWrong) {
  const auto first = [](const std::string& file, const std::string& text) {
    const std::vector<std::string> wrong = wrong_includes(file, text);
    return wrong.empty() ? "" : wrong[0];
  };
  EXPECT_EQ(first("generate/x.cpp", "\n#include \"train/trainer.h\"\n"),
            "generate/x.cpp:2: \"train/trainer.h\": generate/ must not include train/");
  EXPECT_EQ(first("model/x.cpp", "#include \"model/transformer/torch.h\""),
            "model/x.cpp:1: \"model/transformer/torch.h\": model/ must not include "
            "model/transformer/");
  EXPECT_EQ(first("tokenizer/x.h", "#include <torch/types.h>"),
            "tokenizer/x.h:1: <torch/types.h>: tokenizer/ must not use LibTorch");
  EXPECT_NE(first("app/x.cpp", "  # include \"ATen/ATen.h\""), "");
  EXPECT_NE(first("common/x.cpp", "#include \"error.h\""), "");
  EXPECT_NE(first("common/x.cpp", "#include \"motion/clip.h\""), "");
  EXPECT_NE(first("somewhere/x.cpp", ""), "");
  EXPECT_EQ(first("train/x.cpp", "#include <torch/types.h>\n#include \"motion/clip.h\"\n"), "");
  EXPECT_EQ(first("model/transformer/x.cpp", "#include \"model/config.h\""), "");
  EXPECT_EQ(first("motion/formats/x.cpp", "#include \"motion/clip.h\"\n// #include \"a.h\""), "");
  EXPECT_EQ(first("app/x.cpp", "#include \"train/trainer.h\"\n#include <CLI/CLI.hpp>\n"), "");
}

}  // namespace mocaplm::include_direction_test
