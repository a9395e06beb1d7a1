#include "tokenizer/word_measure.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "tokenizer/alphabet.h"

namespace mocaplm {

namespace {

constexpr double kNoDirection = 1e-9;  // a vector shorter than this has no direction

void measure_words(const TokenStream& stream, WordMeasure& measure) {
  std::int64_t length = 0;
  for (const std::int32_t id : stream.ids) {
    if (id != Tokenizer::kSeparator) {
      ++length;
      continue;
    }
    ++measure.words;
    measure.characters += length;
    measure.longest = std::max(measure.longest, length);
    length = 0;
  }
}

// before, after (frames, 3 joints).
void measure_rotations(const Eigen::MatrixXd& before, const Eigen::MatrixXd& after,
                       WordMeasure& measure) {
  for (Eigen::Index t = 0; t < before.rows(); ++t) {
    const Eigen::VectorXd a = before.row(t).transpose(), b = after.row(t).transpose();
    measure.frame_vectors.add(vector_angle(a, b));
    for (Eigen::Index c = 0; c < a.size(); c += 3) {
      const Eigen::Vector3d from = a.segment<3>(c), to = b.segment<3>(c);
      measure.joint_vectors.add(vector_angle(from, to));
      measure.geodesic.add(
          geodesic_angle(quaternion_from_axis_angle(from), quaternion_from_axis_angle(to)));
    }
    if (t == 0) continue;
    const double change = (a - b - (before.row(t - 1) - after.row(t - 1)).transpose()).norm() /
                          std::sqrt(static_cast<double>(a.size()));
    (t % measure.word_frames == 0 ? measure.border_jump : measure.inside_jump).add(change);
  }
}

// The decoded rotation vectors of the tokenizer's joints take the original's place.
void measure_positions(const std::vector<int>& joints, bool root, const Clip& original,
                       const Clip& decoded, WordMeasure& measure) {
  Clip told = original;
  for (const int joint : joints)
    told.poses.middleCols<3>(3 * joint) = decoded.poses.middleCols<3>(3 * joint);
  if (root) told.trans = decoded.trans;
  for (Eigen::Index t = 0; t < original.frames(); ++t) {
    const JointPositions off = joint_positions(original, t) - joint_positions(told, t);
    for (Eigen::Index j = 0; j < off.rows(); ++j) measure.position.add(100 * off.row(j).norm());
  }
}

}  // namespace

double vector_angle(const Eigen::Ref<const Eigen::VectorXd>& a,
                    const Eigen::Ref<const Eigen::VectorXd>& b) {
  const double of_a = a.norm(), of_b = b.norm();
  const bool no_a = of_a < kNoDirection, no_b = of_b < kNoDirection;
  if (no_a || no_b) return no_a && no_b ? 0 : kPi / 2;
  // The same angle as the arccos, without its loss of digits near 0 (Kahan).
  double difference = 0, sum = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    const double u = a[i] / of_a, v = b[i] / of_b;
    difference += (u - v) * (u - v);
    sum += (u + v) * (u + v);
  }
  return 2 * std::atan2(std::sqrt(difference), std::sqrt(sum));
}

WordMeasure start_measure(const AnyTokenizer& tokenizer) {
  WordMeasure measure;
  measure.fps = tokenizer.frames().fps;
  measure.word_frames = tokenizer.word_frames();
  measure.root = tokenizer.tells_root();
  std::string alphabet = " ";
  for (int c = 0; c < tokenizer.characters(); ++c) append_utf8(alphabet, bin_character(c));
  measure.dictionary_bytes = static_cast<std::int64_t>(alphabet.size());
  return measure;
}

TokenStream measure_clip(const AnyTokenizer& tokenizer, const Clip& clip, WordMeasure& measure) {
  const TokenStream stream = tokenizer.encode(clip);
  const Clip original = resample(clip, measure.fps);
  const Clip decoded =
      tokenizer.decode(stream.ids, original.frames(), clip.name, original.trans.row(0).transpose());
  const Eigen::MatrixXd before = tokenizer.rotations(clip);
  Eigen::MatrixXd after(before.rows(), before.cols());
  const std::vector<int>& joints = tokenizer.joints();
  for (std::size_t i = 0; i < joints.size(); ++i)
    after.middleCols<3>(static_cast<Eigen::Index>(3 * i)) =
        decoded.poses.middleCols<3>(3 * joints[i]);
  ++measure.clips;
  measure.frames += original.frames();
  measure.text_bytes += static_cast<std::int64_t>(tokenizer.to_text(stream.ids).size());
  measure_words(stream, measure);
  measure_rotations(before, after, measure);
  measure_positions(joints, measure.root, original, decoded, measure);
  return stream;
}

Table word_table(const WordMeasure& measure, const std::string& title,
                 const std::string& fingerprint) {
  constexpr double kContext = 1024;
  Table table(title, {"quantity", "value", "unit"});
  table.row({"clips", measure.clips, ""});
  table.row({"frames", measure.frames, ""});
  table.row({"words", measure.words, ""});
  table.row({"tokens", measure.characters + measure.words, "with separators"});
  table.row({"word length, mean", measure.word_length(), "characters"});
  table.row({"word length, max", measure.longest, "characters"});
  table.row({"in 1,024 tokens", measure.seconds_in(kContext), "seconds"});
  table.row({"compression", measure.compression(), "times"});
  table.row({"rotation error, mean", kDegrees * measure.geodesic.mean(), "degrees, geodesic"});
  table.row({"rotation error, max", kDegrees * measure.geodesic.max, "degrees, geodesic"});
  table.row({"joint position error, mean", measure.position.mean(), "cm"});
  table.row({"joint position error, max", measure.position.max, "cm"});
  table.row({"error's change at borders", measure.seam(), "times that inside words"});
  table.note("fingerprint " + fingerprint);
  return table;
}

}  // namespace mocaplm
