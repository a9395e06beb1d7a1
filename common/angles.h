// The circle's constants.
#pragma once

namespace mocaplm {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTurn = 2 * kPi;
inline constexpr double kDegrees = 180 / kPi;  // a radian in degrees
inline constexpr double kRadians = kPi / 180;  // a degree in radians

}  // namespace mocaplm
