#include "motion/formats/formats.h"

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/glb.h"
#include "motion/formats/joint_csv.h"
#include "motion/formats/npz.h"
#include "motion/formats/positions.h"
#include "motion/formats/retarget.h"
#include "motion/formats/smpl_file.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

enum class Format { unknown, npz, pkl, npy, pt, bvh, glb, csv };

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
    case Format::glb:
      return "a glTF figure (.glb)";
    case Format::npy:
      return "a numpy array (.npy)";
    case Format::trc:
      return "tracks of markers (.trc)";
    default:
      return "none of " + kRead;
  }
}

Format by_extension(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  return extension == ".npz"                         ? Format::npz
         : extension == ".pkl"                       ? Format::pkl
         : extension == ".npy"                       ? Format::npy
         : extension == ".pt" || extension == ".pth" ? Format::pt
         : extension == ".bvh"                       ? Format::bvh
         : extension == ".glb"                       ? Format::glb
         : extension == ".csv"                       ? Format::csv
                                                     : Format::unknown;
}

bool is_positions(Format format) {
  return format == Format::csv || format == Format::npy || format == Format::trc;
}

bool is_read(Format format) {
  return format == Format::npz || format == Format::pkl || format == Format::npy ||
         format == Format::pt || format == Format::bvh;
}

bool begins_with(const std::string& text, const std::string& begin) {
  return text.compare(0, begin.size(), begin) == 0;
}

Format by_content(const std::string& head) {
  if (begins_with(head, "PK\3\4") || begins_with(head, "PK\5\6")) return Format::npz;
  if (begins_with(head, "\x80")) return Format::pkl;
  if (begins_with(head, "\x93NUMPY")) return Format::npy;
  if (begins_with(head, "glTF")) return Format::glb;
  if (begins_with(head, "\x93NUMPY")) return Format::npy;
  const std::size_t bom = begins_with(head, "\xef\xbb\xbf") ? 3 : 0;
  const std::size_t word = head.find_first_not_of(" \t\r\n", bom);
  if (word != std::string::npos && lower(head.substr(word, 9)) == "hierarchy") return Format::bvh;
  if (word != std::string::npos && lower(head.substr(word, 12)) == "pathfiletype")
    return Format::trc;
  return Format::unknown;
}

// The extension decides; a file that clearly is another format is refused by what it looks like.
Format format_of(const fs::path& path) {
  const std::string file = path.string();
  const std::string head = read_head(path, 64);
  const Format named = by_extension(path), found = by_content(head);
  if (head.empty()) throw DataError(in_file(file), "is empty");
  if (named == Format::glb && !is_read(found))
    throw DataError(in_file(file),
                    "is a .glb, which is written but not read; expected one of " + kRead);
  if (named == Format::unknown)
    throw DataError(
        in_file(file),
        "has the extension \"" + path.extension().string() + "\", expected one of " + kRead +
            (found == Format::unknown ? "" : "; it looks like " + title(found) + ": rename it"));
  // torch.save writes zip archives, and older versions pickles.
  const bool torch = named == Format::pt && (found == Format::npz || found == Format::pkl);
  if (found != named && found != Format::unknown && !torch)
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

bool looks_like_motion(const fs::path& path) {
  const Format format = by_extension(path);
  return is_positions(format) ? holds_positions(path) : is_read(format);
}

std::vector<ReadMotion> read_clips(const fs::path& path, const ReadOptions& options) {
  if (options.fps && !(*options.fps > 0 && *options.fps <= 10000))
    throw UsageError("a frame rate of " + format_number(*options.fps) +
                     ", expected more than 0 and at most 10000 per second");
  const Format format = format_of(path);
  std::vector<ReadMotion> motions(1);
  if (is_positions(format)) motions = read_positions_file(path, options);
  ReadMotion& motion = motions.front();
  switch (format) {
    case Format::npz:
    case Format::pkl:
    case Format::npy:
    case Format::pt:
      motions = read_smpl_file(path, options);
      break;
    case Format::csv:
    case Format::npy:
    case Format::trc:
      break;
    default: {
      BvhOptions bvh;
      bvh.fps = options.fps;
      bvh.map_file = options.bvh_map;
      bvh.up = options.up;
      bvh.unit = options.unit;
      bvh.keep_path = options.keep_path;
      bvh.write_map = options.write_map;
      motion.clip = read_bvh_clip(path, bvh, &motion.report.retarget);
      motion.report.remarks = motion.report.retarget.remarks;
    }
  }
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
  static const std::vector<std::string> formats = {"npz", "bvh", "glb", "csv"};
  return formats;
}

void check_written_format(const fs::path& path) {
  const Format format = by_extension(path);
  if (format == Format::unknown || format == Format::pkl)
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
