// Continues a motion with a trained model, and says how far the dancer got:
//   continue_dance MODEL CLIP SECONDS OUT.bvh
// CLIP is a motion file, of a part FILE:from-to or FILE#PART. OUT holds it and SECONDS more.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "common/error.h"
#include "generate/generator.h"
#include "model/directory.h"
#include "motion/formats/formats.h"
#include "motion/inputs.h"

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: continue_dance MODEL CLIP SECONDS OUT.bvh\n");
    return 2;
  }
  try {
    const std::string folder = mocaplm::resolve_model(argv[1]).string();
    mocaplm::Generator generator(mocaplm::load_model(argv[1]), folder);

    mocaplm::GenerateRequest request;
    request.prompt = mocaplm::read_one_motion(argv[2]);
    request.seconds = std::atof(argv[3]);  // 0 of what is no number, which is refused
    request.sampling.seed = 1;
    const mocaplm::Clip dance = generator.generate(request).clip;

    mocaplm::write_clip(argv[4], dance);
    const double metres = (dance.trans.row(dance.frames() - 1) - dance.trans.row(0)).norm();
    std::printf("%s: %.1f s, %.2f m from the start\n", argv[4], dance.seconds(), metres);
    return 0;
  } catch (const mocaplm::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
