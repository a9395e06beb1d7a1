#include "common/files.h"
#include "motion/formats/bvh.h"
#include "motion/formats/bvh_sections.h"

namespace mocaplm {

namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{256} << 20;

}  // namespace

Bvh parse_bvh(std::string_view text, const std::string& name, const BvhTextOptions& options) {
  BvhCursor cursor(text, name);
  Bvh bvh;
  cursor.expect("HIERARCHY");
  parse_hierarchy(cursor, bvh);
  const std::string_view found = cursor.word();
  if (same_word(found, "ROOT"))
    cursor.fail(cursor.last, "a second ROOT, " + shown(cursor.rest_of_line()) + " beside " +
                                 shown(bvh.joints.front().name) +
                                 ": the file holds several figures, and their frames are told "
                                 "apart by nothing; export them one by one");
  if (!same_word(found, "MOTION")) cursor.unexpected(found, "MOTION");
  parse_motion(cursor, bvh, options);
  return bvh;
}

Bvh read_bvh(const std::filesystem::path& path, const BvhTextOptions& options) {
  return parse_bvh(read_file(path, kMaxBytes), path.string(), options);
}

}  // namespace mocaplm
