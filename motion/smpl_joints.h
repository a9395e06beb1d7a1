// Some of SMPL's joints by name; what lies on the right is the number after the left one's.
#pragma once

namespace mocaplm {

inline constexpr int kPelvis = 0, kLeftHip = 1, kRightHip = 2, kSpine1 = 3, kLeftKnee = 4,
                     kSpine2 = 6, kLeftAnkle = 7, kSpine3 = 9, kLeftFoot = 10, kRightFoot = 11,
                     kNeck = 12, kLeftCollar = 13, kRightCollar = 14, kHead = 15,
                     kLeftShoulder = 16, kRightShoulder = 17;

}  // namespace mocaplm
