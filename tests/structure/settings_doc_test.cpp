// docs/settings.md lists every setting as the program declares it: key, values, default, help.
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "app/convert_config.h"
#include "classify/config.h"
#include "common/files.h"
#include "common/settings.h"
#include "emulator/evaluation/evaluation.h"
#include "generate/sampler.h"
#include "gesture/config.h"
#include "gesture/juggling/config.h"
#include "gesture/report.h"
#include "infill/config.h"
#include "model/config.h"
#include "motion/import/config.h"
#include "motion/synth.h"
#include "render/config.h"
#include "spectral/config.h"
#include "spectral/filter.h"
#include "spectral/interpolate/config.h"
#include "spectral/query.h"
#include "tokenizer/pieces.h"
#include "tokenizer/tiles.h"
#include "tokenizer/tokenizer.h"
#include "train/config.h"

namespace mocaplm::settings_doc_test {

namespace {

// The table rows that describe a struct's settings.
class SettingRows {
 public:
  void integer(const char* key, std::int64_t& value, std::int64_t min, std::int64_t max,
               const char* help) {
    row(key, std::to_string(min) + " to " + std::to_string(max), std::to_string(value), help);
  }
  void number(const char* key, double& value, double min, double max, const char* help) {
    row(key, format_number(min) + " to " + format_number(max), format_number(value), help);
  }
  void boolean(const char* key, bool& value, const char* help) {
    row(key, "true, false", value ? "true" : "false", help);
  }
  void choice(const char* key, std::string& value, const std::vector<std::string>& allowed,
              const char* help) {
    row(key, join(allowed, ", "), value, help);
  }
  void text(const char* key, std::string& value, const char* help) {
    row(key, "text", value, help);
  }
  void texts(const char* key, std::vector<std::string>& value, const char* help) {
    row(key, "list of texts", join(value, ", "), help);
  }
  const std::vector<std::string>& rows() const { return rows_; }

 private:
  void row(const std::string& key, const std::string& values, const std::string& initial,
           const char* help) {
    const std::string shown = initial.empty() ? "" : initial + " ";
    std::string escaped;  // Markdown takes <style> for a tag
    for (const char* c = help; *c != 0; ++c) escaped += *c == '<' ? "\\<" : std::string(1, *c);
    rows_.push_back("| `" + key + "` | " + values + " | " + shown + "| " + escaped + " |");
  }
  std::vector<std::string> rows_;
};

template <class Config>
std::vector<std::string> rows_of(Config config) {
  SettingRows visitor;
  config.describe(visitor);
  return visitor.rows();
}

// The rows below the heading "## TITLE", up to the next heading, that name a setting.
std::vector<std::string> documented(const std::string& title) {
  std::istringstream lines(read_file(MOCAPLM_SOURCE_DIR "/docs/settings.md"));
  std::vector<std::string> rows;
  std::string line;
  bool inside = false;
  while (std::getline(lines, line)) {
    if (line.rfind("## ", 0) == 0) inside = line == "## " + title;
    if (inside && line.rfind("| `", 0) == 0) rows.push_back(line);
  }
  return rows;
}

void expect_documented(const std::string& title, const std::vector<std::string>& rows) {
  const std::vector<std::string> found = documented(title);
  const std::set<std::string> there(found.begin(), found.end());
  const std::set<std::string> wanted(rows.begin(), rows.end());
  for (const std::string& row : rows)
    EXPECT_EQ(there.count(row), 1u)
        << "docs/settings.md, section \"" << title << "\", lacks the row\n"
        << row;
  for (const std::string& row : found)
    EXPECT_EQ(wanted.count(row), 1u)
        << "docs/settings.md, section \"" << title << "\", has a row that no setting declares\n"
        << row;
}

}  // namespace

TEST(SettingsDocument, Tokenizer) {
  expect_documented("tokenizer", rows_of(TokenizerConfig()));
}

TEST(SettingsDocument, Tiles) {
  expect_documented("tiles", rows_of(TileConfig()));
}

TEST(SettingsDocument, Pieces) {
  expect_documented("pieces", rows_of(PieceConfig()));
}

TEST(SettingsDocument, Model) {
  expect_documented("model", rows_of(ModelConfig()));
}

TEST(SettingsDocument, Train) {
  expect_documented("train", rows_of(TrainConfig()));
}

TEST(SettingsDocument, RangeTest) {
  expect_documented("range test", rows_of(RangeTestConfig()));
  expect_documented("samples", rows_of(SampleConfig()));
}

TEST(SettingsDocument, Filling) {
  expect_documented("filling", rows_of(FillOptions()));
}

TEST(SettingsDocument, Sampling) {
  expect_documented("sampling", rows_of(SamplingConfig()));
}

TEST(SettingsDocument, Classify) {
  expect_documented("classify", rows_of(ClassifyConfig()));
}

TEST(SettingsDocument, Spectral) {
  expect_documented("spectral", rows_of(SpectralConfig()));
}

TEST(SettingsDocument, Query) {
  expect_documented("query", rows_of(QueryConfig()));
}

TEST(SettingsDocument, Filter) {
  expect_documented("filter", rows_of(FilterConfig()));
}

TEST(SettingsDocument, Interpolate) {
  expect_documented("interpolate", rows_of(InterpolateConfig()));
  expect_documented("interpolation pairs", rows_of(InterpolatePairs()));
}

TEST(SettingsDocument, Import) {
  expect_documented("import", rows_of(ImportConfig()));
}

TEST(SettingsDocument, Emulate) {
  expect_documented("emulate: motions", rows_of(LandmarkOptions()));
  expect_documented("emulate: alignment", rows_of(AlignOptions()));
  expect_documented("emulate: schemes", rows_of(SchemeOptions()));
  expect_documented("emulate test", rows_of(EvaluationOptions()));
}

TEST(SettingsDocument, Convert) {
  expect_documented("convert", rows_of(ConvertConfig()));
}

TEST(SettingsDocument, Render) {
  expect_documented("render", rows_of(RenderConfig()));
}

TEST(SettingsDocument, Gesture) {
  expect_documented("gesture", rows_of(GestureConfig()));
}

TEST(SettingsDocument, GestureTest) {
  expect_documented("gesture test", rows_of(ReportConfig()));
}

TEST(SettingsDocument, Juggle) {
  expect_documented("juggle", rows_of(JuggleConfig()));
}

TEST(SettingsDocument, Synth) {
  expect_documented("synth", rows_of(SynthConfig()));
}

}  // namespace mocaplm::settings_doc_test
