#include "motion/formats/formats.h"

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/aist.h"
#include "motion/formats/npz.h"
#include "motion/formats/retarget.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

enum class Format { unknown, npz, pkl, bvh };

std::string title(Format format) {
  switch (format) {
    case Format::npz:
      return "a zip archive (.npz)";
    case Format::pkl:
      return "a Python pickle (.pkl)";
    case Format::bvh:
      return "a BVH text (.bvh)";
    default:
      return "none of .npz, .pkl and .bvh";
  }
}

Format by_extension(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  return extension == ".npz"   ? Format::npz
         : extension == ".pkl" ? Format::pkl
         : extension == ".bvh" ? Format::bvh
                               : Format::unknown;
}

bool begins_with(const std::string& text, const std::string& begin) {
  return text.compare(0, begin.size(), begin) == 0;
}

Format by_content(const std::string& head) {
  if (begins_with(head, "PK\3\4") || begins_with(head, "PK\5\6")) return Format::npz;
  if (begins_with(head, "\x80")) return Format::pkl;
  const std::size_t bom = begins_with(head, "\xef\xbb\xbf") ? 3 : 0;
  const std::size_t word = head.find_first_not_of(" \t\r\n", bom);
  if (word != std::string::npos && lower(head.substr(word, 9)) == "hierarchy") return Format::bvh;
  return Format::unknown;
}

// The extension decides; a file that clearly is another format is refused by what it looks like.
Format format_of(const fs::path& path) {
  const std::string file = path.string();
  const std::string head = read_head(path, 64);
  const Format named = by_extension(path), found = by_content(head);
  if (head.empty()) throw DataError(in_file(file), "is empty");
  if (named == Format::unknown)
    throw DataError(
        in_file(file),
        "has the extension \"" + path.extension().string() +
            "\", expected .npz (AMASS), .pkl (AIST++) or .bvh" +
            (found == Format::unknown ? "" : "; it looks like " + title(found) + ": rename it"));
  if (found != named && found != Format::unknown)
    throw DataError(at_byte(file, 0), "is named " + path.extension().string() + " but looks like " +
                                          title(found) + ": rename it");
  return named;
}

}  // namespace

bool is_motion_file(const fs::path& path) {
  return by_extension(path) != Format::unknown;
}

Clip read_clip(const fs::path& path, const ReadOptions& options, RetargetReport* report) {
  if (options.fps && !(*options.fps > 0 && *options.fps <= 10000))
    throw UsageError("a frame rate of " + format_number(*options.fps) +
                     ", expected more than 0 and at most 10000 per second");
  Clip clip;
  switch (format_of(path)) {
    case Format::npz:
      clip = read_npz(path, options.up, options.fps);
      break;
    case Format::pkl:
      clip = read_aist_pkl(path, options.up, options.fps);
      break;
    default: {
      BvhOptions bvh;
      bvh.fps = options.fps;
      bvh.map_file = options.bvh_map;
      bvh.up = options.up;
      clip = read_bvh_clip(path, bvh, report);
    }
  }
  check_clip(clip, path.string());
  return clip;
}

void write_clip(const fs::path& path, const Clip& clip) {
  switch (by_extension(path)) {
    case Format::npz:
      write_npz(path, clip);
      return;
    case Format::bvh:
      write_bvh(path, clip);
      return;
    default:
      throw UsageError("cannot write motion to \"" + path.string() +
                       "\": the name must end in .npz or .bvh");
  }
}

}  // namespace mocaplm
