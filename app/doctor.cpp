// mocaplm doctor: what is installed, what is missing and what to do, how fast this machine is.
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/machine.h"
#include "app/options.h"
#include "app/torch_part.h"
#include "common/files.h"
#include "common/find_program.h"
#include "common/text.h"
#include "viewer/assets.h"

namespace mocaplm {

namespace {

constexpr double kTokensASecond =
    43 * 20;  // of motion: 13 joints, the root, a separator; 20 frames

struct DoctorCommand {
  std::string device = "auto", json;
  int threads = 0;
  double seconds = 8;
};

Table machine_table(const Machine& machine) {
  Table table("", {"this machine", "value"});
  table.row({"program", "mocaplm " MOCAPLM_VERSION});
  if (!machine.processor.empty()) table.row({"processor", machine.processor});
  table.row({"cores", machine.cores});
  table.row({"instructions when generating", machine.instructions});
  if (machine.memory > 0)
    table.row({"memory", format_bytes(machine.memory) + ", free " + format_bytes(machine.free)});
  if (machine.memory_limit > 0)
    table.row({"limit of this process (ulimit -v)", format_bytes(machine.memory_limit)});
  if (machine.disk > 0) table.row({"free disk here", format_bytes(machine.disk)});
  if (machine.disk > 0 && machine.disk < (std::uint64_t{1} << 30))
    table.note("Little disk is left: a training run of the default size needs 0.1 GiB.");
  return table;
}

// What there is, and what to do where it is missing.
class Parts {
 public:
  void add(const std::string& name, bool there, const std::string& found,
           const std::string& advice) {
    table_.row({name, there ? found : "missing"});
    if (!there) table_.note(name + ": " + advice);
  }
  const Table& table() const { return table_; }

 private:
  Table table_{"", {"part", "found"}};
};

Table parts_table(const TorchAnswer& torch) {
  Parts parts;
  const bool trains = torch.failure.empty();
  parts.add("LibTorch (train, classify, ...)", trains,
            trains ? torch.json.value("version", "") : "",
            torch.failure + (torch.installed
                                 ? ". Is LibTorch still where it was when this was built?"
                                 : ". Build the target mocaplm-torch (scripts/build), or copy it "
                                   "beside this program."));
  if (trains) {
    parts.add(
        "GPU", torch.json.value("cuda_devices", 0) > 0,
        std::to_string(torch.json.value("cuda_devices", 0)) + " by CUDA",
        torch.json.value("cuda", false)
            ? "this LibTorch is built for CUDA but finds no device."
            : "this LibTorch has no CUDA; MOCAPLM_TORCH=/path/to/libtorch scripts/build takes "
              "another. Small models train well without.");
    parts.add("training kernels of this program", torch.json.value("kernels", false),
              "for AVX-512 with BF16",
              "this processor lacks AVX-512 with BF16; training uses LibTorch's operations.");
  }
  parts.add("figures in pages (three.js)", !assets::three_js.empty(), "built in",
            "apt-get install libjs-three, then scripts/build; view and generate need it.");
  const auto ffmpeg = find_program("ffmpeg");
  parts.add("ffmpeg (render .mp4 and .gif)", !ffmpeg.empty(), ffmpeg.string(),
            "apt-get install ffmpeg; pictures (.png) need nothing.");
  const auto browser = find_program("chromium");
  parts.add("chromium (tests of the pages)", !browser.empty(), browser.string(),
            "apt-get install chromium, to test pages; pages open in any browser.");
  return parts.table();
}

std::string giga(double flops) {
  return format_fixed(flops / 1e9, 1) + " GFLOP/s";
}

Table speed_table(const Json& speed) {
  const double rate = speed.at("tokens_per_second"), flops = speed.at("training_flops"),
               most = speed.at("parameters_in_an_hour");
  Table table("", {"speed", "measured"});
  table.row({"matrix product, f32", giga(speed.at("f32_product_flops"))});
  table.row({"training, " + speed.at("device").get<std::string>() + " " +
                 speed.at("precision").get<std::string>(),
             format_fixed(rate, 0) + " tokens/s, " + giga(flops)});
  table.row({"of a model of", format_fixed(speed.at("parameters").get<double>() / 1e6, 1) +
                                  " million parameters, 8 windows of 1,024 tokens a step"});
  table.row({"motion trained on in an hour",
             format_fixed(rate / kTokensASecond, 1) + " hours (13 joints, 20 frames/s)"});
  const ModelOfSize size = model_of_size(most);
  table.row({"a model for an hour", format_fixed(most / 1e6, 1) + " million parameters"});
  if (size.n_layer > 0) table.row({"such as", size.options()});
  table.note(
      "Reckoned: N parameters that see 20 N tokens (Hoffmann et al. 2022), 6 FLOPs a parameter and "
      "token, at the rate of the measured steps. Other work on the machine slows it down.");
  return table;
}

void run_doctor(const DoctorCommand& command) {
  check_writable(command.json);
  const TorchAnswer torch = ask_torch_part("about");
  std::vector<Table> tables = {machine_table(this_machine()), parts_table(torch)};
  for (const Table& table : tables) std::printf("%s\n", table.text().c_str());
  std::fflush(stdout);
  if (torch.failure.empty() && command.seconds > 0) {
    const TorchAnswer speed = ask_torch_part("measure --device " + command.device + " --threads " +
                                             std::to_string(command.threads) + " --seconds " +
                                             format_number(command.seconds));
    if (speed.failure.empty()) {
      tables.push_back(speed_table(speed.json));
      std::printf("%s", tables.back().text().c_str());
    } else {
      std::printf("The speed was not measured: %s\n", speed.failure.c_str());
    }
  }
  if (command.json.empty()) return;
  Json all = Json::array();
  for (const Table& table : tables) all.push_back(table.json());
  save_json(command.json, all);
}

}  // namespace

void add_doctor(CLI::App& app) {
  CLI::App* doctor = app.add_subcommand(
      "doctor", "say what is installed, what is missing, how fast this machine is");
  const auto command = std::make_shared<DoctorCommand>();
  doctor
      ->add_option("--seconds", command->seconds,
                   "seconds to measure the speed for, 0 for not at all")
      ->check(CLI::Range(0.0, 600.0))
      ->check(BindOptions::finite())
      ->capture_default_str();
  add_machine_options(*doctor, command->device, command->threads);
  add_json_option(*doctor, command->json);
  doctor->callback([command] { run_doctor(*command); });
}

}  // namespace mocaplm
