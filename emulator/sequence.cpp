#include "emulator/sequence.h"

#include <algorithm>
#include <cmath>

#include "common/parallel.h"
#include "emulator/sphere.h"

namespace mocaplm {

void check_sequence(const PostureSequence& sequence, const Place& place) {
  if (sequence.limbs() == 0 || sequence.frames() == 0)
    throw DataError(place, "a sequence of postures has no limb or no frame");
  for (Eigen::Index t = 0; t < sequence.frames(); ++t)
    for (Eigen::Index i = 0; i < sequence.limbs(); ++i) {
      const double length = sequence.at(t).col(i).norm();
      if (!(std::abs(length - 1) <= 1e-6))
        throw DataError(place, "frame " + std::to_string(t) + ", limb " + std::to_string(i) +
                                   ": a direction of length " + std::to_string(length) +
                                   ", expected 1");
    }
}

double posture_distance(const Posture& y, const Posture& z) {
  double sum = 0;
  for (Eigen::Index i = 0; i < y.cols(); ++i) sum += sphere_distance(y.col(i), z.col(i));
  return sum;
}

double posture_geodesic_distance(const Posture& y, const Posture& z) {
  double sum = 0;
  for (Eigen::Index i = 0; i < y.cols(); ++i) {
    const double angle = sphere_distance(y.col(i), z.col(i));
    sum += angle * angle;
  }
  return std::sqrt(sum);
}

PostureTangent posture_log(const Posture& y, const Posture& z) {
  PostureTangent v(3, y.cols());
  for (Eigen::Index i = 0; i < y.cols(); ++i) v.col(i) = sphere_log(y.col(i), z.col(i));
  return v;
}

Posture posture_exp(const Posture& y, const PostureTangent& v) {
  Posture z(3, y.cols());
  for (Eigen::Index i = 0; i < y.cols(); ++i) z.col(i) = sphere_exp(y.col(i), v.col(i));
  return z;
}

PostureTangent posture_transport(const PostureTangent& v, const Posture& y, const Posture& z) {
  PostureTangent moved(3, y.cols());
  for (Eigen::Index i = 0; i < y.cols(); ++i)
    moved.col(i) = sphere_transport(v.col(i), y.col(i), z.col(i));
  return moved;
}

Posture mean_posture(const std::vector<PostureSequence>& sequences, Eigen::Index at_most) {
  std::vector<std::pair<std::size_t, Eigen::Index>> all, chosen;
  for (std::size_t m = 0; m < sequences.size(); ++m)
    for (Eigen::Index t = 0; t < sequences[m].frames(); ++t) all.emplace_back(m, t);
  const std::size_t most = static_cast<std::size_t>(at_most);
  const std::size_t count = at_most > 0 && most < all.size() ? most : all.size();
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(all[k * all.size() / count]);
  const Eigen::Index limbs = sequences.empty() ? 0 : sequences[0].limbs();
  Posture mean(3, limbs);
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(count));
  for (Eigen::Index i = 0; i < limbs; ++i) {
    for (std::size_t k = 0; k < count; ++k)
      points.col(static_cast<Eigen::Index>(k)) =
          sequences[chosen[k].first].at(chosen[k].second).col(i);
    mean.col(i) = sphere_mean(points);
  }
  return mean;
}

PostureSequence mean_sequence(const std::vector<PostureSequence>& sequences, int threads) {
  PostureSequence mean;
  if (sequences.empty()) return mean;
  mean.values.resize(sequences[0].values.rows(), sequences[0].frames());
  parallel_for(static_cast<std::size_t>(mean.frames()), threads, [&](std::size_t frame) {
    const auto t = static_cast<Eigen::Index>(frame);
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(sequences.size()));
    for (Eigen::Index i = 0; i < mean.limbs(); ++i) {
      for (std::size_t m = 0; m < sequences.size(); ++m)
        points.col(static_cast<Eigen::Index>(m)) = sequences[m].at(t).col(i);
      mean.at(t).col(i) = sphere_mean(points);
    }
  });
  return mean;
}

double sequence_distance(const PostureSequence& a, const PostureSequence& b) {
  const Eigen::Index count = a.values.size() / 3;
  const Eigen::Map<const Eigen::Matrix3Xd> y(a.values.data(), 3, count);
  const Eigen::Map<const Eigen::Matrix3Xd> z(b.values.data(), 3, count);
  double sum = 0;
  for (Eigen::Index i = 0; i < count; ++i) sum += sphere_distance(y.col(i), z.col(i));
  return sum / static_cast<double>(a.frames());
}

Posture posture_at(const PostureSequence& sequence, double time) {
  const double last = static_cast<double>(sequence.frames() - 1);
  const double inside = std::min(std::max(time, 0.0), last);
  const auto t = std::min(static_cast<Eigen::Index>(inside), sequence.frames() - 1);
  const double part = inside - static_cast<double>(t);
  if (part == 0 || t + 1 == sequence.frames()) return sequence.at(t);
  return posture_exp(sequence.at(t), part * posture_log(sequence.at(t), sequence.at(t + 1)));
}

PostureSequence read_at(const PostureSequence& sequence, const Eigen::VectorXd& times) {
  PostureSequence read;
  read.values.resize(sequence.values.rows(), times.size());
  for (Eigen::Index t = 0; t < times.size(); ++t) read.at(t) = posture_at(sequence, times[t]);
  return read;
}

PostureSequence normalised(const PostureSequence& sequence, Eigen::Index frames) {
  if (sequence.frames() < 2)
    throw DataError(in_file("motion"),
                    "a clip of one frame has no time to normalise; leave it out");
  if (frames < 2) throw UsageError("an aligned sequence needs 2 frames or more");
  return read_at(sequence,
                 Eigen::VectorXd::LinSpaced(frames, 0, static_cast<double>(sequence.frames() - 1)));
}

}  // namespace mocaplm
