#include "motion/formats/aist.h"

#include <map>
#include <regex>

#include "common/files.h"
#include "common/text.h"
#include "motion/formats/npz.h"
#include "motion/formats/pickle.h"

namespace mocaplm {

namespace {

constexpr double kAistFps = 60;
// The longest AIST++ sequence has 2,878 frames: 0.9 MB.
constexpr std::uintmax_t kMaxPickle = std::uintmax_t{512} << 20;

class AistReader {
 public:
  AistReader(const std::string& bytes, const std::string& file)
      : pickle_(bytes, file), file_(file) {}

  const NumpyArray& array(const std::string& key) const {
    const PickleValue& value = find(key);
    if (value.kind != PickleKind::array || !value.built)
      throw DataError(place(key), key + " is " + describe(value) + ", expected a numpy array");
    return value.array;
  }
  double number(const std::string& key) const {
    const PickleValue& value = find(key);
    const bool plain = value.kind == PickleKind::integer || value.kind == PickleKind::number;
    return plain ? value.number : single_number(array(key), key, place(key));
  }
  Place place(const std::string& key) const { return at_byte(file_, find(key).byte); }

 private:
  const PickleValue& find(const std::string& key) const {
    const PickleValue* value = pickle_.find(key);
    if (value != nullptr) return *value;
    const std::vector<std::string> keys = pickle_.keys();
    throw DataError(in_file(file_), "has no " + key + ": it is " + describe(pickle_.root()) +
                                        (keys.empty() ? "" : " of " + join(keys, ", ")) +
                                        ", expected an AIST++ motion file with smpl_poses, "
                                        "smpl_scaling and smpl_trans");
  }

  Pickle pickle_;
  const std::string& file_;
};

}  // namespace

Clip read_aist_pkl(const std::filesystem::path& path, UpAxis up, std::optional<double> fps) {
  const std::string file = path.string(), bytes = read_file(path, kMaxPickle);
  const AistReader reader(bytes, file);
  const NumpyArray& poses = reader.array("smpl_poses");
  const NumpyArray& trans = reader.array("smpl_trans");
  check_motion_array(poses, "smpl_poses", 72, reader.place("smpl_poses"));
  check_motion_array(trans, "smpl_trans", 3, reader.place("smpl_trans"));
  if (trans.rows() != poses.rows())
    throw DataError(reader.place("smpl_trans"), "smpl_trans has the shape " + shape_text(trans) +
                                                    ", but smpl_poses " + shape_text(poses));
  const double scaling = reader.number("smpl_scaling");
  if (!(scaling > 1e-6 && scaling < 1e9))
    throw DataError(reader.place("smpl_scaling"), "smpl_scaling is " + format_number(scaling) +
                                                      ", expected a positive number of about 93");
  Clip clip;
  clip.name = path.stem().string();
  clip.fps = fps.value_or(kAistFps);
  clip.poses.resize(static_cast<Eigen::Index>(poses.rows()), 72);
  clip.trans.resize(clip.frames(), 3);
  copy_columns(poses, 0, 72, clip.poses);
  copy_columns(trans, 0, 3, clip.trans);
  clip.trans /= scaling;
  check_clip(clip, file);
  if (up == UpAxis::z) turn_z_up_to_y_up(clip);
  return clip;
}

std::optional<Labels> aist_labels(const std::string& stem) {
  static const std::map<std::string, std::string> genres = {
      {"BR", "break"},       {"PO", "pop"},        {"LO", "lock"},  {"MH", "middle-hip-hop"},
      {"LH", "la-hip-hop"},  {"HO", "house"},      {"WA", "waack"}, {"KR", "krump"},
      {"JS", "street-jazz"}, {"JB", "ballet-jazz"}};
  static const std::regex form(
      "g([A-Z]{2})_s(BM|FM)_c(All|[0-9]{2})_(d[0-9]{2})_(m[A-Z]{2}[0-9])_(ch[0-9]{2})");
  std::smatch parts;
  if (stem.size() > 60 || !std::regex_match(stem, parts, form)) return std::nullopt;
  const auto genre = genres.find(parts[1]);
  if (genre == genres.end()) return std::nullopt;
  return Labels{{"genre", genre->second},
                {"situation", parts[2] == "BM" ? "basic" : "advanced"},
                {"dancer", parts[4]},
                {"music", parts[5]},
                {"choreography", parts[6]}};
}

}  // namespace mocaplm
