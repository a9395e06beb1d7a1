// The functions that a trajectory is expanded in, after Lippi, Avizzano and Ruffaldi 2012, "A
// method for digital representation of human movements", equations 2 to 4 and 8:
//   Phi(tau) = [1, tau, sin(pi tau), sin(2 pi tau), ..., sin(N pi tau)],  tau = t / T in [0, 1]
// The first two make the straight line between the ends; the sines, whose first has period 2, the
// rest, which is 0 at both ends but may have any slope there.
#pragma once

#include <Eigen/Core>

namespace mocaplm {

class Basis {
 public:
  explicit Basis(int harmonics) : harmonics_(harmonics) {}

  int harmonics() const { return harmonics_; }          // N
  Eigen::Index size() const { return harmonics_ + 2; }  // M = N + 2
  // (M): Phi, dPhi / dtau and d^2 Phi / dtau^2.
  Eigen::VectorXd at(double tau) const;
  Eigen::VectorXd derivative(double tau) const;
  Eigen::VectorXd second(double tau) const;
  // (samples, M): Phi' at tau = 0, 1 / (samples - 1), ..., 1.
  Eigen::MatrixXd table(Eigen::Index samples) const;

 private:
  int harmonics_;
};

// The values (n, V) of a movement at rising times (n), at `samples` places that divide its time
// evenly: cubic Hermite interpolation, the slope at a sample from the parabola through it and its
// neighbours. n >= 2; exact for parabolas.
Eigen::MatrixXd resample(const Eigen::VectorXd& time, const Eigen::MatrixXd& values,
                         Eigen::Index samples);

// Coefficients of the basis for movements sampled evenly.
class Expansion {
 public:
  // samples >= harmonics + 2.
  Expansion(int harmonics, Eigen::Index samples);
  const Basis& basis() const { return basis_; }
  Eigen::Index samples() const { return table_.rows(); }

  // values (samples, V) to coefficients (M, V). The line goes through the ends; what is left,
  // D (equation 3), is continued as an odd function of period 2 (equation 4) and its sine series
  // is cut off after N. On this grid that is the least squares fit of the sines.
  Eigen::MatrixXd coefficients(const Eigen::MatrixXd& values) const;
  // coefficients (M, V) to values (samples, V), equation 8.
  Eigen::MatrixXd values(const Eigen::MatrixXd& coefficients) const {
    return table_ * coefficients;
  }

 private:
  Basis basis_;
  Eigen::MatrixXd table_;      // (samples, M)
  Eigen::MatrixXd transform_;  // (N, samples - 2): the sine transform of the inner samples
};

}  // namespace mocaplm
