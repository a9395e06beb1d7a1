#include "spectral/index.h"

#include <cstring>

#include "common/error.h"
#include "spectral/index_layout.h"

namespace mocaplm {

namespace {

// What single precision may take from a row's square or its coordinates' squares. Without it a row
// that lies nearly inside the sketch's space would get a length of 0 where it has one of 0.001.
constexpr float kSquareRounding = 3e-6f;

// The JSON at the file's end; throws DataError unless the file is an index.
Json read_head(const MappedFile& file, const std::string& place, std::size_t& json_at) {
  std::uint64_t head[2] = {0, 0};
  if (file.size() >= kIndexRows) std::memcpy(head, file.data() + kIndexHead, sizeof head);
  if (file.size() < kIndexRows || std::memcmp(file.data(), kIndexMagic, sizeof kIndexMagic) != 0)
    throw DataError(in_file(place), "is not an index that 'mocaplm query' wrote");
  if (head[0] < kIndexRows || head[0] > file.size() || head[1] != file.size() - head[0])
    throw DataError(in_file(place), "is cut off: remove it, and it will be built again");
  json_at = head[0];
  return parse_json(std::string(file.data() + head[0], head[1]), place);
}

Eigen::MatrixXf matrix_at(const char* data, std::size_t& at, Eigen::Index rows, Eigen::Index cols) {
  const auto* values = reinterpret_cast<const float*>(data + at);
  at += sizeof(float) * static_cast<std::size_t>(rows * cols);
  return Eigen::Map<const Eigen::MatrixXf>(values, rows, cols);
}

}  // namespace

SpectralIndex::SpectralIndex(const std::filesystem::path& path)
    : file_(std::make_shared<MappedFile>(path)) {
  const std::string place = path.string();
  std::size_t json_at = 0;
  JsonObject json(read_head(*file_, place, json_at), place);
  JsonObject settings = json.object("settings");
  read_settings(config_, settings);
  settings.finish();
  n_ = json.integer("windows", 0, static_cast<std::int64_t>(file_->size()));
  d_ = json.integer("dimensions", 1, std::int64_t{1} << 24);
  s_ = json.integer("sketch", 0, kSketch);
  clips_ = json.texts("clips");
  too_short_ = json.integer("too_short", 0);
  fingerprint_ = json.text("dataset");
  json.finish();

  const Eigen::Index channels = 3 * static_cast<Eigen::Index>(config_joints(config_).size());
  features_ = std::make_shared<FeatureMaker>(config_, channels);
  const IndexLayout layout = index_layout(config_, features_->raw_dimensions(), n_, d_, s_);
  if (features_->dimensions() != d_ || s_ != sketch_size(d_) || layout.json != json_at)
    throw DataError(in_file(place),
                    "has another size than its settings say: remove it, and it "
                    "will be built again");
  rows_ = kIndexRows;
  sketch_ = layout.sketch;
  coarse_ = layout.coarse;
  lengths_ = layout.lengths;
  windows_ = layout.windows;
  std::size_t at = layout.learned;
  FeatureMaker::Learned learned;
  const char* data = file_->data();
  learned.time_mean = matrix_at(data, at, layout.time_frames, 1);
  learned.time_basis = matrix_at(data, at, layout.time_components, layout.time_frames);
  learned.reduce_mean = matrix_at(data, at, layout.reduce_from, 1);
  learned.reduce_basis = matrix_at(data, at, layout.reduce_from, config_.reduce);
  features_->set_learned(std::move(learned), place);
  basis_ = matrix_at(data, at, s_ > 0 ? d_ : 0, s_ > 0 ? s_ - 1 : 0);
  for (Eigen::Index i = 0; i < n_; ++i)
    if (window(i).clip >= clips_.size())
      throw DataError(in_file(place), "names a clip that it does not have: remove it");
}

MotionWindow SpectralIndex::window(Eigen::Index row) const {
  MotionWindow found;
  std::memcpy(&found, file_->data() + windows_ + sizeof found * static_cast<std::size_t>(row),
              sizeof found);
  return found;
}

Series SpectralIndex::sketch_of(const Series& rows) const {
  return make_sketch(rows, basis_);
}

Eigen::VectorXf normalise_rows(Series& rows) {
  Eigen::VectorXf lengths = rows.rowwise().norm();
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    if (lengths[i] > 0) rows.row(i) /= lengths[i];
  return lengths;
}

Series make_sketch(const Series& rows, const Eigen::MatrixXf& basis) {
  Series sketch(rows.rows(), basis.cols() + 1);
  sketch.leftCols(basis.cols()).noalias() = rows * basis;
  sketch.rightCols(1) =
      ((rows.rowwise().squaredNorm() - sketch.leftCols(basis.cols()).rowwise().squaredNorm())
           .cwiseMax(0)
           .array() +
       kSquareRounding)
          .sqrt()
          .matrix();
  return sketch;
}

Series make_coarse(const Series& sketch) {
  Series coarse(sketch.rows(), kCoarse);
  coarse.leftCols(kCoarse - 1) = sketch.leftCols(kCoarse - 1);
  coarse.rightCols(1) = sketch.rightCols(sketch.cols() - kCoarse + 1).rowwise().norm();
  return coarse;
}

}  // namespace mocaplm
