// Posture sequences as curves in one tangent space (section 4.1).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "emulator/sequence.h"

namespace mocaplm {

//   SIEM    W(t) = log_R(a(t)), the single inverse exponential map (definition 3)
//   S-TVF   F(t) = the velocity from t - 1 to t, transported from a(t - 1) to R in one hop (1)
//   IS-TVF  G(t) = the sum of F up to t (2)
//   M-TVF   the velocity transported back along the path to a(0), then to R, for comparison
// where R is a reference posture. All but SIEM have a(0) beside them: it is their frame 0, as
// log_R(a(0)), and IS-TVF begins there, so that it is a position like SIEM. So each is (2 L, T) and
// is its sequence, exactly.
enum class Representation { siem, s_tvf, is_tvf, m_tvf };
const std::vector<std::string>& representation_names();
// Throws UsageError with the nearest known name.
Representation parse_representation(const std::string& name);
std::string to_string(Representation representation);

// Coordinates (2 L, T) in the tangent basis at `reference` (sphere_basis of each limb), radians.
Eigen::MatrixXd flatten(const PostureSequence& sequence, Representation representation,
                        const Posture& reference);
// The inverse; also of values that no sequence had.
PostureSequence unflatten(const Eigen::MatrixXd& flat, Representation representation,
                          const Posture& reference);

// Tangent vectors (3, L) at `posture` as 2 L coordinates, and back.
Eigen::VectorXd tangent_coordinates(const PostureTangent& tangent, const Posture& posture);
PostureTangent tangent_vector(const Eigen::VectorXd& coordinates, const Posture& posture);

}  // namespace mocaplm
