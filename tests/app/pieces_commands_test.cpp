// Models of pieces from the command line.
#include "app/trained_run.h"

namespace mocaplm::pieces_commands_test {

namespace {

class PiecesCommands : public TrainedRun {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    must("synth --out " + at("data") +
         " --genres WA,HO --dancers 1 --choreographies 2 --seconds 1.5");
    Json small = config();
    small["pieces"] = {{"unigram", 150}};
    small["model"]["output"] = "absolute";
    write_file(*folder_ / "config.json", small.dump());
    said_ = must("train --threads 1 --config " + at("config.json") + " --data " + at("data") +
                 " --unigram 0 --bpe 120 --out " + at("run"));
  }
  static std::string said_;
};

std::string PiecesCommands::said_;

TEST_F(PiecesCommands, TrainGenerateAndEvaluate) {
  EXPECT_NE(said_.find("\"bpe\": 120"), std::string::npos) << "the resolved settings are printed";
  const std::string info = must("info " + at("run"));
  EXPECT_NE(info.find("pieces"), std::string::npos) << info;
  EXPECT_NE(info.find("of 2 to"), std::string::npos) << info;
  const std::string clip =
      at("data") + "/clips/" +
      std::filesystem::directory_iterator(path("data") / "clips")->path().filename().string();
  must("generate --model " + at("run") + " --seconds 1 --out " + at("free"));
  must("generate --model " + at("run") + " --prompt " + clip +
       " --joints pelvis --seconds 1 --out " + at("prompted"));
  EXPECT_TRUE(std::filesystem::exists(path("prompted.npz")));
  const std::string bits = must("evaluate --model " + at("run") + " --data " + at("data"));
  EXPECT_NE(bits.find("upper bound"), std::string::npos) << bits;
  must("evaluate --long 1 --split train --dances 1 --seed-seconds 0.5 --model " + at("run") +
       " --data " + at("data"));
  must("train --threads 1 --steps 2 --from " + at("run") + " --data " + at("data") + " --config " +
       at("config.json") + " --out " + at("tuned"));
  must("generate --model " + at("tuned") + " --genre waack --seconds 1 --out " + at("waack"));
}

TEST_F(PiecesCommands, WhatHasNoPiecesSaysSo) {
  refused("classify --model " + at("run") + " --data " + at("data") + " --out " + at("c"), 2,
          "model of pieces");
  refused("evaluate --engine f32 --model " + at("run") + " --data " + at("data"), 2,
          "model of pieces");
  refused("train --architecture frames --bpe 100 --unigram 0 --config " + at("config.json") +
              " --data " + at("data") + " --out " + at("no"),
          2, "architecture flat");
  refused("train --bpe 100 --config " + at("config.json") + " --data " + at("data") + " --out " +
              at("no"),
          2, "give one");
  refused("train --bpe 7 --unigram 0 --config " + at("config.json") + " --data " + at("data") +
              " --out " + at("no"),
          2, "no 7 pieces can be learnt");
}

TEST_F(PiecesCommands, ChangedPiecesAreRefused) {
  make_bad("run", [](const std::filesystem::path& bad) {
    write_file(bad / "best" / "pieces.model", read_file(bad / "best" / "pieces.model") + "x");
  });
  refused("generate --model " + at("bad") + " --seconds 1 --out " + at("g"), 3, "pieces.model");
  make_bad("run", [](const std::filesystem::path& bad) {
    std::filesystem::remove(bad / "best" / "pieces.model");
  });
  refused("generate --model " + at("bad") + " --seconds 1 --out " + at("g"), 3, "pieces.model");
}

}  // namespace

}  // namespace mocaplm::pieces_commands_test
