// Ways through a file's tree, and its spine in SMPL's terms.
#include <algorithm>
#include <cmath>

#include "motion/formats/recognise.h"

namespace mocaplm {

std::vector<int> path_down(const Bvh& bvh, int ancestor, int joint) {
  std::vector<int> path;
  for (; joint >= 0 && joint != ancestor;
       joint = bvh.joints[static_cast<std::size_t>(joint)].parent)
    path.push_back(joint);
  if (joint != ancestor) return {};
  std::reverse(path.begin(), path.end());
  return path;
}

bool is_below(const Bvh& bvh, int joint, int above) {
  for (; joint >= 0; joint = bvh.joints[static_cast<std::size_t>(joint)].parent)
    if (joint == above) return true;
  return false;
}

int common_ancestor(const Bvh& bvh, int a, int b) {
  // A parent's index is smaller than its children's.
  while (a != b && a >= 0 && b >= 0)
    if (a > b)
      a = bvh.joints[static_cast<std::size_t>(a)].parent;
    else
      b = bvh.joints[static_cast<std::size_t>(b)].parent;
  return std::min(a, b);
}

void assign_spine(const std::vector<int>& spine, const std::vector<double>& heights,
                  std::array<int, kJoints>& joints) {
  joints[3] = joints[6] = joints[9] = -1;
  if (spine.empty()) return;
  joints[9] = spine.back();
  if (spine.size() == 2) joints[6] = spine[0];
  if (spine.size() < 3) return;
  joints[3] = spine.front();
  const double middle = 0.5 * (heights.front() + heights.back());
  std::size_t best = 1;
  for (std::size_t i = 1; i + 1 < spine.size(); ++i)
    if (std::abs(heights[i] - middle) < std::abs(heights[best] - middle)) best = i;
  joints[6] = spine[best];
}

}  // namespace mocaplm
