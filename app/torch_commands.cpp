// Hidden commands of mocaplm-torch, which the light program asks: about, declarations, measure.
// Each prints one line of JSON.
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/declarations.h"
#include "app/version.h"
#include "common/settings.h"
#include "train/machine.h"

namespace mocaplm {

namespace {

std::string torch_line(const TrainingLibrary& library) {
  std::string line = "LibTorch: " + library.version;
  if (!library.cuda)
    line += ", without CUDA";
  else
    line += ", with CUDA, " + std::to_string(library.cuda_devices) +
            (library.cuda_devices == 1 ? " device" : " devices");
  return line + "; training on the processor: " +
         (library.kernels ? "kernels for AVX-512 with BF16" : "LibTorch's operations");
}

void print(const Json& json) {
  std::printf("%s\n", json.dump().c_str());
}

Json speed_json(const MachineSpeed& speed) {
  return {{"device", speed.device},
          {"precision", speed.precision},
          {"f32_product_flops", speed.products},
          {"parameters", speed.training.parameters},
          {"seconds_a_step", speed.training.seconds_a_step},
          {"tokens_per_second", speed.training.tokens_per_second},
          {"training_flops", speed.training.flops()},
          {"parameters_in_an_hour", parameters_for(speed.training.flops(), 3600)}};
}

}  // namespace

std::string version_text() {
  return "mocaplm " MOCAPLM_VERSION "\n" + torch_line(training_library());
}

void add_torch_commands(CLI::App& app) {
  CLI::App* about = app.add_subcommand("about", "this part, for mocaplm --version")->group("");
  about->callback([] {
    const TrainingLibrary library = training_library();
    print({{"line", torch_line(library)},
           {"version", library.version},
           {"cuda", library.cuda},
           {"cuda_devices", library.cuda_devices},
           {"threads", library.threads},
           {"kernels", library.kernels}});
  });
  CLI::App* declared =
      app.add_subcommand("declarations", "these commands, for mocaplm completion")->group("");
  declared->callback([&app] { print(to_json(declarations(app))); });
  struct Measure {
    std::string device = "auto";
    int threads = 0;
    double seconds = 8;
  };
  const auto measure = std::make_shared<Measure>();
  CLI::App* speed = app.add_subcommand("measure", "the speed, for mocaplm doctor")->group("");
  speed->add_option("--device", measure->device, "where to compute");
  speed->add_option("--threads", measure->threads, "threads, 0 for all cores");
  speed->add_option("--seconds", measure->seconds, "time for it")->check(CLI::Range(0.1, 600.0));
  speed->callback([measure] {
    print(speed_json(measure_training(measure->device, measure->threads, measure->seconds)));
  });
}

}  // namespace mocaplm
