// mocaplm emulate: a class of motions as a random curve of postures, fitted and sampled.
#include "app/emulate.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/commands.h"
#include "app/generated.h"
#include "app/read_options.h"
#include "common/error.h"
#include "common/files.h"
#include "common/progress.h"
#include "common/text.h"
#include "emulator/motions.h"
#include "motion/chosen_clips.h"

namespace mocaplm {

namespace {

// A page with more figures is slow, and nobody looks at them all.
constexpr std::size_t kMostFigures = 8;

struct EmulateCommand {
  std::vector<std::string> inputs, where;
  std::string split = "train", scheme = "SIEM/SequentialPCA/MVG", out, json;
  MotionReading read;
  LandmarkOptions landmarks;
  AlignOptions align;
  SchemeOptions options;
  int threads = 0;
};

// What a scheme is fitted to.
struct FittedClips {
  std::vector<Clip> clips;
  std::string from;   // the dataset's folder, or the files
  std::string split;  // "" of files
  bool procedural = false;
};

std::vector<Clip> read_class(const EmulateCommand& command, const Dataset& dataset) {
  const auto entries =
      chosen_entries(dataset, command.split == "all" ? "" : command.split, command.where);
  if (entries.size() < kFewestMotions)
    throw DataError(
        in_file(dataset.directory),
        (command.where.empty() ? "the dataset" : join(command.where, ", ")) + " has " +
            std::to_string(entries.size()) + (entries.size() == 1 ? " clip" : " clips") +
            (command.split == "all" ? "" : " in the split " + command.split) + ", expected " +
            std::to_string(kFewestMotions) + " or more to fit a scheme to" +
            (command.split == "all" ? "" : "; --split all takes the clips of all splits"));
  Progress progress("reading", entries.size(), "clips");
  std::vector<Clip> clips;
  for (const DatasetEntry& entry : entries) {
    clips.push_back(load_clip(dataset, entry));
    progress.add();
  }
  progress.finish();
  return clips;
}

FittedClips read_files(const CLI::App& app, const EmulateCommand& command) {
  refuse_options(app, {"--where", "--split"}, " chooses from a dataset: give its folder alone");
  FittedClips out;
  out.from = join(command.inputs, ", ");
  for (const MotionInput& input : find_motions(command.inputs, {}, command.read)) {
    for (const NamedMotion& motion : read_motions(input, command.read))
      out.clips.push_back(motion.read.clip);
    out.procedural = out.procedural || (input.dataset && input.dataset->procedural);
  }
  if (out.clips.size() < kFewestMotions)
    throw DataError(in_file(command.inputs.front()),
                    std::to_string(out.clips.size()) + " motions are given, expected " +
                        std::to_string(kFewestMotions) + " or more to fit a scheme to");
  return out;
}

FittedClips read_fitted(const CLI::App& app, const EmulateCommand& command) {
  if (command.inputs.size() > 1 || !std::filesystem::is_directory(command.inputs[0]))
    return read_files(app, command);
  refuse_read_options(command.read,
                      " has no effect: a dataset's clips were read when it was imported");
  const Dataset dataset = load_dataset(command.inputs[0]);
  return {read_class(command, dataset), command.inputs[0], command.split, dataset.procedural};
}

void add_settings(Table& table, const Json& settings) {
  for (const auto& item : settings.items())
    table.row({item.key(),
               item.value().is_string() ? item.value().get<std::string>() : item.value().dump()});
}

Table fit_table(const EmulateCommand& command, const std::string& split,
                const PreparedMotions& prepared, const MotionEmulator& motions) {
  const Emulator& emulator = *motions.emulator;
  double amount = 0, most = 0, before = 0, after = 0, lost = 0, likelihood = 0;
  const auto n = static_cast<double>(prepared.names.size());
  for (const Alignment& item : prepared.aligned.items) {
    amount += item.amount / n;
    most = std::max(most, item.amount);
    before += item.before / n;
    after += item.after / n;
    lost += sequence_distance(item.sequence, emulator.reconstruct(item.sequence)) / n;
    likelihood += emulator.log_likelihood(item.sequence) / n;
  }
  const auto lengths = std::minmax_element(prepared.seconds.begin(), prepared.seconds.end());
  Table table("", {"fitted", "value"});
  table.row({"class", command.where.empty() ? "all clips" : join(command.where, ", ")});
  table.row(
      {"clips", std::to_string(prepared.names.size()) + (split.empty() ? "" : " (" + split + ")")});
  table.row({"seconds", format_fixed(prepared.mean_seconds(), 2) + " (" +
                            format_fixed(*lengths.first, 2) + " to " +
                            format_fixed(*lengths.second, 2) + ")"});
  table.row({"frames when aligned", std::to_string(emulator.frames())});
  table.row({"landmarks", std::to_string(prepared.tree.names.size())});
  table.row({"warping, mean and most", format_fixed(amount, 3) + ", " + format_fixed(most, 3)});
  table.row({"distance to the template",
             format_fixed(before, 3) + " before, " + format_fixed(after, 3) + " aligned"});
  table.row({"scheme", to_string(emulator.scheme())});
  if (emulator.d1() > 0) {
    table.row(
        {"components", std::to_string(emulator.d1()) + " x " + std::to_string(emulator.d2())});
    table.row({"reconstruction error", format_fixed(lost, 3) + " rad"});
  }
  table.row({"log-likelihood a clip", format_fixed(likelihood, 1)});
  add_settings(table, settings_json(command.landmarks));
  add_settings(table, settings_json(command.align));
  add_settings(table, settings_json(command.options));
  table.row({"file", command.out});
  if (emulator.d1() > 0 &&
      (emulator.d1() < command.options.d1 ||
       (emulator.scheme().model != "VAR" && emulator.d2() < command.options.d2)))
    table.note("note: fewer components than asked for: the clips do not have more");
  if (motions.procedural) table.note("note: the clips are procedural dances");
  return table;
}

void run_fit(const CLI::App& app, const EmulateCommand& command) {
  check_writable(command.out);
  check_writable(command.json);
  const Scheme scheme = parse_scheme(command.scheme);
  const FittedClips fitted = read_fitted(app, command);
  const PreparedMotions prepared =
      prepare_motions(fitted.clips, command.landmarks, command.align, command.threads);
  MotionEmulator motions = fit_motions(prepared, scheme, command.options, command.threads);
  motions.where = command.where;
  motions.data = fitted.from;
  motions.procedural = fitted.procedural;
  save_motion_emulator(command.out, motions);
  print_table(fit_table(command, fitted.split, prepared, motions), command.json);
}

struct SampleCommand {
  std::string model, out = "emulated", timing = "clips", json;
  std::int64_t count = 1, seed = 1;
  double fps = 30;
};

std::string numbered(const SampleCommand& command, const std::string& ending, std::int64_t index) {
  std::filesystem::path stem = command.out;
  if (stem.extension() == ending) stem.replace_extension();
  return stem.string() + (command.count == 1 ? "" : "-" + std::to_string(index + 1)) + ending;
}

// The endings that --out asks for.
std::vector<std::string> endings(const SampleCommand& command) {
  const std::string own = std::filesystem::path(command.out).extension().string();
  if (own == ".npz" || own == ".bvh" || own == ".html") return {own};
  return {".npz", ".bvh", ".html"};
}

Page sample_page(const SampleCommand& command, const MotionEmulator& motions,
                 const std::vector<Clip>& clips) {
  Page page;
  const std::string what = motions.where.empty() ? motions.data : join(motions.where, ", ");
  page.title = "Emulated motions: " + what;
  if (motions.procedural)
    page.note = "fitted to procedural dances made by this program, not to motion capture";
  for (std::size_t k = 0; k < std::min(clips.size(), kMostFigures); ++k)
    page.motions.push_back({clips[k].name, clips[k], {}, {}, "Sample " + std::to_string(k + 1)});
  page.settings = {{"model", command.model},
                   {"scheme", to_string(motions.emulator->scheme())},
                   {"class", what},
                   {"clips fitted to", std::to_string(motions.seconds.size())},
                   {"timing", command.timing},
                   {"seed", std::to_string(command.seed)}};
  return page;
}

void run_sample(const SampleCommand& command) {
  const std::vector<std::string> kinds = endings(command);
  check_writable(command.json);
  check_writable(numbered(command, kinds[0], 0));
  const MotionEmulator motions = load_motion_emulator(command.model);
  const std::vector<Clip> clips = sample_clips(motions, static_cast<std::size_t>(command.count),
                                               static_cast<std::uint64_t>(command.seed),
                                               command.timing == "clips", command.fps);
  std::vector<std::string> written;
  for (const std::string& kind : kinds) {
    if (kind == ".html") {
      std::filesystem::path page = command.out;
      if (page.extension() != kind) page += kind;
      write_page(page, sample_page(command, motions, clips));
      written.push_back(page.string());
      continue;
    }
    for (std::int64_t k = 0; k < command.count; ++k) {
      write_clip(numbered(command, kind, k), clips[static_cast<std::size_t>(k)]);
      written.push_back(numbered(command, kind, k));
    }
  }
  Table table("", {"sampled", "seconds", "frames"});
  table.digits({-1, 2, 0});
  for (const Clip& clip : clips)
    table.row({clip.name, clip.seconds(), static_cast<std::int64_t>(clip.frames())});
  table.note(to_string(motions.emulator->scheme()) + " of " +
             (motions.where.empty() ? "all clips" : join(motions.where, ", ")) + " in " +
             motions.data + ", seed " + std::to_string(command.seed));
  table.note(written.size() > 6 ? written.front() + " ... " + written.back() : join(written, " "));
  if (motions.procedural) table.note("note: the model was fitted to procedural dances");
  print_table(table, command.json);
}

}  // namespace

void add_emulate_fit(CLI::App& emulate) {
  CLI::App* fit = emulate.add_subcommand("fit", "fit a scheme to the clips of one class");
  auto command = std::make_shared<EmulateCommand>();
  fit->add_option("INPUT", command->inputs,
                  kMotionFiles + std::string("or a dataset's folder alone (--where, --split)"))
      ->required();
  fit->add_option("--where", command->where, "the class, label=value (repeatable: clips with all)");
  fit->add_option("--split", command->split, "clips of this split")
      ->check(one_of({"train", "validation", "test", "all"}))
      ->capture_default_str();
  fit->add_option("--scheme", command->scheme,
                  "Representation/DimensionReduction/Model: SIEM, IS-TVF, S-TVF or M-TVF; "
                  "SequentialPCA or MPCA; IG, MVG, Copula, Mixture, Bootstrap or Local; "
                  "X/SpatialPCA/VAR; or PWI")
      ->capture_default_str();
  fit->add_option("--out", command->out, "the model, a .json file")->required();
  add_json_option(*fit, command->json);
  add_threads_option(*fit, command->threads);
  bind_options(*fit->add_option_group("landmarks"), command->landmarks);
  bind_options(*fit->add_option_group("alignment"), command->align);
  bind_options(*fit->add_option_group("scheme"), command->options);
  add_read_options(*fit, command->read);
  fit->callback([fit, command] { run_fit(*fit, *command); });
}

void add_emulate_sample(CLI::App& emulate) {
  CLI::App* sample = emulate.add_subcommand("sample", "make new motions with a fitted model");
  auto command = std::make_shared<SampleCommand>();
  sample->add_option("MODEL", command->model, "a file of emulate fit")->required();
  sample
      ->add_option("--out", command->out,
                   "writes OUT-1.npz, OUT-1.bvh, ... and OUT.html; with an ending only those")
      ->capture_default_str();
  sample->add_option("--count", command->count, "how many")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  sample->add_option("--seed", command->seed, "the same seed gives the same motions")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 53))
      ->capture_default_str();
  sample->add_option("--fps", command->fps, "frames per second")
      ->check(CLI::Range(1.0, 1000.0))
      ->check(BindOptions::finite())
      ->capture_default_str();
  sample
      ->add_option("--timing", command->timing,
                   "clips: length and pace of one of the clips, by chance; mean: the mean length, "
                   "even")
      ->check(one_of({"clips", "mean"}))
      ->capture_default_str();
  add_json_option(*sample, command->json);
  sample->callback([command] { run_sample(*command); });
}

void add_emulate(CLI::App& app) {
  CLI::App* emulate = app.add_subcommand(
      "emulate", "learn how the motions of a class vary; make and test new ones");
  emulate->require_subcommand(1);
  add_emulate_fit(*emulate);
  add_emulate_sample(*emulate);
  add_emulate_test(*emulate);
}

}  // namespace mocaplm
