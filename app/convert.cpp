// mocaplm convert: motion files of one format into files of another.
#include <memory>

#include "app/commands.h"
#include "app/convert_files.h"
#include "app/options.h"
#include "app/read_options.h"
#include "common/error.h"
#include "common/files.h"

namespace mocaplm {

namespace {

struct ConvertCommand {
  ConvertJob job;
  std::vector<std::string> names;
  std::string json;

  void run() {
    if (names.size() < 2) throw UsageError("name a motion, and after it the file to write");
    check_writable(json);
    job.inputs.assign(names.begin(), names.end() - 1);
    job.out = names.back();
    job.table = json;
    print_table(convert_files(job), json);
  }
};

}  // namespace

void add_convert(CLI::App& app) {
  CLI::App* convert = app.add_subcommand(
      "convert", "turn motion files into .bvh, .npz, .glb (a figure), .vrma or .csv");
  const auto command = std::make_shared<ConvertCommand>();
  ConvertJob& job = command->job;
  convert
      ->add_option("CLIP... OUT", command->names,
                   kMotionFiles + std::string("or dataset folders; last the file to write, or with "
                                              "--to a folder"))
      ->required();
  bind_options(*convert, job.config);
  convert->add_option("--clip", job.clips, "these clips of the dataset folders (default: all)")
      ->type_name("NAME")
      ->delimiter(',')
      ->allow_extra_args(false);  // what follows is a motion again
  convert
      ->add_option(
          "--character", job.character,
          "a character (.glb, .vrm, .fbx) that gets the motion: a .glb with its own mesh and skin")
      ->type_name("FILE");
  add_read_options(*convert, job.read);
  add_threads_option(*convert, job.threads, "files at a time; 0: one for each core");
  add_json_option(*convert, command->json);
  convert->callback([command] { command->run(); });
}

}  // namespace mocaplm
