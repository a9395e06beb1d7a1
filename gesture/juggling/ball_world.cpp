#include "gesture/juggling/ball_world.h"

namespace mocaplm {

BallWorld::BallWorld(const JuggleConfig& config)
    : rate_(config.rate),
      gravity_(config.gravity),
      threshold_(config.toss_threshold),
      radius_(config.hand_radius),
      estimator_(kHandWindow) {}

Eigen::Vector2d BallWorld::ball_in(double seconds) const {
  return ball_ + velocity_ * seconds + Eigen::Vector2d(0, -0.5 * gravity_ * seconds * seconds);
}

std::string BallWorld::step(const Eigen::Vector2d& hand, bool tossing, bool catching) {
  ++steps_;
  hand_ = estimator_.push(time(), hand);
  if (held_) {
    ball_ = hand;
    velocity_ = hand_.velocity;
    if (!tossing || hand_.acceleration.y() >= -threshold_) return "";
    held_ = false;
    return "toss";
  }
  ball_ = ball_in(1 / rate_);
  velocity_.y() -= gravity_ / rate_;
  if (catching && (ball_ - hand).norm() < radius_) {
    held_ = true;
    return "catch";
  }
  return ball_.y() < -0.6 ? "drop" : "";
}

}  // namespace mocaplm
