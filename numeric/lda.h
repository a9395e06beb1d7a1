// Linear discriminant analysis: Gaussian classes with one covariance, which is shrunk towards a
// multiple of the identity (Friedman 1989, "Regularized discriminant analysis", with gamma only).
//   S     = within-class scatter / n
//   C     = (1 - s) S + s (tr S / d) I
//   score = x' C^-1 m_k - m_k' C^-1 m_k / 2 + log(n_k / n)
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mocaplm {

class Lda {
 public:
  // x (n, d); classes (n) in 0 .. n_classes-1; shrinkage s in [0, 1]. More dimensions than samples
  // are fine; with s = 0 the directions without any variance inside the classes are then left out
  // (pseudo-inverse). A class without samples is never predicted. Throws UsageError for a shrinkage
  // outside [0, 1] and DataError for no samples, non-finite values or no variance within classes.
  static Lda fit(const Eigen::MatrixXd& x, const std::vector<int>& classes, int n_classes,
                 double shrinkage);

  int dimensions() const { return static_cast<int>(weights_.rows()); }
  int n_classes() const { return static_cast<int>(weights_.cols()); }
  // (n, n_classes): log posteriors up to a constant of each row.
  Eigen::MatrixXd scores(const Eigen::MatrixXd& x) const;
  // The class of the largest score of each row; the first one in a tie.
  std::vector<int> predict(const Eigen::MatrixXd& x) const;

 private:
  Eigen::RowVectorXd centre_;   // (d) mean of the training data: smaller numbers round less
  Eigen::MatrixXd weights_;     // (d, n_classes)
  Eigen::RowVectorXd offsets_;  // (n_classes), -infinity without samples
};

}  // namespace mocaplm
