// mocaplm tokenize from the command line: tiles, pieces and the report. What they do is tested in
// tests/tokenizer.
#include <gtest/gtest.h>

#include <filesystem>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace mocaplm::tokenize_command_test {
namespace {

namespace fs = std::filesystem;

class TokenizeCommand : public testing::Test {
 protected:
  void SetUp() override {
    write_dataset(folder_ / "data", {{"a", "train", 90}, {"b", "train", 60}, {"c", "test", 50}});
  }
  Ran run(const std::string& arguments) { return run_mocaplm("tokenize " + arguments); }
  std::string at(const std::string& name) { return (folder_ / name).string(); }

  TemporaryFolder folder_;
};

TEST_F(TokenizeCommand, WritesTilesAndBringsThemBack) {
  const Ran ran = run(at("data") + " --tiles 30 --keep 0.2 --pca 42 --lapped --binning quantile" +
                      " --bpe 800 --text --out " + at("out"));
  EXPECT_EQ(ran.code, 0) << ran.text;
  EXPECT_PRED2(contains, ran.text, "in 1,024 tokens");
  EXPECT_PRED2(contains, ran.text, "tokens as pieces");
  const Ran back = run("--decode " + at("out/corpus.txt") + " --tokenizer " +
                       at("out/tokenizer.json") + " --out " + at("back"));
  EXPECT_EQ(back.code, 0) << back.text;
  EXPECT_TRUE(fs::exists(folder_ / "back" / "c.npz"));
  const Ran info = run_mocaplm("info " + at("out/tokenizer.json"));
  EXPECT_EQ(info.code, 0) << info.text;
  EXPECT_PRED2(contains, info.text, "tile tokenizer");
}

TEST_F(TokenizeCommand, ReportsATableJsonAndAPlot) {
  const Ran ran = run(at("data") + " --joints all --root none --report bins:90 " +
                      "bins:360,binning:quantile tiles:30,pca:24 tiles:30,ica:5,lapped " +
                      "tiles:30,bpe:900 --json " + at("t.json") + " --plot " + at("p.svg"));
  EXPECT_EQ(ran.code, 0) << ran.text;
  EXPECT_PRED2(contains, ran.text, "measured on 1 clips");
  const Json table = load_json(folder_ / "t.json");
  ASSERT_EQ(table["rows"].size(), 5u);
  EXPECT_EQ(table["rows"][0]["word"], 72);
  EXPECT_LT(table["rows"][4]["word"], table["rows"][4]["longest"]);
  const std::string plot = read_file(folder_ / "p.svg");
  EXPECT_PRED2(contains, plot, "<svg");
  EXPECT_PRED2(contains, plot, "tiles:30,ica:5,lapped");
  const Ran bins = run(at("data") + " --report bins:90 bins:360 bins:720 --plot " + at("b.svg"));
  EXPECT_EQ(bins.code, 0) << bins.text;
  EXPECT_PRED2(contains, read_file(folder_ / "b.svg"), "uniform, max");
  const Ran paged = run(at("data") + " --report bins:90 bins:360 --page " + at("r.html"));
  EXPECT_EQ(paged.code, 0) << paged.text;
  EXPECT_PRED2(contains, read_file(folder_ / "r.html"), "<h1>What bins lose</h1>");
}

TEST_F(TokenizeCommand, ShowsClipsBesideTheirTokens) {
  for (const std::string& words : {"--bins 90 --out " + at("bins.json"),
                                   "--tiles 30 --pca 9 --root none --out " + at("tiles")}) {
    const Ran ran = run(at("data") + " " + words + " --page " + at("page.html"));
    EXPECT_EQ(ran.code, 0) << ran.text;
    const std::string page = read_file(folder_ / "page.html");
    EXPECT_PRED2(contains, page, ", from tokens</h2>");
    EXPECT_PRED2(contains, page, "<dt>fingerprint</dt>");
  }
}

TEST_F(TokenizeCommand, RefusesWhatDoesNotGoTogether) {
  const auto says = [&](const std::string& arguments, const std::string& part) {
    const Ran ran = run(arguments);
    EXPECT_EQ(ran.code, 2) << arguments << "\n" << ran.text;
    EXPECT_PRED2(contains, ran.text, part);
  };
  const std::string data = at("data");
  says(data, "--out is required");
  says(data + " --report bins:90 --out " + at("x"), "--report takes none of");
  says(data + " --report bin:90", "did you mean \"bins\"");
  says(data + " --plot x.svg --out " + at("x"), "--plot");
  says(data + " --page x.npz --out " + at("x"), ".html");
  says(data + " --page x.html --decode c.txt", "--decode");
  says(data + " --tiles 30 --root steps --out " + at("x"), "absolute or none");
  says(data + " --tiles 30 --pca 9 --ica 9 --out " + at("x"), "not both");
  says(data + " --bpe 900 --out " + at("x.json"), "need a folder");
}

}  // namespace
}  // namespace mocaplm::tokenize_command_test
