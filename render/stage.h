// A clip's figure on its ground before a camera.
#pragma once

#include <vector>

#include "motion/clip.h"
#include "render/camera.h"
#include "render/config.h"
#include "render/ground.h"
#include "render/picture.h"

namespace mocaplm {

class Stage {
 public:
  // The floor lies at height 0. The camera stands so that the whole way is in the picture, or, with
  // `follow`, close by and going along.
  Stage(Clip clip, const RenderConfig& config);

  Eigen::Index frames() const { return clip_.frames(); }
  Camera camera(Eigen::Index frame) const;

  // One frame. May be called from several threads.
  Picture frame(Eigen::Index frame) const;
  // Several frames in one picture from the camera of the first, the later the stronger in colour.
  Picture poses(const std::vector<Eigen::Index>& frames) const;

 private:
  Box whole_way() const;
  Picture draw(const std::vector<Eigen::Index>& frames, const Camera& camera,
               Picture picture) const;

  RenderConfig config_;
  Clip clip_;
  Translations followed_;  // the pelvis's way over the floor, smoothed, from the first frame
  Camera first_camera_;
  Ground ground_;
  Picture empty_;  // what first_camera_ sees without a figure
};

}  // namespace mocaplm
