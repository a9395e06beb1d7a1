// Every option of the tokenizers on procedural dances (motion/synth.h), against the errors that
// docs/tokenizers.md states for them.
#include <gtest/gtest.h>

#include <cstdio>

#include "motion/synth.h"
#include "tokenizer/report.h"

namespace mocaplm::synth_error_test {
namespace {

struct Stated {
  const char* setting;
  double geodesic, seconds;  // docs/tokenizers.md's figures
};

// Figures are rounded, and FastICA's last digits differ from machine to machine.
constexpr double kTolerance = 0.03;

class SynthErrors : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    SynthConfig config;  // the page's
    config.dancers = 1;
    config.choreographies = 2;
    config.seconds = 6;
    for (const Dance& dance : plan_dances(config))
      if (dance.split != "validation")
        (dance.split == "train" ? fitted_ : held_out_).push_back(make_dance(dance, config));
    ASSERT_EQ(fitted_.size(), 20u);
    ASSERT_EQ(held_out_.size(), 10u);
  }

  static void check(const ReportSetting& base, const std::vector<Stated>& all) {
    std::vector<std::string> names;
    for (const Stated& one : all) names.push_back(one.setting);
    const std::vector<ReportRow> rows = report(report_settings(names, base), fitted_, held_out_);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const WordMeasure& m = rows[i].measure;
      std::printf("%-40s geodesic %.4f (%.4f), seconds %.2f (%.2f)\n", all[i].setting,
                  m.geodesic.mean(), all[i].geodesic, m.seconds_in(1024), all[i].seconds);
      EXPECT_NEAR(m.geodesic.mean(), all[i].geodesic, kTolerance * all[i].geodesic + 5e-5)
          << all[i].setting;
      EXPECT_NEAR(m.seconds_in(1024), all[i].seconds, kTolerance * all[i].seconds + 5e-3)
          << all[i].setting;
    }
  }

  static std::vector<Clip> fitted_, held_out_;
};

std::vector<Clip> SynthErrors::fitted_, SynthErrors::held_out_;

TEST_F(SynthErrors, OfFrames) {
  ReportSetting base;
  base.frames.root = "none";
  check(base, {{"bins:90", 0.0421, 1.31},
               {"bins:360", 0.0105, 1.31},
               {"bins:360,binning:quantile", 0.0051, 1.31},
               {"bins:360,binning:pooled_quantile", 0.0096, 1.31},
               {"bins:90,bpe:2000", 0.0421, 3.38},
               {"bins:90,unigram:2000", 0.0421, 2.68},
               {"bins:360,root:steps", 0.0105, 1.22},
               {"bins:360,root:absolute", 0.0105, 1.22}});
}

TEST_F(SynthErrors, OfTiles) {
  ReportSetting base;
  base.frames.fps = 60;
  base.frames.joints = {"all"};
  base.frames.root = "none";
  base.tiles.tiles = 60;
  base.tiles.keep = 0.05;
  check(base, {{"lapped:false", 0.0200, 4.19},
               {"lapped", 0.0201, 4.46},
               {"lapped,pca:72", 0.0198, 6.00},
               {"lapped,pca:24", 0.0321, 10.42},
               {"lapped,ica:24", 0.0391, 10.02},
               {"lapped,threshold:0.1,bins:720", 0.0150, 4.41},
               {"lapped,binning:quantile", 0.0156, 3.09},
               {"lapped,binning:pooled_quantile", 0.0406, 3.09},
               {"lapped,scan:component", 0.0201, 5.03},
               {"lapped,runs:16", 0.0201, 4.11},
               {"lapped,tiles:30,keep:0.1", 0.0163, 3.69},
               {"lapped,bpe:4000", 0.0201, 9.44},
               {"lapped,unigram:4000", 0.0201, 9.98},
               {"lapped,root:absolute,bins:2000", 0.0084, 3.00}});
}

}  // namespace
}  // namespace mocaplm::synth_error_test
