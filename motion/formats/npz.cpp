#include "motion/formats/npz.h"

#include <vector>

#include "common/error.h"
#include "motion/formats/npy.h"
#include "motion/formats/smpl_file.h"
#include "motion/formats/zip_file.h"
#include "motion/skeleton.h"

namespace fs = std::filesystem;

namespace mocaplm {

Clip read_npz(const fs::path& path, UpAxis up, std::optional<double> fps) {
  if (read_head(path, 2) != "PK") ZipReader{path};  // which says what it is not
  ReadOptions options;
  options.up = up;
  options.fps = fps;
  std::vector<ReadMotion> motions = read_smpl_file(path, options);
  if (motions.size() > 1)
    throw DataError(in_file(path.string()),
                    "holds " + std::to_string(motions.size()) + " motions, expected one");
  return std::move(motions.front().clip);
}

void write_npz(const fs::path& path, const Clip& clip, Flush flush) {
  check_clip(clip, path.string());
  const auto frames = static_cast<std::size_t>(clip.frames());
  const BodyShape body = clip.body ? *clip.body : BodyShape{};
  const std::vector<double> betas = body.betas.empty() ? std::vector<double>(16, 0.0) : body.betas;
  std::vector<std::pair<std::string, std::string>> entries = {
      {"poses.npy", npy_bytes(clip.poses.data(), {frames, 72})},
      {"trans.npy", npy_bytes(clip.trans.data(), {frames, 3})},
      {"betas.npy", npy_bytes(betas.data(), {betas.size()})},
      {"gender.npy", npy_bytes(body.gender.empty() ? "neutral" : body.gender)},
      {"mocap_framerate.npy", npy_bytes(&clip.fps, {})},
      {"up_axis.npy", npy_bytes("y")}};
  if (body.rest) entries.emplace_back("rest_joints.npy", npy_bytes(body.rest->data(), {24, 3}));
  write_zip(path, entries, flush);
}

}  // namespace mocaplm
