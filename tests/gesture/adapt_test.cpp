#include "gesture/adapt.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "gesture/made_up.h"
#include "support/refusal.h"

namespace mocaplm::adapt_test {
namespace {

const Boundary kBoundary = boundary_between({0.2, -0.4}, {2.3, 0.6}, 0.8);

PhaseModel made_up_model(const std::vector<std::string>& conditions = {"start", "end"}) {
  GestureConfig config = made_up_config();
  config.conditions = conditions;
  return fit_gesture(made_up_movements(11, 40, 0.1).recordings, config).phases[0];
}

double end_speed(const Eigen::MatrixXd& p, Eigen::Index v, double duration) {
  return Basis(4).derivative(1).dot(p.col(v)) / duration;
}

// How far a change of P is from any movement of the hyperplane with the start where it is.
double off_plane(const PhaseModel& model, const Eigen::VectorXd& change, Eigen::Index v,
                 Eigen::Index from, Eigen::Index count) {
  const Eigen::MatrixXd directions = model.plane(v).middleCols(from, count);
  const Eigen::VectorXd q = directions.completeOrthogonalDecomposition().solve(change);
  return (directions * q - change).norm();
}

TEST(EndVelocity, IsMetAndLiesOnTheHyperplane) {
  const PhaseModel model = made_up_model();
  const Eigen::MatrixXd p = model.coefficients(kBoundary);
  for (const EndVelocity kind :
       {EndVelocity::hyperplane, EndVelocity::closest, EndVelocity::free}) {
    const Eigen::MatrixXd out = with_end_velocity(model, p, {std::nullopt, -0.35}, 0.8, kind);
    EXPECT_NEAR(end_speed(out, 1, 0.8), -0.35, 1e-9);
    EXPECT_EQ(out.col(0), p.col(0)) << "x was not asked for";
    EXPECT_EQ(out(0, 1), p(0, 1)) << "the start stays";
    const double off = off_plane(model, out.col(1) - p.col(1), 1, 2, 2);
    if (kind == EndVelocity::free)
      EXPECT_GT(off, 1e-3);
    else
      EXPECT_LT(off, 1e-9);
  }
}

// There is a Q whose movement, by equation 7, it is.
TEST(EndVelocity, IsTheMovementOfAnotherEnd) {
  const PhaseModel model = made_up_model();
  const Eigen::MatrixXd out = with_end_velocity(model, model.coefficients(kBoundary),
                                                {0.0, std::nullopt}, 0.8, EndVelocity::hyperplane);
  const Eigen::MatrixXd plane = model.plane(0);
  const Eigen::VectorXd rest = out.col(0) - plane.leftCols(2) * kBoundary.start - plane.col(4);
  const Eigen::VectorXd end = plane.middleCols(2, 2).colPivHouseholderQr().solve(rest);
  const Eigen::MatrixXd again = model.coefficients(boundary_between(kBoundary.start, end, 0.8));
  // Its second coefficient is end_x - start_x by the regression, so all of P agrees.
  EXPECT_LT((again.col(0) - out.col(0)).norm(), 1e-8);
}

// The equation as it is printed, with a pseudo-inverse of its own, where all conditions are free.
TEST(EndVelocity, IsEquationNine) {
  const PhaseModel model = made_up_model({"displacement"});
  const Eigen::MatrixXd p = model.coefficients(kBoundary);
  const Eigen::MatrixXd out =
      with_end_velocity(model, p, {1.7, -0.2}, 0.8, EndVelocity::hyperplane);
  const Eigen::RowVectorXd slope = Basis(4).derivative(1).transpose();
  for (Eigen::Index v = 0; v < 2; ++v) {
    Eigen::MatrixXd f = model.plane(v).leftCols(2);
    f.row(0).setZero();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(slope * f,
                                                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::MatrixXd inverse = svd.matrixV() *
                                    svd.singularValues().cwiseInverse().asDiagonal() *
                                    svd.matrixU().transpose();
    const double wanted = (v == 0 ? 1.7 : -0.2) * 0.8;
    const Eigen::VectorXd change =
        f * inverse * Eigen::VectorXd::Constant(1, wanted - slope.dot(p.col(v)));
    EXPECT_LT((out.col(v) - p.col(v) - change).norm(), 1e-10);
  }
}

// Each kind is the least in its own measure, against random changes that meet the speed too.
TEST(EndVelocity, EachKindIsTheLeast) {
  const PhaseModel model = made_up_model();
  const Eigen::MatrixXd p = model.coefficients(kBoundary);
  const auto change = [&](EndVelocity kind) {
    return Eigen::VectorXd(with_end_velocity(model, p, {0.5, std::nullopt}, 0.8, kind).col(0) -
                           p.col(0));
  };
  const Eigen::VectorXd plane = change(EndVelocity::hyperplane),
                        closest = change(EndVelocity::closest), free = change(EndVelocity::free);
  EXPECT_LE(free.norm(), closest.norm() + 1e-12);
  EXPECT_LE(closest.norm(), plane.norm() + 1e-12);
  const Eigen::VectorXd slope = Basis(4).derivative(1);
  const Eigen::MatrixXd directions = model.plane(0).middleCols(2, 2);
  Random random(12);
  for (int i = 0; i < 200; ++i) {
    Eigen::VectorXd q(2);
    q << random.normal(), random.normal();
    const Eigen::VectorXd other = directions * q * (slope.dot(free) / slope.dot(directions * q));
    EXPECT_GE(other.norm(), closest.norm() - 1e-9);
  }
}

TEST(EndVelocity, RefusesWhatTheHyperplaneCannot) {
  const PhaseModel model = made_up_model({"start", "duration"});
  Boundary boundary = kBoundary;
  const Eigen::MatrixXd p = model.coefficients(boundary);
  EXPECT_PRED2(contains, refusal<UsageError>([&] {
                 with_end_velocity(model, p, {0.0, 0.0}, 0.8, EndVelocity::hyperplane);
               }),
               "does not depend on the conditions start, duration");
  EXPECT_NEAR(end_speed(with_end_velocity(model, p, {0.0, 0.0}, 0.8, EndVelocity::free), 0, 0.8), 0,
              1e-9);
  EXPECT_THROW(with_end_velocity(model, p, {0.0}, 0.8, EndVelocity::free), UsageError);
}

const std::vector<Correction> kCorrections = {Correction::minimum, Correction::smooth,
                                              Correction::hyperplane};

TEST(Correction, PassesThroughTheStateAndReachesTheTarget) {
  const PhaseModel model = made_up_model();
  const Eigen::MatrixXd p = model.coefficients(kBoundary);
  const Basis basis(4);
  for (const double tau : {0.0, 0.3, 0.9})
    for (const Correction kind : kCorrections) {
      const Eigen::Vector2d state =
          p.transpose() * basis.at(tau) + (tau > 0 || kind == Correction::hyperplane
                                               ? Eigen::Vector2d(0.1, -0.2)
                                               : Eigen::Vector2d(0.05, 0));
      const Eigen::Vector2d target = p.transpose() * basis.at(1) + Eigen::Vector2d(-0.3, 0.1);
      const Eigen::MatrixXd out = corrected(model, p, tau, state, target, kind);
      EXPECT_LT((out.transpose() * basis.at(tau) - state).norm(), 1e-9) << tau;
      EXPECT_LT((out.transpose() * basis.at(1) - target).norm(), 1e-9) << tau;
    }
}

// With nothing to correct nothing changes: the past and the future stay as they are.
TEST(Correction, NothingToCorrectChangesNothing) {
  const PhaseModel model = made_up_model();
  const Eigen::MatrixXd p = model.coefficients(kBoundary);
  const Basis basis(4);
  for (const Correction kind : kCorrections)
    EXPECT_LT((corrected(model, p, 0.4, p.transpose() * basis.at(0.4), p.transpose() * basis.at(1),
                         kind) -
               p)
                  .norm(),
              1e-9);
}

// Equation 10 by its normal equations, dP = A' (A A')^-1 dY.
TEST(Correction, IsEquationTen) {
  const PhaseModel model = made_up_model();
  const Eigen::MatrixXd p = model.coefficients(kBoundary);
  const Basis basis(4);
  const Eigen::Vector2d state(0.7, 0.1), target(2.0, 0.9);
  const Eigen::MatrixXd out = corrected(model, p, 0.45, state, target, Correction::minimum);
  Eigen::MatrixXd a(2, 6);
  a << basis.at(0.45).transpose(), basis.at(1).transpose();
  for (Eigen::Index v = 0; v < 2; ++v) {
    const Eigen::Vector2d y(state(v), target(v));
    const Eigen::VectorXd change =
        a.transpose() * (a * a.transpose()).ldlt().solve(y - a * p.col(v));
    EXPECT_LT((out.col(v) - p.col(v) - change).norm(), 1e-10);
  }
}

TEST(Correction, TheKindsDifferAsTheySay) {
  const PhaseModel model = made_up_model();
  const Eigen::MatrixXd p = model.coefficients(kBoundary);
  const Basis basis(4);
  const double tau = 0.4;
  const Eigen::Vector2d state = p.transpose() * basis.at(tau) + Eigen::Vector2d(0.1, 0.05);
  const Eigen::Vector2d target = p.transpose() * basis.at(1) + Eigen::Vector2d(0.2, 0.1);
  const auto out = [&](Correction kind) { return corrected(model, p, tau, state, target, kind); };
  const Eigen::MatrixXd least = out(Correction::minimum), smooth = out(Correction::smooth),
                        plane = out(Correction::hyperplane);
  EXPECT_LE((least - p).norm(), (smooth - p).norm());
  EXPECT_LE((least - p).norm(), (plane - p).norm());
  EXPECT_LT(((smooth - p).transpose() * basis.derivative(tau)).norm(), 1e-9)
      << "the speed goes on as it was";
  for (Eigen::Index v = 0; v < 2; ++v) {
    EXPECT_LT(off_plane(model, plane.col(v) - p.col(v), v, 0, 4), 1e-9);
    EXPECT_GT(off_plane(model, least.col(v) - p.col(v), v, 0, 4), 1e-3)
        << "equation 10 does not stay on it, whatever the text says";
  }
}

TEST(Correction, ADisplacementModelMayBeMovedAsAWhole) {
  const PhaseModel model = made_up_model({"displacement"});
  const Eigen::MatrixXd p = model.coefficients(kBoundary);
  const Basis basis(4);
  const Eigen::Vector2d shift(3, -2);
  const Eigen::MatrixXd out =
      corrected(model, p, 0.5, p.transpose() * basis.at(0.5) + shift,
                p.transpose() * basis.at(1) + shift, Correction::hyperplane);
  EXPECT_LT((out.transpose() * basis.at(0.5) - p.transpose() * basis.at(0.5) - shift).norm(), 1e-9);
}

TEST(Correction, RefusesWhatComesTooLate) {
  const PhaseModel model = made_up_model();
  const Eigen::MatrixXd p = model.coefficients(kBoundary);
  for (const double tau : {1.0, -0.1, 2.0, std::nan("")})
    EXPECT_THROW(corrected(model, p, tau, kBoundary.start, *kBoundary.end, Correction::minimum),
                 UsageError);
  // One direction only: the line from start to end cannot do both.
  const PhaseModel poor = made_up_model({"duration"});
  EXPECT_PRED2(contains, refusal<UsageError>([&] {
                 corrected(poor, p, 1e-9, Eigen::Vector2d(9, 9), Eigen::Vector2d(-3, 7),
                           Correction::hyperplane);
                 corrected(poor, p, 0.0, kBoundary.start, *kBoundary.end + Eigen::Vector2d(1, 1),
                           Correction::minimum);
                 PhaseModel none = poor;
                 none.f.setZero();
                 corrected(none, p, 0.4, Eigen::Vector2d(9, 9), *kBoundary.end,
                           Correction::hyperplane);
               }),
               "hyperplane");
}

}  // namespace
}  // namespace mocaplm::adapt_test
