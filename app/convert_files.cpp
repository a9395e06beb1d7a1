#include "app/convert_files.h"

#include <map>
#include <mutex>

#include "common/error.h"
#include "common/files.h"
#include "common/parallel.h"
#include "common/progress.h"
#include "common/text.h"
#include "motion/formats/character.h"
#include "motion/inputs.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

WriteOptions write_options(const ConvertJob& job) {
  WriteOptions options;
  options.bvh_unit = job.config.write_unit == "m" ? BvhUnit::metres : BvhUnit::centimetres;
  options.skeleton = out_scheme_of(job.config.skeleton);
  if (!job.character.empty()) options.character = std::make_shared<const Character>(job.character);
  return options;
}

// Where each motion goes.
std::vector<fs::path> plan(const ConvertJob& job, const std::vector<MotionInput>& inputs,
                           const WriteOptions& options) {
  if (job.config.to == "auto") {
    if (inputs.size() > 1 || fs::is_directory(job.out))
      throw UsageError(job.out.string() + " is to be a folder: give --to " +
                       join(written_formats(), ", --to "));
    check_written_format(job.out, options);
    return {job.out};
  }
  if (fs::exists(job.out) && !fs::is_directory(job.out))
    throw UsageError(job.out.string() + " is a file; with --to the last name is a folder");
  std::vector<fs::path> files;
  std::map<fs::path, std::string> taken;
  for (const MotionInput& input : inputs) {
    files.push_back(job.out / (input.name + "." + job.config.to));
    check_written_format(files.back(), options);
    const auto [first, fresh] = taken.emplace(files.back(), input.text);
    if (!fresh)
      throw UsageError(first->second + " and " + input.text + " would both be written to " +
                       files.back().string() + ": convert them into two folders");
  }
  return files;
}

// Which bones of the character move: whoever reads it sees what was taken for what.
std::string moved_bones(const Character& character) {
  std::vector<std::string> moved, still;
  for (const auto& [joint, bone] : character.bones()) {
    if (!bone.empty())
      moved.push_back(joint + " " + bone);
    else if (joint != "left_hand" && joint != "right_hand")
      still.push_back(joint);
  }
  return "bones: " + join(moved, ", ") + (still.empty() ? "" : "; none for " + join(still, ", "));
}

std::string done_to_all(const ConvertConfig& config) {
  std::vector<std::string> done;
  if (config.edit.fps > 0) done.push_back("resampled");
  if (config.edit.mirror) done.push_back("mirrored");
  if (config.edit.face) done.push_back("first frame faces +Z");
  if (config.edit.floor) done.push_back("soles at height 0");
  return join(done, ", ");
}

}  // namespace

Table convert_files(const ConvertJob& job) {
  const std::vector<MotionInput> inputs = find_motions(job.inputs, job.clips);
  if (inputs.empty()) throw UsageError("there is nothing to convert");
  const WriteOptions options = write_options(job);
  const std::vector<fs::path> files = plan(job, inputs, options);
  std::vector<fs::path> written = files;
  written.push_back(job.table);
  std::vector<fs::path> read = files_of(inputs);
  read.push_back(job.character);
  check_outputs(written, read);
  check_writable(files.front());

  std::vector<std::vector<Json>> rows(inputs.size());
  std::mutex mutex;
  Progress progress("converting", inputs.size(), "clips");
  parallel_for(inputs.size(), job.threads, [&](std::size_t i) {
    const Clip clip = edited(read_motion(inputs[i], job.read).clip, job.config.edit);
    write_clip(files[i], clip, options);
    rows[i] = {files[i].string(), inputs[i].text, clip.frames(), clip.fps, clip.seconds()};
    const std::lock_guard<std::mutex> lock(mutex);
    progress.add();
  });
  progress.finish();

  Table table("", {"file", "from", "frames", "frames per second", "seconds"});
  table.digits({-1, -1, -1, -1, 2});
  for (std::vector<Json>& row : rows) table.row(std::move(row));
  const std::string done = done_to_all(job.config);
  if (!done.empty()) table.note(done);
  if (options.character) table.note(moved_bones(*options.character));
  for (const MotionInput& input : inputs)
    if (input.dataset && input.dataset->procedural) {
      table.note("procedural dances: rules made them, nobody danced them");
      break;
    }
  return table;
}

}  // namespace mocaplm
