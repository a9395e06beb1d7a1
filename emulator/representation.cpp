#include "emulator/representation.h"

#include <algorithm>

#include "common/text.h"
#include "emulator/sphere.h"

namespace mocaplm {

namespace {

// Transported along the path from frame t back to the first one, and then to the reference.
PostureTangent home(PostureTangent v, const PostureSequence& path, Eigen::Index t,
                    const Posture& reference) {
  for (; t > 0; --t) v = posture_transport(v, path.at(t), path.at(t - 1));
  return posture_transport(v, path.at(0), reference);
}

PostureTangent away(PostureTangent v, const PostureSequence& path, Eigen::Index t,
                    const Posture& reference) {
  v = posture_transport(v, reference, path.at(0));
  for (Eigen::Index s = 0; s < t; ++s) v = posture_transport(v, path.at(s), path.at(s + 1));
  return v;
}

}  // namespace

const std::vector<std::string>& representation_names() {
  static const std::vector<std::string> names = {"SIEM", "S-TVF", "IS-TVF", "M-TVF"};
  return names;
}

Representation parse_representation(const std::string& name) {
  const auto& names = representation_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw UsageError("unknown representation \"" + name + "\"" + known_names(name, names));
  return static_cast<Representation>(found - names.begin());
}

std::string to_string(Representation representation) {
  return representation_names()[static_cast<std::size_t>(representation)];
}

Eigen::VectorXd tangent_coordinates(const PostureTangent& tangent, const Posture& posture) {
  Eigen::VectorXd coordinates(2 * posture.cols());
  for (Eigen::Index i = 0; i < posture.cols(); ++i)
    coordinates.segment<2>(2 * i) = sphere_basis(posture.col(i)).transpose() * tangent.col(i);
  return coordinates;
}

PostureTangent tangent_vector(const Eigen::VectorXd& coordinates, const Posture& posture) {
  PostureTangent tangent(3, posture.cols());
  for (Eigen::Index i = 0; i < posture.cols(); ++i)
    tangent.col(i) = sphere_basis(posture.col(i)) * coordinates.segment<2>(2 * i);
  return tangent;
}

Eigen::MatrixXd flatten(const PostureSequence& sequence, Representation representation,
                        const Posture& reference) {
  Eigen::MatrixXd flat(2 * sequence.limbs(), sequence.frames());
  for (Eigen::Index t = 0; t < sequence.frames(); ++t) {
    if (t == 0 || representation == Representation::siem) {
      flat.col(t) = tangent_coordinates(posture_log(reference, sequence.at(t)), reference);
      continue;
    }
    const PostureTangent shot = posture_log(sequence.at(t - 1), sequence.at(t));
    flat.col(t) = tangent_coordinates(representation == Representation::m_tvf
                                          ? home(shot, sequence, t - 1, reference)
                                          : posture_transport(shot, sequence.at(t - 1), reference),
                                      reference);
    if (representation == Representation::is_tvf) flat.col(t) += flat.col(t - 1);
  }
  return flat;
}

PostureSequence unflatten(const Eigen::MatrixXd& flat, Representation representation,
                          const Posture& reference) {
  PostureSequence sequence;
  sequence.values.resize(3 * reference.cols(), flat.cols());
  for (Eigen::Index t = 0; t < flat.cols(); ++t) {
    if (t == 0 || representation == Representation::siem) {
      sequence.at(t) = posture_exp(reference, tangent_vector(flat.col(t), reference));
      continue;
    }
    const bool summed = representation == Representation::is_tvf;
    const PostureTangent shot = tangent_vector(
        summed ? Eigen::VectorXd(flat.col(t) - flat.col(t - 1)) : Eigen::VectorXd(flat.col(t)),
        reference);
    sequence.at(t) = posture_exp(sequence.at(t - 1),
                                 representation == Representation::m_tvf
                                     ? away(shot, sequence, t - 1, reference)
                                     : posture_transport(shot, reference, sequence.at(t - 1)));
  }
  return sequence;
}

}  // namespace mocaplm
