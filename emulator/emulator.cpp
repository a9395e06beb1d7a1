#include "emulator/emulator.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "common/angles.h"
#include "common/parallel.h"
#include "emulator/coefficients.h"
#include "emulator/reduction.h"
#include "emulator/representation.h"
#include "emulator/var.h"

namespace mocaplm {

namespace {

void check_same_shape(const std::vector<PostureSequence>& sequences) {
  if (sequences.size() < kFewestMotions)
    throw DataError(in_file("motions"),
                    std::to_string(sequences.size()) + " to fit to; a scheme needs " +
                        std::to_string(kFewestMotions) + " or more of one class");
  for (std::size_t m = 0; m < sequences.size(); ++m) {
    check_sequence(sequences[m], in_file("motion " + std::to_string(m)));
    if (sequences[m].limbs() != sequences[0].limbs() ||
        sequences[m].frames() != sequences[0].frames())
      throw UsageError("motions to fit to must be aligned: the same limbs and frames");
  }
  if (sequences[0].frames() < 2)
    throw DataError(in_file("motions"), "of one frame: there is no motion to emulate");
}

// Two schemes' common ground: curves in the tangent space of a reference posture.
class FlatEmulator : public Emulator {
 public:
  FlatEmulator(Scheme scheme, Posture reference, std::unique_ptr<Reduction> reduction)
      : scheme_(std::move(scheme)),
        representation_(parse_representation(scheme_.representation)),
        reference_(std::move(reference)),
        reduction_(std::move(reduction)) {}

  const Scheme& scheme() const override { return scheme_; }
  Eigen::Index frames() const override { return reduction_->frames(); }
  Eigen::Index limbs() const override { return reference_.cols(); }
  Eigen::Index d1() const override { return reduction_->d1(); }
  Eigen::Index d2() const override { return reduction_->d2(); }

  PostureSequence reconstruct(const PostureSequence& sequence, Eigen::Index d1,
                              Eigen::Index d2) const override {
    if (d1 > this->d1() || d2 > this->d2() || d1 < 0 || d2 < 0)
      throw UsageError("reconstruction from " + std::to_string(d1) + " x " + std::to_string(d2) +
                       " components, fitted were " + std::to_string(this->d1()) + " x " +
                       std::to_string(this->d2()));
    return unfold(
        matrix_of(sequence).topLeftCorner(d1 == 0 ? this->d1() : d1, d2 == 0 ? this->d2() : d2));
  }

  Eigen::VectorXd coefficients(const PostureSequence& sequence) const override {
    const Eigen::MatrixXd all = matrix_of(sequence);
    return Eigen::Map<const Eigen::VectorXd>(all.data(), all.size());
  }

 protected:
  Eigen::MatrixXd matrix_of(const PostureSequence& sequence) const {
    if (sequence.limbs() != limbs() || sequence.frames() != frames())
      throw UsageError("a motion of other limbs or frames than the emulator's: align it first");
    return reduction_->project(flatten(sequence, representation_, reference_));
  }
  PostureSequence unfold(const Eigen::MatrixXd& coefficients) const {
    return unflatten(reduction_->restore(coefficients), representation_, reference_);
  }
  Json flat_json() const {
    return {{"scheme", to_string(scheme_)},
            {"reference", matrix_json(reference_)},
            {"reduction", reduction_->json()}};
  }

 private:
  Scheme scheme_;
  Representation representation_;
  Posture reference_;
  std::unique_ptr<Reduction> reduction_;
};

class CoefficientEmulator : public FlatEmulator {
 public:
  CoefficientEmulator(Scheme scheme, Posture reference, std::unique_ptr<Reduction> reduction,
                      std::unique_ptr<CoefficientModel> model)
      : FlatEmulator(std::move(scheme), std::move(reference), std::move(reduction)),
        model_(std::move(model)) {}

  std::vector<PostureSequence> sample(std::size_t count, std::uint64_t seed) const override {
    Random random(seed);
    std::vector<PostureSequence> samples;
    const Eigen::MatrixXd drawn = model_->sample(static_cast<Eigen::Index>(count), random);
    for (Eigen::Index k = 0; k < drawn.rows(); ++k) {
      const Eigen::VectorXd one = drawn.row(k).transpose();
      samples.push_back(unfold(Eigen::Map<const Eigen::MatrixXd>(one.data(), d1(), d2())));
    }
    return samples;
  }
  double log_likelihood(const PostureSequence& sequence) const override {
    return model_->log_density(coefficients(sequence));
  }
  Json json() const override {
    Json json = flat_json();
    json["model"] = model_->json();
    return json;
  }

 private:
  std::unique_ptr<CoefficientModel> model_;
};

class VarEmulator : public FlatEmulator {
 public:
  VarEmulator(Scheme scheme, Posture reference, std::unique_ptr<Reduction> reduction,
              VectorAutoregression var)
      : FlatEmulator(std::move(scheme), std::move(reference), std::move(reduction)),
        var_(std::move(var)) {}

  std::vector<PostureSequence> sample(std::size_t count, std::uint64_t seed) const override {
    Random random(seed);
    std::vector<PostureSequence> samples;
    for (std::size_t k = 0; k < count; ++k)
      samples.push_back(unfold(var_.sample(frames(), random)));
    return samples;
  }
  double log_likelihood(const PostureSequence& sequence) const override {
    return var_.log_likelihood(matrix_of(sequence));
  }
  Json json() const override {
    Json json = flat_json();
    json["model"] = var_json(var_);
    return json;
  }

 private:
  VectorAutoregression var_;
};

// Independent Gaussians at each frame in the tangent space of its mean (section 4.3.3, equation 6).
class PwiEmulator : public Emulator {
 public:
  PwiEmulator(PostureSequence mean, std::vector<Eigen::MatrixXd> factors)
      : mean_(std::move(mean)), factors_(std::move(factors)) {}

  const Scheme& scheme() const override {
    static const Scheme pwi{"PWI", "", ""};
    return pwi;
  }
  Eigen::Index frames() const override { return mean_.frames(); }
  Eigen::Index limbs() const override { return mean_.limbs(); }
  Eigen::Index d1() const override { return 0; }
  Eigen::Index d2() const override { return 0; }

  std::vector<PostureSequence> sample(std::size_t count, std::uint64_t seed) const override {
    Random random(seed);
    std::vector<PostureSequence> samples(count, mean_);
    Eigen::VectorXd z(2 * limbs());
    for (PostureSequence& sample : samples)
      for (Eigen::Index t = 0; t < frames(); ++t) {
        for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = random.normal();
        const Eigen::VectorXd v = factor(t).triangularView<Eigen::Lower>() * z;
        sample.at(t) = posture_exp(mean_.at(t), tangent_vector(v, mean_.at(t)));
      }
    return samples;
  }

  PostureSequence reconstruct(const PostureSequence& sequence, Eigen::Index d1,
                              Eigen::Index d2) const override {
    if (d1 != 0 || d2 != 0) throw UsageError("PWI has no components to reconstruct from");
    return sequence;
  }

  Eigen::VectorXd coefficients(const PostureSequence& sequence) const override {
    if (sequence.limbs() != limbs() || sequence.frames() != frames())
      throw UsageError("a motion of other limbs or frames than the emulator's: align it first");
    Eigen::MatrixXd all(2 * limbs(), frames());
    for (Eigen::Index t = 0; t < frames(); ++t)
      all.col(t) = tangent_coordinates(posture_log(mean_.at(t), sequence.at(t)), mean_.at(t));
    return Eigen::Map<const Eigen::VectorXd>(all.data(), all.size());
  }

  double log_likelihood(const PostureSequence& sequence) const override {
    const Eigen::VectorXd all = coefficients(sequence);
    const Eigen::Index d = 2 * limbs();
    double sum = -0.5 * static_cast<double>(all.size()) * std::log(2 * kPi);
    for (Eigen::Index t = 0; t < frames(); ++t) {
      Eigen::VectorXd v = all.segment(t * d, d);
      factor(t).triangularView<Eigen::Lower>().solveInPlace(v);
      sum -= 0.5 * v.squaredNorm() + factor(t).diagonal().array().log().sum();
    }
    return sum;
  }

  Json json() const override {
    Json factors = Json::array();
    for (const Eigen::MatrixXd& each : factors_) factors.push_back(matrix_json(each));
    return {{"scheme", "PWI"}, {"mean", matrix_json(mean_.values)}, {"factors", factors}};
  }

 private:
  const Eigen::MatrixXd& factor(Eigen::Index t) const {
    return factors_[static_cast<std::size_t>(t)];
  }

  PostureSequence mean_;
  std::vector<Eigen::MatrixXd> factors_;  // (2 L, 2 L) lower, of each frame's covariance
};

std::unique_ptr<Emulator> fit_pwi(const std::vector<PostureSequence>& sequences, double shrinkage,
                                  int threads) {
  PostureSequence mean = mean_sequence(sequences, threads);
  std::vector<Eigen::MatrixXd> factors(static_cast<std::size_t>(mean.frames()));
  parallel_for(factors.size(), threads, [&](std::size_t frame) {
    const auto t = static_cast<Eigen::Index>(frame);
    Eigen::MatrixXd away(static_cast<Eigen::Index>(sequences.size()), 2 * mean.limbs());
    for (std::size_t m = 0; m < sequences.size(); ++m)
      away.row(static_cast<Eigen::Index>(m)) =
          tangent_coordinates(posture_log(mean.at(t), sequences[m].at(t)), mean.at(t)).transpose();
    factors[frame] = shrunk_covariance(away, shrinkage).llt().matrixL();
  });
  return std::make_unique<PwiEmulator>(std::move(mean), std::move(factors));
}

}  // namespace

std::unique_ptr<Emulator> fit_emulator(const std::vector<PostureSequence>& sequences,
                                       const Scheme& scheme, const SchemeOptions& options,
                                       int threads) {
  check_same_shape(sequences);
  parse_scheme(to_string(scheme));
  if (scheme.representation == "PWI") return fit_pwi(sequences, options.shrinkage, threads);
  // 4,000 postures say where the middle is.
  Posture reference = mean_posture(sequences, 4000);
  const Representation representation = parse_representation(scheme.representation);
  std::vector<Eigen::MatrixXd> flats(sequences.size());
  parallel_for(flats.size(), threads,
               [&](std::size_t m) { flats[m] = flatten(sequences[m], representation, reference); });
  std::unique_ptr<Reduction> reduction =
      fit_reduction(scheme.reduction, flats,
                    {options.d1, options.d2, options.variance1, options.variance2}, threads);
  std::vector<Eigen::MatrixXd> coefficients;
  for (const Eigen::MatrixXd& flat : flats) coefficients.push_back(reduction->project(flat));
  if (scheme.model == "VAR") {
    VectorAutoregression var = fit_var(coefficients, options.order);
    return std::make_unique<VarEmulator>(scheme, std::move(reference), std::move(reduction),
                                         std::move(var));
  }
  Eigen::MatrixXd samples(static_cast<Eigen::Index>(flats.size()), coefficients[0].size());
  for (std::size_t m = 0; m < flats.size(); ++m)
    samples.row(static_cast<Eigen::Index>(m)) =
        Eigen::Map<const Eigen::RowVectorXd>(coefficients[m].data(), coefficients[m].size());
  auto model = fit_coefficients(scheme.model, samples, options);
  return std::make_unique<CoefficientEmulator>(scheme, std::move(reference), std::move(reduction),
                                               std::move(model));
}

namespace {

Posture read_posture(JsonObject& object, const std::string& key) {
  PostureSequence one;
  const Eigen::MatrixXd matrix = read_matrix(object, key, 3, -1);
  one.values = Eigen::Map<const Eigen::VectorXd>(matrix.data(), matrix.size());
  check_sequence(one, in_file(object.place() + ": \"" + key + "\""));
  return matrix;
}

std::unique_ptr<Emulator> read_pwi(JsonObject& object) {
  PostureSequence mean;
  mean.values = read_matrix(object, "mean", -1, -1);
  if (mean.values.rows() % 3 != 0) object.fail("mean", "expected three rows for each limb");
  check_sequence(mean, in_file(object.place() + ": \"mean\""));
  const Json& list = object.raw("factors");
  if (!list.is_array() || static_cast<Eigen::Index>(list.size()) != mean.frames())
    object.fail("factors", "expected a list of a matrix for each frame");
  std::vector<Eigen::MatrixXd> factors;
  for (const Json& item : list) {
    const Json one = {{"factor", item}};
    JsonObject each(one, object.place() + ": factors");
    factors.push_back(read_matrix(each, "factor", 2 * mean.limbs(), 2 * mean.limbs()));
    if (factors.back().diagonal().minCoeff() <= 0)
      object.fail("factors", "expected positive diagonals");
  }
  object.finish();
  return std::make_unique<PwiEmulator>(std::move(mean), std::move(factors));
}

}  // namespace

std::unique_ptr<Emulator> read_emulator(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  const std::string name = object.text("scheme");
  Scheme scheme;
  try {
    scheme = parse_scheme(name);
  } catch (const UsageError& error) {
    object.fail("scheme", error.what());
  }
  if (scheme.representation == "PWI") return read_pwi(object);
  Posture reference = read_posture(object, "reference");
  auto reduction = read_reduction(object.raw("reduction"), place + ": \"reduction\"");
  const Json& model = object.raw("model");
  object.finish();
  const std::string model_place = place + ": \"model\"";
  if (reduction->coordinates() != 2 * reference.cols())
    object.fail("reduction", "is of " + std::to_string(reduction->coordinates()) +
                                 " coordinates, expected two for each limb of the reference");
  if (scheme.model == "VAR") {
    VectorAutoregression var = read_var(model, model_place);
    if (var.dimensions() != reduction->d1() || var.order() >= reduction->frames())
      object.fail("model", "is of other components or frames than the reduction");
    return std::make_unique<VarEmulator>(scheme, std::move(reference), std::move(reduction),
                                         std::move(var));
  }
  auto coefficients = read_coefficients(model, model_place);
  if (coefficients->dimensions() != reduction->d1() * reduction->d2())
    object.fail("model", "is of " + std::to_string(coefficients->dimensions()) +
                             " coefficients, expected d1 x d2 of the reduction");
  return std::make_unique<CoefficientEmulator>(scheme, std::move(reference), std::move(reduction),
                                               std::move(coefficients));
}

}  // namespace mocaplm
