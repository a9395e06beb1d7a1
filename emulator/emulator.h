// A scheme fitted to aligned sequences: it emulates new ones.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/json.h"
#include "common/random.h"
#include "emulator/scheme.h"
#include "emulator/sequence.h"

namespace mocaplm {

// The fewest sequences that a scheme can be fitted to.
constexpr std::size_t kFewestMotions = 3;

class Emulator {
 public:
  virtual ~Emulator() = default;

  virtual const Scheme& scheme() const = 0;
  virtual Eigen::Index frames() const = 0;  // T of what it was fitted to and samples
  virtual Eigen::Index limbs() const = 0;
  // Components that it keeps; 0 where the scheme has none (PWI), d2 = T with SpatialPCA.
  virtual Eigen::Index d1() const = 0;
  virtual Eigen::Index d2() const = 0;

  // New sequences; the same seed gives the same.
  virtual std::vector<PostureSequence> sample(std::size_t count, std::uint64_t seed) const = 0;

  // The sequence as its components say it (equation 5's other side). d1 and d2 may be fewer than
  // the fitted ones, the first of them are kept; 0: all. Throws UsageError for more. With PWI the
  // sequence itself.
  virtual PostureSequence reconstruct(const PostureSequence& sequence, Eigen::Index d1 = 0,
                                      Eigen::Index d2 = 0) const = 0;

  // Equation 7: the natural logarithm of the model's density of the sequence's coefficients
  // (equation 7 as printed lacks two signs; this is the Gaussian density).
  virtual double log_likelihood(const PostureSequence& sequence) const = 0;

  // The coefficients (d) of a sequence that the model is a distribution of.
  virtual Eigen::VectorXd coefficients(const PostureSequence& sequence) const = 0;

  // Everything, for a file; read_emulator is the inverse.
  virtual Json json() const = 0;
};

// Fits the scheme to sequences of the same limbs and frames. Throws DataError for fewer than
// kFewestMotions, values that are not finite or sequences that are all the same; d1 and d2 larger
// than the data allows are lowered to what it does (d1() and d2() tell).
std::unique_ptr<Emulator> fit_emulator(const std::vector<PostureSequence>& sequences,
                                       const Scheme& scheme, const SchemeOptions& options,
                                       int threads = 0);

// Throws DataError naming the key where the file is not sound.
std::unique_ptr<Emulator> read_emulator(const Json& json, const std::string& place);

}  // namespace mocaplm
