#include "motion/formats/formats.h"

#include <algorithm>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/array_dict.h"
#include "motion/formats/character.h"
#include "motion/formats/disguise.h"
#include "motion/formats/glb.h"
#include "motion/formats/joint_csv.h"
#include "motion/formats/npz.h"
#include "motion/formats/positions.h"
#include "motion/formats/retarget.h"
#include "motion/formats/scene_clips.h"
#include "motion/formats/smpl_file.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

enum class Format { unknown, npz, pkl, npy, pt, bvh, fbx, glb, vrma, gltf, dae, csv, trc };

const char* const kRead =
    ".npz, .pkl, .npy or .pt (SMPL), .bvh, .fbx, .glb, .gltf, .vrma, .dae, or .csv, .npy or .trc "
    "of "
    "joint positions";

std::string title(Format format) {
  switch (format) {
    case Format::npz:
      return "a zip archive (.npz)";
    case Format::pkl:
      return "a Python pickle (.pkl)";
    case Format::npy:
      return "a numpy array (.npy)";
    case Format::pt:
      return "a PyTorch archive (.pt)";
    case Format::bvh:
      return "a BVH text (.bvh)";
    case Format::fbx:
      return "an FBX scene (.fbx)";
    case Format::glb:
    case Format::vrma:
      return "a binary glTF scene (.glb)";
    case Format::gltf:
      return "a glTF scene (.gltf)";
    case Format::dae:
      return "a COLLADA scene (.dae)";
    case Format::trc:
      return "tracks of markers (.trc)";
    default:
      return std::string("none of ") + kRead;
  }
}

Format by_extension(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  return extension == ".npz"                         ? Format::npz
         : extension == ".pkl"                       ? Format::pkl
         : extension == ".npy"                       ? Format::npy
         : extension == ".pt" || extension == ".pth" ? Format::pt
         : extension == ".bvh"                       ? Format::bvh
         : extension == ".fbx"                       ? Format::fbx
         : extension == ".glb"                       ? Format::glb
         : extension == ".vrma"                      ? Format::vrma
         : extension == ".gltf"                      ? Format::gltf
         : extension == ".dae"                       ? Format::dae
         : extension == ".csv"                       ? Format::csv
         : extension == ".trc"                       ? Format::trc
                                                     : Format::unknown;
}

bool is_scene(Format format) {
  return format == Format::fbx || format == Format::glb || format == Format::vrma ||
         format == Format::gltf || format == Format::dae;
}

Format by_content(const std::string& head) {
  if (starts_with(head, "PK\3\4") || starts_with(head, "PK\5\6")) return Format::npz;
  if (starts_with(head, "\x80")) return Format::pkl;
  if (starts_with(head, "\x93NUMPY")) return Format::npy;
  if (starts_with(head, "glTF")) return Format::glb;
  if (starts_with(head, "Kaydara FBX Binary") || starts_with(head, "; FBX")) return Format::fbx;
  if (head.find("<COLLADA") != std::string::npos) return Format::dae;
  const std::size_t bom = starts_with(head, "\xef\xbb\xbf") ? 3 : 0;
  const std::size_t word = head.find_first_not_of(" \t\r\n", bom);
  if (word == std::string::npos) return Format::unknown;
  if (lower(head.substr(word, 9)) == "hierarchy") return Format::bvh;
  if (lower(head.substr(word, 12)) == "pathfiletype") return Format::trc;
  return Format::unknown;
}

// Whether a file named as `named` may look like `found`.
bool fits(Format named, Format found) {
  // torch.save writes zip archives, and older versions pickles.
  if (named == Format::pt) return found == Format::npz || found == Format::pkl;
  return named == found || (named == Format::vrma && found == Format::glb);
}

// The extension decides; a file that clearly is another format is refused by what it looks like.
Format format_of(const fs::path& path) {
  const std::string file = path.string();
  const std::string head = read_head(path, 512);
  const Format named = by_extension(path), found = by_content(head);
  if (head.empty()) throw DataError(in_file(file), "is empty");
  refuse_disguised(head, path);
  if (named == Format::unknown)
    throw DataError(
        in_file(file),
        "has the extension \"" + path.extension().string() + "\", expected " + kRead +
            (found == Format::unknown ? "" : "; it looks like " + title(found) + ": rename it"));
  if (found != Format::unknown && !fits(named, found))
    throw DataError(at_byte(file, 0), "is named " + path.extension().string() + " but looks like " +
                                          title(found) + ": rename it");
  return named;
}

void drop_first(Clip& clip, std::int64_t count, const std::string& file) {
  if (count <= 0) return;
  if (count >= clip.frames())
    throw DataError(in_file(file), "has " + std::to_string(clip.frames()) +
                                       " frames, and the first " + std::to_string(count) +
                                       " are to be left out");
  clip = slice(clip, count, clip.frames() - count);
}

std::vector<ReadMotion> read_bvh_file(const fs::path& path, const ReadOptions& options) {
  std::vector<ReadMotion> motions(1);
  ReadReport& report = motions.front().report;
  motions.front().clip = read_bvh_clip(path, bvh_options(options), &report.retarget);
  report.remarks = std::move(report.retarget.remarks);
  return motions;
}

std::vector<ReadMotion> read_all(Format format, const fs::path& path, const ReadOptions& options) {
  if (is_scene(format)) return read_scene_clips(path, options);
  if (format == Format::bvh) return read_bvh_file(path, options);
  const bool positions = format == Format::csv || format == Format::trc ||
                         (format == Format::npy && !is_dict_npy(path));
  return positions ? read_positions_file(path, options) : read_smpl_file(path, options);
}

}  // namespace

BvhOptions bvh_options(const ReadOptions& options) {
  BvhOptions bvh;
  bvh.fps = options.fps;
  bvh.map_file = options.bvh_map;
  bvh.write_map = options.write_map;
  bvh.up = options.up;
  bvh.unit = options.unit;
  bvh.keep_path = options.keep_path;
  bvh.fill_gaps = options.fill_gaps;
  return bvh;
}

bool is_motion_file(const fs::path& path) {
  return by_extension(path) != Format::unknown;
}

bool looks_like_motion(const fs::path& path) {
  const Format format = by_extension(path);
  if (format == Format::npy && is_dict_npy(path)) return true;
  const bool positions = format == Format::csv || format == Format::npy || format == Format::trc;
  return positions ? holds_positions(path) : format != Format::unknown;
}

std::vector<ReadMotion> read_clips(const fs::path& path, const ReadOptions& options) {
  if (options.fps && !(*options.fps > 0 && *options.fps <= 10000))
    throw UsageError("a frame rate of " + format_number(*options.fps) +
                     ", expected more than 0 and at most 10000 per second");
  std::vector<ReadMotion> motions = read_all(format_of(path), path, options);
  for (ReadMotion& one : motions) {
    check_clip(one.clip, path.string());
    drop_first(one.clip, options.drop_first, path.string());
  }
  return motions;
}

Clip read_clip(const fs::path& path, const ReadOptions& options, ReadReport* report) {
  std::vector<ReadMotion> motions = read_clips(path, options);
  if (motions.size() > 1) {
    std::vector<std::string> names;
    for (const ReadMotion& motion : motions) names.push_back(motion.clip.name);
    throw DataError(in_file(path.string()), "holds " + std::to_string(names.size()) + " motions (" +
                                                join(names, ", ") +
                                                "), expected one: name one as FILE#PART");
  }
  if (report != nullptr) *report = std::move(motions.front().report);
  return std::move(motions.front().clip);
}

const std::vector<std::string>& written_formats() {
  static const std::vector<std::string> formats = {"npz", "bvh", "glb", "vrma", "csv"};
  return formats;
}

void check_written_format(const fs::path& path, const WriteOptions& options) {
  const Format format = by_extension(path);
  const std::string name = "\"" + path.string() + "\"";
  const std::string extension = lower(path.extension().string());
  const std::vector<std::string>& formats = written_formats();
  if (extension.empty() ||
      std::find(formats.begin(), formats.end(), extension.substr(1)) == formats.end())
    throw UsageError("cannot write motion to " + name + ": the name must end in ." +
                     join(written_formats(), ", ."));
  if (options.bvh_unit == BvhUnit::metres && format != Format::bvh)
    throw UsageError("a unit is written to a .bvh only, and " + name + " is none");
  if (options.character && format != Format::glb)
    throw UsageError("a character is written to a .glb only, and " + name + " is none");
  if (options.character && options.skeleton != OutScheme::smpl)
    throw UsageError("a character has a skeleton of its own, and that of " +
                     to_string(options.skeleton) + " is asked for in " + name);
  if (options.skeleton == OutScheme::smpl || format == Format::bvh || format == Format::glb) return;
  if (format != Format::vrma)
    throw UsageError("the skeleton of " + to_string(options.skeleton) +
                     " is written to a .bvh or a .glb only, and " + name + " is none");
  if (options.skeleton != OutScheme::vrm)
    throw UsageError("a .vrma has the skeleton of vrm, and that of " + to_string(options.skeleton) +
                     " is asked for in " + name);
}

void write_clip(const fs::path& path, const Clip& clip, const WriteOptions& options) {
  check_written_format(path, options);
  switch (by_extension(path)) {
    case Format::npz:
      return write_npz(path, clip);
    case Format::bvh:
      return write_bvh(path, clip, options.bvh_unit, options.skeleton);
    case Format::glb:
      if (!options.character) return write_glb(path, clip, options.skeleton);
      check_clip(clip, path.string());
      return write_file(path, options.character->animated(clip));
    case Format::vrma:
      return write_vrma(path, clip);
    default:
      return write_joint_csv(path, clip);
  }
}

}  // namespace mocaplm
