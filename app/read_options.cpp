#include "app/read_options.h"

#include <cstdio>

#include "common/error.h"

namespace mocaplm {

namespace {

// Of all commands; only the one that runs fills its own.
std::vector<std::shared_ptr<Remarks>>& kept_remarks() {
  static std::vector<std::shared_ptr<Remarks>> all;
  return all;
}

CLI::Validator unit_of_length() {
  return CLI::Validator(
      [](std::string& text) {
        try {
          metres_of_unit(text);
          return std::string();
        } catch (const UsageError& error) {
          return std::string(error.what());
        }
      },
      "");
}

}  // namespace

void add_read_options(CLI::App& app, MotionReading& reading, const ReadOptionSet& set) {
  reading.remarks = std::make_shared<Remarks>();
  kept_remarks().push_back(reading.remarks);
  CLI::App& group = *app.add_option_group("reading motion files");
  group
      .add_option_function<double>(
          set.rate, [&reading](const double& fps) { reading.fps = fps; },
          "frame rate of the files, where their own is wrong or missing")
      ->check(CLI::Range(0.001, 10000.0))
      ->check(BindOptions::finite());
  group
      .add_option_function<std::string>(
          "--up", [&reading](const std::string& name) { reading.up = up_axis_of(name); },
          "up axis of the files (auto: by their format or their motion)")
      ->check(one_of(up_axis_names()))
      ->default_str("auto");
  if (set.unit)
    group
        .add_option_function<std::string>(
            "--unit", [&reading](const std::string& unit) { reading.unit = metres_of_unit(unit); },
            "unit of the lengths: m, cm, mm, in, ft or metres, a number (else: by the body's size)")
        ->check(unit_of_length())
        ->type_name("UNIT");
  group
      .add_option("--bvh-map", reading.bvh_map, "JSON map for a skeleton with unknown joint names")
      ->type_name("FILE");
  group
      .add_option("--write-map", reading.write_map,
                  "write the map by which a skeleton was recognised, or the best guess, to be "
                  "corrected and given back with --bvh-map")
      ->type_name("FILE");
  group.add_flag("--keep-path", reading.keep_path,
                 "the way over the floor as in the file, not scaled to the legs' length");
  group.add_flag("--fill-gaps", reading.fill_gaps,
                 "interpolate values that are not numbers, up to a second");
  group
      .add_option("--drop-first", reading.drop_first,
                  "leading frames to leave out; parts (FILE:from-to) count from what is left")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  group
      .add_option("--body", reading.body,
                  "SMPL, SMPL-H or SMPL-X model file (.npz, .pkl): the joints of the files' own "
                  "body shapes")
      ->type_name("FILE");
}

const std::vector<std::string>& read_option_names() {
  static const std::vector<std::string> names = {"--source-fps", "--up",         "--unit",
                                                 "--bvh-map",    "--write-map",  "--keep-path",
                                                 "--fill-gaps",  "--drop-first", "--body"};
  return names;
}

void print_remarks() {
  for (const std::shared_ptr<Remarks>& remarks : kept_remarks())
    for (const std::string& sentence : remarks->sentences())
      std::fprintf(stderr, "note: %s\n", sentence.c_str());
  kept_remarks().clear();
}

}  // namespace mocaplm
