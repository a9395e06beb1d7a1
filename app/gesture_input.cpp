#include "app/gesture_input.h"

#include <algorithm>

#include "app/read_options.h"
#include "common/error.h"
#include "common/text.h"
#include "motion/chosen_clips.h"
#include "motion/inputs.h"
#include "motion/joint_path.h"
#include "motion/skeleton.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

bool is_csv(const std::string& path) {
  return lower(fs::path(path).extension().string()) == ".csv";
}

Recording recording_of(const Clip& clip, const std::string& name, int joint, bool in_body,
                       const std::vector<Eigen::Index>& columns) {
  Recording one;
  one.name = name;
  one.time = Eigen::VectorXd::LinSpaced(clip.frames(), 0,
                                        static_cast<double>(clip.frames() - 1) / clip.fps);
  const Eigen::MatrixXd path = joint_path(clip, joint, in_body);
  one.values.resize(path.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j)
    one.values.col(static_cast<Eigen::Index>(j)) = path.col(columns[j]);
  one.more.resize(clip.frames(), 0);
  return one;
}

}  // namespace

void GestureInput::add_options(CLI::App& app) {
  app.add_option("INPUT", inputs,
                 "trajectories (.csv: time, coordinates, and trajectory, phase, event), or a "
                 "dataset folder or motion files (--joint), FILE:from-to for a part (seconds), "
                 "FILE#PART of several people or takes")
      ->required();
  app.add_option("--joint", joint, "of clips: the joint whose path x, y, z is the movement")
      ->capture_default_str();
  app.add_option("--frame", frame,
                 "of clips: from the pelvis and the first frame's heading, or in the world")
      ->check(one_of({"body", "world"}))
      ->capture_default_str();
  app.add_option("--where", where, "of a dataset: only clips with label=value, comma separated")
      ->delimiter(',');
  add_read_options(app, read_as);
}

Recordings GestureInput::read(const GestureConfig& config) const {
  const auto csv = static_cast<std::size_t>(std::count_if(inputs.begin(), inputs.end(), is_csv));
  if (csv > 0 && csv < inputs.size())
    throw UsageError("give either .csv files or motion, not both");
  if (csv > 0) refuse_read_options(read_as, " is for motion files, not for .csv ones");
  if (csv > 0)
    return read_recordings({inputs.begin(), inputs.end()}, config.coordinates, config.conditions);
  const int index = joint_index(joint);
  if (index < 0)
    throw UsageError("--joint: there is no joint \"" + joint + "\"" +
                     known_names(joint, {joint_names().begin(), joint_names().end()}, "Joints"));
  for (const std::string& condition : config.conditions)
    if (!is_own_condition(condition))
      throw UsageError("the condition \"" + condition +
                       "\" is not known: clips have start, end, displacement and duration");
  const std::vector<std::string> axes = {"x", "y", "z"};
  Recordings all;
  all.source = join(inputs, ", ");
  std::vector<Eigen::Index> columns;
  for (const std::string& name : config.coordinates.empty() ? axes : config.coordinates) {
    const auto found = std::find(axes.begin(), axes.end(), name);
    if (found == axes.end())
      throw UsageError("--coordinates: a joint's path has x, y and z, not \"" + name + "\"");
    all.coordinates.push_back(name);
    columns.push_back(found - axes.begin());
  }
  const auto add = [&](const Clip& clip, const std::string& name) {
    if (clip.frames() < 2) throw DataError(in_file(name), "has one frame, a movement has several");
    all.all.push_back(recording_of(clip, name, index, frame == "body", columns));
  };
  find_motions(inputs, {}, read_as);  // all are there, and what is said of files is of use
  for (const std::string& input : inputs) {
    if (is_dataset(input)) {
      const Dataset dataset = load_dataset(input);
      for (const DatasetEntry& entry : chosen_entries(dataset, "", where))
        add(load_clip(dataset, entry), entry.name);
    } else {
      if (!where.empty()) throw UsageError("--where is for dataset folders, not " + input);
      for (const MotionInput& one : find_motions({input}, {}))
        for (const NamedMotion& motion : read_motions(one, read_as))
          add(motion.read.clip, motion.name);
    }
  }
  return all;
}

}  // namespace mocaplm
