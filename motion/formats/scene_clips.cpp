#include "motion/formats/scene_clips.h"

#include <algorithm>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/retarget.h"
#include "motion/formats/scene_takes.h"

namespace mocaplm {

namespace {

void choose(std::vector<SceneMotion>& motions, const std::string& part, const std::string& file) {
  std::vector<std::string> names;
  for (const SceneMotion& motion : motions) names.push_back(motion.name);
  const auto found = std::find(names.begin(), names.end(), part);
  if (found == names.end())
    throw DataError(in_file(file), "has no take \"" + part + "\"" + known_names(part, names));
  SceneMotion chosen = std::move(motions[static_cast<std::size_t>(found - names.begin())]);
  motions.clear();
  motions.push_back(std::move(chosen));
}

}  // namespace

std::vector<ReadMotion> read_scene_clips(const std::filesystem::path& path,
                                         const ReadOptions& options, const SceneReader& reader) {
  const std::string file = path.string(), stem = path.stem().string();
  const Scene scene = read_scene(path, reader);
  const bool own_axes = options.up != UpAxis::automatic;
  SceneMotions found = scene_motions(scene, file, own_axes);
  const bool several = found.motions.size() > 1;
  if (!options.part.empty()) choose(found.motions, options.part, file);

  BvhOptions bvh = bvh_options(options);
  bvh.absolute_root = true;
  if (options.unit) bvh.unit = *options.unit / scene.unit;
  std::vector<ReadMotion> motions;
  for (SceneMotion& take : found.motions) {
    ReadMotion motion;
    motion.clip = retarget_bvh(take.bvh, file, bvh, &motion.report.retarget);
    motion.clip.name = several ? stem + "_" + take.name : stem;
    motion.report.remarks = scene.remarks;
    for (const std::vector<Remark>* remarks :
         {&found.remarks, &take.remarks, &motion.report.retarget.remarks})
      motion.report.remarks.insert(motion.report.remarks.end(), remarks->begin(), remarks->end());
    motions.push_back(std::move(motion));
    take.bvh = Bvh();  // no longer needed, and large
  }
  return motions;
}

}  // namespace mocaplm
