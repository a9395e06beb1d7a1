// All commands that read motion files take the same names and options and mean the same by them:
// what each makes of a file with a wrong header and a part of it is what it makes of the file put
// right, bit for bit.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "evaluate/generated/small_dancer.h"
#include "motion/formats/bvh.h"
#include "motion/inputs.h"
#include "motion/skeleton.h"
#include "support/refusal.h"

namespace fs = std::filesystem;

namespace mocaplm::reading_commands_test {
namespace {

constexpr int kFiles = 8;  // gestures and emulators are learnt from several

// A command with CLIP for a motion and CLIPS for all, and what it makes of them that does not hold
// their names.
struct Reader {
  std::string name, words;
  std::function<std::string(const std::string& out)> made;
  bool torch = false;
};

// Of `info`, what does not speak of the kind of file.
std::string length_rows(const std::string& file) {
  std::string text;
  const Json rows = load_json(file)[0]["rows"];
  for (const Json& row : rows) {
    std::string cells;
    for (const auto& cell : row.items()) cells += cell.value().dump() + " ";
    if (cells.find("\"frames") != std::string::npos) text += cells;
  }
  return text;
}

// Of `query`, all but the seconds of the query's own file.
std::string match_rows(const std::string& file) {
  Json rows = load_json(file)["rows"];
  for (Json& row : rows) row.erase("query from s");
  return rows.dump();
}

std::string without(const std::string& file, const std::string& key) {
  Json json = load_json(file);
  json.erase(key);
  return json.dump();
}

std::vector<Reader> readers() {
  const auto ending = [](const char* end) {
    return [end](const std::string& out) { return read_file(out + end); };
  };
  return {
      {"convert", "CLIP OUT.npz", ending(".npz")},
      {"convert", "CLIPS OUT --to npz",
       [](const std::string& out) {
         std::string all;
         for (int i = 0; i < kFiles; ++i)
           all += read_file(fs::path(out) / ("m" + std::to_string(i) + "_0.5-1.5.npz"));
         return all;
       }},
      {"filter", "CLIP --out OUT.npz", ending(".npz")},
      {"render", "CLIP --out OUT.png --at 0.3 --width 160 --height 120", ending(".png")},
      {"view", "CLIPS --out OUT.html", ending(".html")},
      {"info", "CLIP --json OUT.json",
       [](const std::string& out) { return length_rows(out + ".json"); }},
      {"query", "CLIP --index DATA --fps 20 --window 16 --json OUT.json",
       [](const std::string& out) { return match_rows(out + ".json"); }},
      {"tokenize", "CLIPS --out OUT.json --fps 20", ending(".json")},
      {"gesture fit", "CLIPS --conditions displacement --out OUT.json",
       [](const std::string& out) { return without(out + ".json", "source"); }},
      {"gesture test", "CLIPS --conditions displacement --json OUT.json",
       [](const std::string& out) { return read_file(out + ".json"); }},
      {"emulate fit", "CLIPS --scheme PWI --align none --frames 8 --out OUT.json",
       [](const std::string& out) { return without(out + ".json", "data"); }},
      {"generate", "--model MODEL --prompt CLIP --seconds 0.2 --out OUT.npz", ending(".npz")},
      {"infill", "CLIP --model MASKED --joints left_knee --from 0.2 --to 0.4 --out OUT.npz",
       ending(".npz"), true},
      {"interpolate", "CLIP CLIP --steps 2 --out OUT.npz", ending(".npz"), true},
  };
}

class Reading : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    write_dataset(*folder_ / "data", {{"a", "train", 80}, {"b", "test", 80}});
    StoredModel model = small_dancer();
    save_model(*folder_ / "model", model);
    model.description.config.objective = "masked";
    save_model(*folder_ / "masked", model);
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string at(const std::string& name) { return (*folder_ / name).string(); }
  static bool is_here(const Reader& reader) {
    return !reader.torch || fs::exists(MOCAPLM_BINARY_DIR "/mocaplm-torch");
  }

  // convert, while its --unit is that of the .bvh which it writes.
  static bool lacks(const Reader& reader, const std::string& options) {
    return reader.name == "convert" && contains(options, "--unit") &&
           contains(run_mocaplm("convert --help").text, "--unit NAME");
  }

  // The command on files of `folder` named "m0" + `ending` and on; returns what it made.
  static std::string made(const Reader& reader, const std::string& folder,
                          const std::string& ending, const std::string& options) {
    std::string clips;
    for (int i = 0; i < kFiles; ++i)
      clips += " '" + at(folder + "/m" + std::to_string(i) + ending) + "'";
    const std::string out = at("out-" + folder + "-" + std::to_string(++made_));
    std::string words = reader.words;
    const std::map<std::string, std::string> meant = {
        {"CLIPS", clips},       {"CLIP", "'" + at(folder + "/m0" + ending) + "'"},
        {"OUT", out},           {"DATA", at("data")},
        {"MODEL", at("model")}, {"MASKED", at("masked")}};
    // Longer names first: CLIPS before CLIP.
    for (auto one = meant.rbegin(); one != meant.rend(); ++one)
      for (std::size_t where = 0; (where = words.find(one->first, where)) != std::string::npos;
           where += one->second.size())
        words.replace(where, one->first.size(), one->second);
    const Ran ran = run_mocaplm(reader.name + " " + words + " " + options);
    EXPECT_EQ(ran.code, 0) << reader.name << " " << words << " " << options << "\n" << ran.text;
    return ran.code == 0 ? reader.made(out) : "";
  }

  // Files `wrong/mI.ending`, and what they are when read as `reading` says and cut to 0.5 s to
  // 1.5 s, as `right/mI_0.5-1.5.npz`.
  static void write_files(const std::string& wrong, const std::string& right,
                          const std::string& ending, const MotionReading& reading,
                          const std::function<void(const std::string&, const Clip&)>& write) {
    fs::create_directories(at(wrong));
    fs::create_directories(at(right));
    for (int i = 0; i < kFiles; ++i) {
      const std::string name = "/m" + std::to_string(i);
      write(at(wrong + name + ending), random_clip(50 + static_cast<std::uint64_t>(i), 250, 120));
      write_clip(at(right + name + "_0.5-1.5.npz"),
                 read_one_motion(at(wrong + name + ending) + ":0.5-1.5", reading));
    }
  }

  // `others`: with which they make something else.
  static void all_make_the_same(const std::string& wrong, const std::string& right,
                                const std::string& ending, const std::string& options,
                                const std::string& others) {
    for (const Reader& reader : readers()) {
      if (!is_here(reader) || lacks(reader, options)) continue;
      const std::string expected = made(reader, right, "_0.5-1.5.npz", "");
      EXPECT_FALSE(expected.empty()) << reader.name;
      EXPECT_TRUE(made(reader, wrong, ending + ":0.5-1.5", options) == expected)
          << reader.name << " means something else by " << options;
      EXPECT_FALSE(made(reader, wrong, ending + ":0.5-1.5", others) == expected)
          << reader.name << " does not look at the options";
    }
  }

  static TemporaryFolder* folder_;
  static int made_;
};

TemporaryFolder* Reading::folder_ = nullptr;
int Reading::made_ = 0;

// As the salsa files: the header says 120 frames a second, the truth is 60; the first frames are no
// motion.
TEST_F(Reading, RateUpFirstFramesAndParts) {
  MotionReading reading;
  reading.fps = 60;
  reading.up = UpAxis::z;
  reading.drop_first = 9;
  write_files("wrong", "right", ".npz", reading,
              [](const std::string& file, const Clip& clip) { write_clip(file, clip); });
  all_make_the_same("wrong", "right", ".npz", "--source-fps 60 --up z --drop-first 9", "");
}

TEST_F(Reading, MapAndUnitOfAnUnknownSkeleton) {
  Json joints = Json::object();
  for (const std::string& joint : joint_names()) joints[joint] = "bone_" + joint;
  write_file(at("map.json"), Json{{"joints", joints}}.dump());
  MotionReading reading;
  reading.fps = 60;
  reading.unit = 0.011;
  reading.bvh_map = at("map.json");
  reading.keep_path = true;
  write_files("strange", "known", ".bvh", reading, [](const std::string& file, const Clip& clip) {
    write_clip(file, clip);
    std::string text = read_file(file);
    for (const std::string& joint : joint_names())
      for (const char* before : {"ROOT ", "JOINT "}) {
        const std::size_t found = text.find(before + joint + "\n");
        if (found != std::string::npos) text.insert(found + std::string(before).size(), "bone_");
      }
    write_file(file, text);
  });
  all_make_the_same("strange", "known", ".bvh",
                    "--source-fps 60 --unit 0.011 --keep-path --bvh-map " + at("map.json"),
                    "--unit 0.011 --keep-path --bvh-map " + at("map.json"));
}

// Each of them is an option of each of the commands, and what cannot be is refused with the same
// words.
TEST_F(Reading, EveryCommandHasEveryOption) {
  const Json declared = parse_json(run_mocaplm("declarations").text, "declarations");
  std::set<std::string> names;
  for (const Reader& reader : readers())
    if (is_here(reader)) names.insert(reader.name);
  if (is_here({"classify", "", {}, true})) names.insert("classify");
  std::map<std::string, std::string> first;
  std::size_t commands = 0;
  for (const Json& command : declared) {
    const std::string name = command["command"];
    if (names.count(name) == 0) continue;
    ++commands;
    for (const char* wanted : {"--source-fps", "--up", "--unit", "--bvh-map", "--keep-path",
                               "--fill-gaps", "--drop-first", "--body"}) {
      if (lacks({name, "", {}, false}, wanted)) continue;
      const Json* found = nullptr;
      for (const Json& option : command["options"])
        for (const Json& own : option["names"])
          if (own == wanted) found = &option;
      ASSERT_NE(found, nullptr) << name << " lacks " << wanted;
      Json same = *found;
      same.erase("names");  // view has an older one beside it
      EXPECT_EQ(first.emplace(wanted, same.dump()).first->second, same.dump()) << name;
      EXPECT_EQ(same["group"], "reading motion files") << name;
    }
  }
  EXPECT_EQ(commands, names.size());
  fs::create_directories(at("alone"));
  write_clip(at("alone/m.npz"), random_clip(1, 60, 30));
  const auto refused = [&](const std::string& options, const std::string& part) {
    expect_run("view " + at("alone/m.npz") + " --out " + at("x.html") + " " + options, 2, part);
  };
  refused("--unit inch", "\"inch\" is no unit of length");
  refused("--unit nan", "\"nan\" is no unit of length");
  refused("--up w", "--up: \"w\" is not known");
  refused("--source-fps 0", "--source-fps: \"0\" is not a number from");
  refused("--drop-first -1", "--drop-first: \"-1\" is not a whole number from 0");
  EXPECT_FALSE(fs::exists(at("x.html")));
  // Axes below zero look like options, and --fps is view's older name of the rate.
  const std::string view = "view " + at("alone/m.npz") + " --out ";
  EXPECT_EQ(run_mocaplm(view + at("a.html") + " --up -y --fps 25").code, 0);
  EXPECT_EQ(run_mocaplm(view + at("b.html") + " --up=-y --source-fps 25").code, 0);
  EXPECT_EQ(read_file(at("a.html")), read_file(at("b.html")));
}

// A dataset's clips were read when it was imported.
TEST_F(Reading, OptionsWithoutAFileAreRefused) {
  const std::string data = at("data"), up = " --up z";
  const std::map<std::string, std::string> words = {
      {"convert " + data + " " + at("no") + " --to npz", "--up has no effect"},
      {"convert " + data + "#a " + at("no.npz"), "--up has no effect"},
      {"filter " + data + "#a --out " + at("no"), "--up has no effect"},
      {"render " + data + " --clip a --out " + at("no.png"), "--up has no effect"},
      {"view " + data + " --out " + at("no.html"), "--up has no effect"},
      {"info " + data, "--up has no effect"},
      {"query --index " + data + " --fps 20 --window 16 a", "--up is for motion files"},
      {"query --index " + data + " --evaluate genre", "--up is for"},
      {"tokenize " + data + " --out " + at("no"), "--up has no effect"},
      {"tokenize --decode x.txt --out " + at("no"), "--up is for"},
      {"gesture fit " + data + " --out " + at("no.json"), "--up has no effect"},
      {"gesture fit x.csv --out " + at("no.json"), "--up is for motion files"},
      {"emulate fit " + data + " --out " + at("no.json"), "--up has no effect"},
      {"generate --model " + at("model") + " --out " + at("no"), "--up is for"}};
  for (const auto& [command, part] : words) expect_run(command + up, 2, part);
  for (const char* name : {"no", "no.npz", "no.bvh", "no.html", "no.png", "no.json"})
    EXPECT_FALSE(fs::exists(at(name))) << name;
}

// What a reader takes for granted is told once, whatever the command and however many the files.
TEST_F(Reading, RemarksAreToldOnce) {
  const fs::path file =
      fs::path(MOCAPLM_SOURCE_DIR) / "../shared/cases/strict-parser/frames_one_less.bvh";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  fs::create_directories(at("slips"));
  std::string all;
  for (const char* name : {"a.bvh", "b.bvh", "c.bvh"}) {
    fs::copy_file(file, at(std::string("slips/") + name));
    all += at(std::string("slips/") + name) + " ";
  }
  const Ran one = run_mocaplm("view " + at("slips/a.bvh") + " --out " + at("slips/one.html"));
  if (one.code == 3) GTEST_SKIP() << "refused here: " << one.text;
  EXPECT_EQ(one.code, 0) << one.text;
  EXPECT_TRUE(contains(one.text, "note: " + at("slips/a.bvh") + ": ")) << one.text;
  const Ran many = run_mocaplm("view " + all + " --out " + at("slips/all.html"));
  EXPECT_EQ(count(many.text, "note: 3 files, " + at("slips/a.bvh") + " among them: "),
            count(one.text, "note: " + at("slips/a.bvh") + ": "))
      << many.text;
  EXPECT_FALSE(contains(many.text, "b.bvh")) << many.text;
}

// A clip of a dataset is named like a part of a file, in every command of one motion.
TEST_F(Reading, ClipsOfADatasetAreNamedByItsFolder) {
  const std::string clip = at("data/clips/a.npz"), named = at("data") + "#a";
  for (const Reader& reader : readers()) {
    if (!is_here(reader) || reader.words.find("CLIPS") != std::string::npos) continue;
    if (reader.name == "query") continue;  // its own index's clip leaves itself out
    const auto run = [&](const std::string& text) {
      fs::create_directories(at("one"));
      Reader one = reader;
      for (std::size_t where; (where = one.words.find("CLIP")) != std::string::npos;)
        one.words.replace(where, 4, "'" + text + "'");
      return made(one, "one", "", "");
    };
    EXPECT_TRUE(run(named + ":0.5-1.5") == run(clip + ":0.5-1.5")) << reader.name;
  }
  expect_run("filter " + at("data") + " --out " + at("no"), 2, "data#a");
  expect_run("filter " + at("data") + "#c --out " + at("no"), 2, "is named \"c\"");
}

}  // namespace
}  // namespace mocaplm::reading_commands_test
