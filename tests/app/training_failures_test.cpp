// Usage, configs and datasets that are wrong: a message that names the place, and nothing changed.
#include "app/trained_run.h"

namespace fs = std::filesystem;

namespace mocaplm::training_failures_test {
namespace {

using TrainingFailures = TrainedRun;

TEST_F(TrainingFailures, UsageExitsWithTwo) {
  for (const std::string command : {"train", "classify", "evaluate"}) {
    refused(command, 2,
            command == "train"      ? "--out"
            : command == "classify" ? "--model"
                                    : "--data");
    refused(command + " --data d --nonsense", 2, "nonsense");
  }
  refused("train --out " + at("new"), 2, "--data");
}

TEST_F(TrainingFailures, ValuesOutOfRangeNameTheOption) {
  refused("train --out o --data d --learning-rate nan", 2, "learning-rate");
  refused("train --out o --data d --n-layer 99999999999999999999", 2, "n-layer");
  refused("classify --model m --data d --steps 0", 2, "steps");
  refused("evaluate --model m --data d --engine int8 --precision f32", 2, "--precision");
  refused("classify --model m clip.bvh --steps 5", 2, "--steps cannot be given with clips");
  refused("classify --model m clip.bvh --data d", 2, "--data cannot be given with clips");
  refused("evaluate --model m --data d --split tset", 2, "split");
}

TEST_F(TrainingFailures, PathsThatAreNotThere) {
  const std::string train = "train --threads 1 --out " + at("new") + " --config ";
  fs::create_directories(path("empty"));
  refused(train + at("none.json") + " --data " + at("data"), 3, "none.json");
  refused(train + at("config.json") + " --data " + at("empty"), 3, "empty");
  refused(train + at("config.json") + " --data " + at("data") + " --from " + at("none"), 3, "none");
  refused("train --resume --out " + at("new"), 2, "new");
  refused("evaluate --model " + at("none") + " --data " + at("data"), 3, "none");
  refused("classify --model " + at("run") + " --data " + at("none"), 3, "none");
}

TEST_F(TrainingFailures, OutThatHoldsSomething) {
  const std::string train =
      "train --threads 1 --config " + at("config.json") + " --data " + at("data") + " --out ";
  refused(train + at("run"), 2, "already holds a training run");
  refused(train + at("data"), 2, "data");
  refused(train + at("config.json"), 3, "config.json");
  refused(train + at("config.json/new"), 3, "config.json");
  refused("train --resume --out " + at("data"), 2, "data");
}

TEST_F(TrainingFailures, WhatCannotBeWrittenIsSaidFirst) {
  const std::string both = " --threads 1 --model " + at("run") + " --data " + at("data");
  for (const std::string command : {"classify", "evaluate"}) {
    refused(command + both + " --json " + at("data"), 3, "is a folder");
    refused(command + both + " --json " + at("config.json/x.json"), 3, "config.json");
  }
  refused("generate --model " + at("run") + " --seconds 1 --json " + at("data"), 3, "is a folder");
  refused("generate --model " + at("run") + " --seconds 1 --out " + at("config.json/dance"), 3,
          "config.json");
}

TEST_F(TrainingFailures, MoreThanTheMemoryHolds) {
  refused("train --threads 1 --config " + at("config.json") + " --data " + at("data") + " --out " +
              at("new") + " --n-embd 8192 --n-layer 96 --n-head 128",
          3, "out of memory");
}

TEST_F(TrainingFailures, LabelsNameWhatThereIs) {
  const std::string both = " --threads 1 --model " + at("run") + " --data " + at("data");
  refused("classify" + both + " --labels gnre", 2, "did you mean \"genre\"");
  refused("classify" + both + " --labels genre,nothing", 2, "choreography");
  refused("evaluate" + both + " --by gnre", 2, "did you mean \"genre\"");
  refused("evaluate" + both + " --where genre", 2, "label=value");
  refused("evaluate" + both + " --by music", 3, "music");
}

}  // namespace
}  // namespace mocaplm::training_failures_test
