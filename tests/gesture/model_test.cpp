#include "gesture/model.h"

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "gesture/made_up.h"
#include "support/refusal.h"

namespace mocaplm::model_test {
namespace {

GestureModel made_up_model() {
  GestureConfig config = made_up_config();
  config.phases = {"move"};
  return fit_gesture(made_up_movements(21, 12, 0.1).recordings, config);
}

TEST(GestureModel, IsTheSameAfterLoading) {
  const TemporaryFolder folder;
  const GestureModel model = made_up_model();
  save_gesture(folder / "m.json", model);
  const GestureModel again = load_gesture(folder / "m.json");
  EXPECT_EQ(gesture_json(again).dump(), gesture_json(model).dump());
  EXPECT_EQ(again.phases[0].f, model.phases[0].f) << "to the last bit";
  EXPECT_EQ(again.phases[0].demonstrations[3].start, model.phases[0].demonstrations[3].start);
  const Boundary boundary = boundary_between({0, 1}, {2, 2}, 0.5);
  EXPECT_EQ(again.phases[0].interval(boundary, 50), model.phases[0].interval(boundary, 50));
  EXPECT_EQ(again.find("move"), 0u);
  EXPECT_PRED2(contains, refusal<UsageError>([&] { again.find("moev"); }), "move");
}

TEST(GestureModel, RefusesWhatIsNotOne) {
  const Json sound = gesture_json(made_up_model());
  const auto bad = [&](const std::string& key, const Json& value, const std::string& part) {
    Json json = sound;
    json[Json::json_pointer(key)] = value;
    const std::string message = refusal([&] { gesture_from_json(json, "m.json"); });
    EXPECT_PRED2(contains, message, part) << key;
    EXPECT_PRED2(contains, message, "m.json");
  };
  bad("/format", "mocaplm dataset", "format");
  bad("/version", 2, "version");
  bad("/extra", 1, "unknown key");
  bad("/settings/harmonics", "ten", "harmonics");
  bad("/phases", Json::array(), "phases");
  bad("/phases/0/name", "", "name");
  bad("/phases/0/rule", "z < 1", "rule");
  bad("/phases/0/coordinates", {"x", "x"}, "coordinates");
  bad("/phases/0/coordinates", Json::array({"x"}), "rank");
  bad("/phases/0/conditions", Json::array({"start"}), "rank");
  bad("/phases/0/harmonics", 0, "harmonics");
  bad("/phases/0/harmonics", 7, "rows");
  bad("/phases/0/f/3/1", nullptr, "finite");
  bad("/phases/0/f/3", {1, 2}, "expected 5 numbers");
  bad("/phases/0/f", "none", "rows");
  bad("/phases/0/covariance/2/2", -1, "negative");
  bad("/phases/0/gram_inverse/0/0", -1, "negative");
  bad("/phases/0/truncation", {1}, "truncation");
  bad("/phases/0/dof", 0, "dof");
  bad("/phases/0/demonstrations", Json::array(), "demonstrations");
  bad("/phases/0/demonstrations/4/duration", 0, "number 4");
  bad("/phases/0/demonstrations/4/start", {1}, "start");
  bad("/phases/0/demonstrations/4/surprise", 1, "unknown key");
  Json twice = sound;
  twice["phases"].push_back(twice["phases"][0]);
  EXPECT_PRED2(contains, refusal([&] { gesture_from_json(twice, "m.json"); }), "two have the name");
}

TEST(GestureModel, DamagedFilesAreAnErrorAndNothingElse) {
  const std::string sound = gesture_json(made_up_model()).dump();
  Random random(22);
  for (int i = 0; i < 150; ++i) {
    std::string text = sound;
    text[random.below(text.size())] = static_cast<char>(32 + random.below(95));
    if (i % 3 == 0) text.resize(random.below(text.size()));
    reads_or_refuses([&] { gesture_from_json(parse_json(text, "m.json"), "m.json"); }, "m.json");
  }
}

}  // namespace
}  // namespace mocaplm::model_test
