// Results that are kept frame by frame, as PHALP (4D-Humans' tracker) and ROMP write them: a
// dictionary of frames, each with lists of the people who are seen in it.
#pragma once

#include <string>
#include <vector>

#include "motion/formats/array_dict.h"
#include "motion/formats/smpl_record.h"

namespace mocaplm {

struct TrackedPerson {
  std::string name;  // the track's number
  SmplRecord record;
};

// One person for each track, frames in the order of their names; in the camera's space. Nobody for
// dictionaries of another kind.
//   PHALP: {frame: {tid: [...], smpl: [{global_orient (1, 3, 3), body_pose (23, 3, 3), betas}],
//   camera:
//   [(3,)]}}
//   ROMP: {frame: {smpl_thetas (P, 72), cam_trans (P, 3), smpl_betas (P, 10), track_ids (P,)}},
//   also under `results`
std::vector<TrackedPerson> read_frames_of_people(const ArrayDict& dict);

}  // namespace mocaplm
