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

// The motions by the files that they go to.
using Planned = std::map<fs::path, std::string>;

void take(Planned& planned, const fs::path& file, const std::string& text) {
  const auto [first, fresh] = planned.emplace(file, text);
  if (!fresh)
    throw UsageError(first->second + " and " + text + " would both be written to " + file.string() +
                     ": convert them into two folders");
}

// Where each motion goes, as far as it is known before the files are read.
std::vector<fs::path> plan(const ConvertJob& job, const std::vector<MotionInput>& inputs,
                           const WriteOptions& options, Planned& planned) {
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
  for (const MotionInput& input : inputs) {
    files.push_back(job.out / (input.name + "." + job.config.to));
    check_written_format(files.back(), options);
    take(planned, files.back(), input.text);
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

// Where one of several motions of a file goes, which reading has shown.
fs::path part_file(const ConvertJob& job, const NamedMotion& motion,
                   const std::vector<fs::path>& read, Planned& planned) {
  if (job.config.to == "auto")
    throw UsageError("the file holds several motions: name one of them, as " + motion.text +
                     ", or give --to " + join(written_formats(), ", --to ") + " and a folder");
  fs::path file = job.out / (motion.name + "." + job.config.to);
  take(planned, file, motion.text);
  check_outputs({file}, read);
  return file;
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
  const std::vector<MotionInput> inputs = find_motions(job.inputs, job.clips, job.read);
  if (inputs.empty()) throw UsageError("there is nothing to convert");
  const WriteOptions options = write_options(job);
  Planned planned;
  const std::vector<fs::path> files = plan(job, inputs, options, planned);
  std::vector<fs::path> written = files;
  written.push_back(job.table);
  std::vector<fs::path> read = files_of(inputs);
  read.push_back(job.character);
  check_outputs(written, read);
  check_writable(files.front());

  std::vector<std::vector<std::vector<Json>>> rows(inputs.size());  // of each input's motions
  std::mutex mutex;
  Progress progress("converting", inputs.size(), "clips");
  parallel_for(inputs.size(), job.threads, [&](std::size_t i) {
    std::vector<NamedMotion> motions = read_motions(inputs[i], job.read);
    std::vector<fs::path> to = {files[i]};
    if (motions.size() > 1) {
      to.clear();
      const std::lock_guard<std::mutex> lock(mutex);
      for (const NamedMotion& motion : motions) to.push_back(part_file(job, motion, read, planned));
    }
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const Clip clip = edited(std::move(motions[k].read.clip), job.config.edit);
      write_clip(to[k], clip, options);
      rows[i].push_back({to[k].string(), motions[k].text, clip.frames(), clip.fps, clip.seconds()});
    }
    const std::lock_guard<std::mutex> lock(mutex);
    progress.add();
  });
  progress.finish();

  Table table("", {"file", "from", "frames", "frames per second", "seconds"});
  table.digits({-1, -1, -1, -1, 2});
  for (std::vector<std::vector<Json>>& of_input : rows)
    for (std::vector<Json>& row : of_input) table.row(std::move(row));
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
