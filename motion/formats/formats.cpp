#include "motion/formats/formats.h"

#include <algorithm>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/aist.h"
#include "motion/formats/glb.h"
#include "motion/formats/joint_csv.h"
#include "motion/formats/npz.h"
#include "motion/formats/retarget.h"
#include "motion/formats/scene_clips.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

const std::string kRead = ".npz (AMASS), .pkl (AIST++), .bvh, .fbx, .glb, .gltf, .vrma or .dae";

enum class Format { unknown, npz, pkl, bvh, fbx, glb, gltf, dae, csv };

std::string title(Format format) {
  switch (format) {
    case Format::npz:
      return "a zip archive (.npz)";
    case Format::pkl:
      return "a Python pickle (.pkl)";
    case Format::bvh:
      return "a BVH text (.bvh)";
    case Format::fbx:
      return "an FBX scene (.fbx)";
    case Format::glb:
      return "a binary glTF scene (.glb)";
    case Format::gltf:
      return "a glTF scene (.gltf)";
    case Format::dae:
      return "a COLLADA scene (.dae)";
    default:
      return "none of " + kRead;
  }
}

Format by_extension(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  return extension == ".npz"    ? Format::npz
         : extension == ".pkl"  ? Format::pkl
         : extension == ".bvh"  ? Format::bvh
         : extension == ".fbx"  ? Format::fbx
         : extension == ".glb"  ? Format::glb
         : extension == ".vrma" ? Format::glb
         : extension == ".gltf" ? Format::gltf
         : extension == ".dae"  ? Format::dae
         : extension == ".csv"  ? Format::csv
                                : Format::unknown;
}

bool is_read(Format format) {
  return format != Format::unknown && format != Format::csv;
}

bool is_scene(Format format) {
  return format == Format::fbx || format == Format::glb || format == Format::gltf ||
         format == Format::dae;
}

bool begins_with(const std::string& text, const std::string& begin) {
  return text.compare(0, begin.size(), begin) == 0;
}

Format by_content(const std::string& head) {
  if (begins_with(head, "PK\3\4") || begins_with(head, "PK\5\6")) return Format::npz;
  if (begins_with(head, "\x80")) return Format::pkl;
  if (begins_with(head, "glTF")) return Format::glb;
  if (begins_with(head, "Kaydara FBX Binary") || begins_with(head, "; FBX")) return Format::fbx;
  if (head.find("<COLLADA") != std::string::npos) return Format::dae;
  const std::size_t bom = begins_with(head, "\xef\xbb\xbf") ? 3 : 0;
  const std::size_t word = head.find_first_not_of(" \t\r\n", bom);
  if (word != std::string::npos && lower(head.substr(word, 9)) == "hierarchy") return Format::bvh;
  return Format::unknown;
}

// The extension decides; a file that clearly is another format is refused by what it looks like.
Format format_of(const fs::path& path) {
  const std::string file = path.string();
  const std::string head = read_head(path, 512);
  const Format named = by_extension(path), found = by_content(head);
  if (head.empty()) throw DataError(in_file(file), "is empty");
  if (named == Format::csv && !is_read(found))
    throw DataError(in_file(file), "is a .csv, which is written but not read; expected " + kRead);
  if (named == Format::unknown)
    throw DataError(
        in_file(file),
        "has the extension \"" + path.extension().string() + "\", expected " + kRead +
            (found == Format::unknown ? "" : "; it looks like " + title(found) + ": rename it"));
  if (found != named && found != Format::unknown)
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

}  // namespace

bool is_motion_file(const fs::path& path) {
  return is_read(by_extension(path));
}

std::vector<ReadMotion> read_clips(const fs::path& path, const ReadOptions& options) {
  if (options.fps && !(*options.fps > 0 && *options.fps <= 10000))
    throw UsageError("a frame rate of " + format_number(*options.fps) +
                     ", expected more than 0 and at most 10000 per second");
  const Format format = format_of(path);
  if (is_scene(format)) {
    std::vector<ReadMotion> takes = read_scene_clips(path, options);
    for (ReadMotion& take : takes) {
      check_clip(take.clip, path.string());
      drop_first(take.clip, options.drop_first, path.string());
    }
    return takes;
  }
  std::vector<ReadMotion> motions(1);
  ReadMotion& motion = motions.front();
  switch (format) {
    case Format::npz:
      motion.clip = read_npz(path, options.up, options.fps);
      break;
    case Format::pkl:
      motion.clip = read_aist_pkl(path, options.up, options.fps);
      break;
    default: {
      BvhOptions bvh;
      bvh.fps = options.fps;
      bvh.map_file = options.bvh_map;
      bvh.up = options.up;
      bvh.unit = options.unit;
      motion.clip = read_bvh_clip(path, bvh, &motion.report.retarget);
    }
  }
  check_clip(motion.clip, path.string());
  drop_first(motion.clip, options.drop_first, path.string());
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
  static const std::vector<std::string> formats = {"npz", "bvh", "glb", "csv"};
  return formats;
}

void check_written_format(const fs::path& path) {
  const std::vector<std::string>& formats = written_formats();
  const std::string extension = lower(path.extension().string());
  if (extension.empty() ||
      std::find(formats.begin(), formats.end(), extension.substr(1)) == formats.end())
    throw UsageError("cannot write motion to \"" + path.string() + "\": the name must end in ." +
                     join(written_formats(), ", ."));
}

void write_clip(const fs::path& path, const Clip& clip, const WriteOptions& options) {
  check_written_format(path);
  switch (by_extension(path)) {
    case Format::npz:
      return write_npz(path, clip);
    case Format::bvh:
      return write_bvh(path, clip, options.bvh_unit);
    case Format::glb:
      return write_glb(path, clip);
    default:
      return write_joint_csv(path, clip);
  }
}

}  // namespace mocaplm
