#include "motion/formats/smpl_file.h"

#include <algorithm>

#include "common/error.h"
#include "common/text.h"
#include "motion/body_model.h"
#include "motion/formats/phalp.h"
#include "motion/formats/positions.h"
#include "motion/formats/smpl_record.h"
#include "motion/skeleton.h"
#include "motion/turn.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr int kMaxFileDepth = 3;
constexpr std::size_t kMaxPeople = 1000, kMaxLooks = 5000;  // dictionaries

struct Person {
  std::string key;  // "" for the only one of a file
  SmplRecord record;
};

const char* const kCamera = "smpl_params_incam";
const char* const kWorld = "smpl_params_global";

// Keys that wrap a person's arrays and say nothing of who it is.
bool says_nothing(const std::string& key) {
  for (const char* word : {kWorld, kCamera, "smpl_params", "smplx_params", "smpl", "smplx",
                           "results", "result", "pred", "params", "motion", "arr_0"})
    if (key == word) return true;
  return false;
}

// `looks` counts the dictionaries that were looked at: they may lie in one another.
void find_people(const ArrayDict& dict, const std::string& name, int depth, std::size_t& looks,
                 std::vector<Person>& people) {
  if (++looks > kMaxLooks) return;
  if (std::optional<SmplRecord> record = read_smpl_record(dict)) {
    people.push_back({name, std::move(*record)});
    return;
  }
  if (depth >= kMaxFileDepth) return;
  const bool both = dict.has(kWorld) && dict.has(kCamera);
  for (const std::string& key : dict.keys()) {
    if (people.size() >= kMaxPeople || looks > kMaxLooks || (both && key == kCamera)) continue;
    const std::optional<ArrayDict> inner = dict.dict(key);
    if (!inner) continue;
    const std::string more = says_nothing(key) ? name : name.empty() ? key : name + "_" + key;
    const std::size_t before = people.size();
    find_people(*inner, more, depth + 1, looks, people);
    if (people.size() == before) continue;
    SmplRecord& record = people.back().record;
    if (key == kCamera) {
      record.up = UpAxis::minus_y;
      record.layout = UpLayout::usual;
    } else if (key == kWorld) {
      record.up = UpAxis::y;
      record.layout = UpLayout::usual;
    }
    if (both && key == kWorld)
      record.remarks.push_back(
          {"world of two", std::string("has the motion in the world and in the "
                                       "camera's space: the world's is read")});
  }
}

[[noreturn]] void refuse(const ArrayDict& dict) {
  const std::string positions = positions_key(dict), other = other_content(dict);
  const Place place = in_file(dict.file());
  const std::string contents = dict.contents();
  const std::string holds = ", only " + contents;
  if (!positions.empty())
    throw DataError(place, "holds joint positions (" + positions + " " +
                               shape_text(dict.array(positions)) + ") without rotations");
  if (!other.empty())
    throw DataError(place, "holds no motion: it is " + other + "; it has " + contents);
  throw DataError(
      place,
      "holds no motion that is known: no poses, smpl_poses, pose_world, root_orient and "
      "pose_body, or global_orient and body_pose" +
          holds);
}

std::string stem_of(const fs::path& path) {
  return path.stem().string();
}

void choose(std::vector<Person>& people, const std::string& part, const std::string& file) {
  if (part.empty()) return;
  if (people.size() == 1 && people.front().key.empty())
    throw DataError(in_file(file), "holds one motion: name it without #" + part);
  std::vector<std::string> names;
  for (const Person& person : people) names.push_back(person.key);
  const auto found = std::find(names.begin(), names.end(), part);
  if (found == names.end())
    throw DataError(in_file(file), "has no part \"" + part + "\"" + known_names(part, names));
  people = {std::move(people[static_cast<std::size_t>(found - names.begin())])};
}

double rate(const SmplRecord& record, const ReadOptions& options, const std::string& file,
            std::vector<Remark>& remarks) {
  if (options.fps) return *options.fps;
  if (record.fps) return *record.fps;
  if (record.usual_fps <= 0)
    throw DataError(
        in_file(file),
        "says no frame rate (mocap_framerate or mocap_frame_rate): tell it (import, view: "
        "--fps; convert, render: --source-fps)");
  // AIST++ has one rate; all others are those of the video or of the network.
  if (record.program != "AIST++")
    remarks.push_back({"no frame rate", "says no frame rate: " + format_number(record.usual_fps) +
                                            " is taken, as is usual for " + record.program +
                                            " (--fps or --source-fps says another)"});
  return record.usual_fps;
}

void set_body(const SmplRecord& record, const ReadOptions& options, ReadMotion& motion) {
  const bool shaped = std::any_of(record.body.betas.begin(), record.body.betas.end(),
                                  [](double beta) { return beta != 0; });
  if (record.body.betas.empty() && record.body.gender.empty() && options.body.empty()) return;
  auto body = std::make_shared<BodyShape>(record.body);
  if (!options.body.empty())
    body->rest = body_model(options.body)->joints(record.body.betas);
  else if (shaped && !record.body.rest)
    motion.report.remarks.push_back(
        {"mean body",
         "has a shape of its own (betas), which needs SMPL's model file (--body FILE): the "
         "mean body's joints are taken"});
  motion.clip.body = std::move(body);
}

ReadMotion motion_of(Person person, const std::string& name, const std::string& file,
                     const ReadOptions& options) {
  SmplRecord& record = person.record;
  ReadMotion motion;
  Clip& clip = motion.clip;
  clip.name = name;
  motion.report.remarks = std::move(record.remarks);
  clip.fps = rate(record, options, file, motion.report.remarks);
  clip.poses = std::move(record.poses);
  clip.trans = std::move(record.trans);
  set_body(record, options, motion);
  check_clip(clip, file);
  if (record.trans_is_pelvis) clip.trans.rowwise() -= rest_joints(clip).row(0);
  const UpAxis up =
      decide_up(clip, options.up, record.up, record.layout, file, motion.report.remarks);
  if (up != UpAxis::y) turn_world(clip, turn_to_y_up(up));
  return motion;
}

}  // namespace

std::vector<ReadMotion> read_smpl_file(const fs::path& path, const ReadOptions& options) {
  const ArrayDict dict = ArrayDict::open(path);
  std::vector<Person> people;
  for (TrackedPerson& tracked : read_frames_of_people(dict))
    people.push_back({tracked.name, std::move(tracked.record)});
  std::size_t looks = 0;
  if (people.empty()) find_people(dict, "", 0, looks, people);
  const std::string positions = people.empty() ? positions_key(dict) : "";
  if (!positions.empty())
    return {read_position_array(dict.array(positions), stem_of(path), path.string(), positions,
                                frame_rate(dict), options)};
  if (people.empty()) refuse(dict);
  choose(people, options.part, path.string());
  std::vector<ReadMotion> motions;
  const bool several = people.size() > 1;
  for (Person& person : people) {
    const std::string name = several || (!options.part.empty() && !person.key.empty())
                                 ? stem_of(path) + "_" + person.key
                                 : stem_of(path);
    motions.push_back(motion_of(std::move(person), name, path.string(), options));
  }
  return motions;
}

}  // namespace mocaplm
