// Motion in SMPL's rotations from whatever keeps it: AMASS's and other .npz files, pickles of
// AIST++, EDGE, WHAM, VIBE, DART, 4D-Humans (PHALP), .npy dictionaries of TRAM, .pt files of GVHMR.
// See smpl_record.h for the keys, array_dict.h for the files.
#pragma once

#include <filesystem>
#include <vector>

#include "motion/formats/formats.h"

namespace mocaplm {

// One motion a person; several are named "STEM_PERSON" by the keys they lie under, a single one by
// the file's stem. `options.part` chooses one by its key. Of GVHMR's two views of a person the one
// in the world is read. The clips carry the file's betas and gender, and with `options.body` the
// joints of their shape. Rotations are the file's bit for bit where they are vectors and the world
// is not turned. Throws DataError for files in which no person's motion is found, naming what they
// hold, and as decide_up and check_clip do; for files without a frame rate whose program has no
// usual one.
std::vector<ReadMotion> read_smpl_file(const std::filesystem::path& path,
                                       const ReadOptions& options = {});

}  // namespace mocaplm
