#include "app/walk.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <set>

#include "app/demo_config.h"
#include "app/frame_stream.h"
#include "app/generated.h"
#include "classify/train.h"
#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "generate/generator.h"
#include "motion/formats/aist.h"
#include "motion/formats/formats.h"
#include "motion/skeleton.h"
#include "motion/synth.h"
#include "train/trainer.h"
#include "viewer/page.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr const char* kMarker = "demo.json";
// Everything that a demo puts into its folder; an earlier demo's are removed, nothing else.
const std::vector<std::string> kParts = {"dances",
                                         "pretrained",
                                         "model",
                                         "classifier",
                                         "dance.npz",
                                         "dance.bvh",
                                         "dance.html",
                                         "classification.json",
                                         "classification.txt",
                                         "index.html",
                                         kMarker};
// Shares of the time for training.
constexpr double kPretrain = 0.48, kFineTune = 0.14, kClassify = 0.38;

RunConfig demo_config(const WalkOptions& options) {
  RunConfig config =
      run_config_from_json(parse_json(kDemoConfig, "configs/demo.json"), "configs/demo.json");
  config.train.seed = options.seed;
  return config;
}

void prepare(const fs::path& out) {
  if (fs::exists(out) && !fs::is_directory(out))
    throw UsageError(out.string() + " is a file, expected a folder");
  if (fs::exists(out) && !fs::is_empty(out) && !fs::exists(out / kMarker))
    throw UsageError(out.string() + " is not empty and holds no earlier demo: give another --out");
  for (const std::string& part : kParts) fs::remove_all(out / part);
  fs::create_directories(out);
  save_json(out / kMarker, {{"format", "mocaplm demo"}});
}

void check_value(const std::set<std::string>& values, const std::string& label,
                 const std::string& value) {
  const std::vector<std::string> known(values.begin(), values.end());
  if (std::find(known.begin(), known.end(), value) == known.end())
    throw UsageError("--" + label + " " + value + ": no such " + label + known_names(value, known));
}

// Before any work: the dances' names tell their labels.
void check_choices(const WalkOptions& options) {
  std::set<std::string> genres, dancers;
  for (const Dance& dance : plan_dances({})) {
    const Labels labels = aist_labels(dance.name).value();
    genres.insert(labels.at("genre"));
    dancers.insert(labels.at("dancer"));
  }
  check_value(genres, "genre", options.genre);
  if (!options.dancer.empty()) check_value(dancers, "dancer", options.dancer);
}

std::string first_dancer(const Dataset& dataset, const std::string& genre) {
  for (const DatasetEntry& entry : dataset.entries)
    if (entry.labels.at("genre") == genre) return entry.labels.at("dancer");
  throw UsageError("no dancer dances " + genre);
}

// A held-out advanced dance of another genre, for its right arm.
DatasetEntry held_out(const Dataset& dataset, const std::string& genre) {
  const std::vector<DatasetEntry> test = dataset.split("test");
  for (const DatasetEntry& entry : test)
    if (entry.labels.at("genre") != genre && entry.labels.at("situation") == "advanced")
      return entry;
  return test.at(0);
}

// How this program is called from where the user stands: build/mocaplm.
std::string program() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  const fs::path here = fs::current_path(error);
  if (self.empty() || here.empty()) return "mocaplm";
  const fs::path light = self.parent_path() / "mocaplm";
  const fs::path near = light.lexically_relative(here);
  const bool below = !near.empty() && *near.begin() != "..";
  return (below ? (near.has_parent_path() ? near : "." / near) : light).string();
}

class Walk {
 public:
  explicit Walk(const WalkOptions& options) : options_(options), out_(options.out) {}

  void go() {
    const auto start = std::chrono::steady_clock::now();
    say(1, "procedural dances (rules made them, nobody danced them)");
    SynthConfig synth;
    synth.seed = options_.seed;
    dataset_ = write_dances(synth, out_ / "dances", false, options_.threads);
    if (options_.dancer.empty()) options_.dancer = first_dancer(dataset_, options_.genre);
    say(2, "pre-train on all of them");
    const TrainResult pretrained = train_model("pretrained", {}, kPretrain);
    say(3, "fine-tune with condition tokens: dancer, genre, music, choreography, situation");
    const TrainResult tuned = train_model("model", out_ / "pretrained", kFineTune);
    say(4, "generate " + options_.genre + ", dancer " + options_.dancer + ", from a right arm");
    generate_dance();
    say(5, "classify held-out dances: dancer, genre, situation");
    classify_dances();
    write_pages(pretrained, tuned);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    finish(seconds);
  }

 private:
  static void say(int step, const std::string& what) {
    std::printf("\n[%d/5] %s\n", step, what.c_str());
    std::fflush(stdout);
  }

  TrainResult train_model(const char* name, const fs::path& from, double share) {
    TrainOptions train_options;
    train_options.config = demo_config(options_);
    train_options.config.train.max_minutes = share * options_.minutes;
    train_options.data = out_ / "dances";
    train_options.out = out_ / name;
    train_options.device = options_.device;
    train_options.threads = options_.threads;
    if (!from.empty()) {
      train_options.from = from;
      train_options.config.train.learning_rate = 5e-4;
      train_options.config.train.warmup = 10;
    }
    return train(train_options);
  }

  void generate_dance() {
    const std::string model = (out_ / "model").string();
    generator_ = std::make_unique<Generator>(load_model(model), resolve_model(model).string(),
                                             EngineOptions{Precision::bf16, options_.threads, 1});
    const DatasetEntry entry = held_out(dataset_, options_.genre);
    prompt_name_ = entry.name;
    request_.prompt = load_clip(dataset_, entry);
    request_.joints = parse_joints({"pelvis", "right_arm"});
    request_.labels = {
        {"genre", options_.genre}, {"dancer", options_.dancer}, {"situation", "advanced"}};
    request_.seconds = std::min(options_.seconds, request_.prompt->seconds());
    request_.sampling.seed = options_.seed;
    request_.sampling.temperature = 0.9;
    FrameStream stream(generator_->tokenizer().config().fps, 1);
    result_ =
        generator_->generate(request_, [&](const GeneratedFrame& frame) { stream.tell(frame); });
    stream.finish();
    write_generated((out_ / "dance").string(), *generator_, request_, result_, "model",
                    prompt_name_);
    std::fputs(
        generated_table(*generator_, request_, result_, (out_ / "dance").string()).text().c_str(),
        stdout);
  }

  void classify_dances() {
    ClassifyOptions classify_options;
    classify_options.model = out_ / "pretrained";
    classify_options.data = out_ / "dances";
    classify_options.out = out_ / "classifier";
    classify_options.device = options_.device;
    classify_options.threads = options_.threads;
    classify_options.config.labels = {"dancer", "situation", "genre"};
    classify_options.config.max_minutes = kClassify * options_.minutes;
    classify_options.config.steps = 100000;
    classify_options.config.seed = options_.seed;
    tables_ = classify_tables(classify(classify_options));
    std::string text;
    Json json = Json::array();
    for (const Table& table : tables_) {
      text += table.text() + "\n";
      json.push_back(table.json());
    }
    write_file(out_ / "classification.txt", text);
    save_json(out_ / "classification.json", json);
    tables_.erase(
        tables_.begin() + 2,
        tables_.end());  // windows and clips: the page and the terminal show these, the files all
    for (const Table& table : tables_) std::printf("%s\n", table.text().c_str());
  }

  void write_pages(const TrainResult& pretrained, const TrainResult& tuned) {
    Page page = generated_page(*generator_, request_, result_, "model", prompt_name_);
    page.title = "mocaplm: a dance from a right arm";
    page.tables = tables_;
    page.settings.emplace_back(
        "pre-training", std::to_string(pretrained.steps) + " steps, " +
                            format_duration(pretrained.seconds) + ", " +
                            std::to_string(pretrained.parameters) + " parameters, validation " +
                            format_fixed(pretrained.best_bits_per_frame, 1) + " bits/frame");
    page.settings.emplace_back("fine-tuning", std::to_string(tuned.steps) + " steps, " +
                                                  format_duration(tuned.seconds) + ", validation " +
                                                  format_fixed(tuned.best_bits_per_frame, 1) +
                                                  " bits/frame");
    page.settings.emplace_back("frames where nothing moves",
                               format_fixed(100 * result_.frozen, 1) + " % (" +
                                   format_fixed(100 * result_.context_frozen, 1) +
                                   " % in the context)");
    write_page(out_ / "index.html", page);
  }

  void finish(double seconds) {
    const std::string at = out_.string();
    save_json(out_ / kMarker, {{"format", "mocaplm demo"},
                               {"seed", options_.seed},
                               {"genre", options_.genre},
                               {"dancer", options_.dancer},
                               {"prompt", prompt_name_},
                               {"minutes", options_.minutes},
                               {"seconds", seconds}});
    std::printf("Done in %s. Open %s/index.html in a browser.\n\n",
                format_duration(seconds).c_str(), at.c_str());
    std::printf(
        "  %s/dance.npz, dance.bvh    the generated dance\n  %s/model                   the "
        "fine-tuned model\n"
        "  %s/classification.txt      all tables\n\nTry next:\n",
        at.c_str(), at.c_str(), at.c_str());
    const std::string clip = at + "/dances/clips/" + prompt_name_ + ".npz";
    for (const std::string& command :
         {"generate --model " + at + "/model --genre krump --seconds 20 --out krump",
          "generate --model " + at + "/model --prompt " + clip +
              " --joints left_arm,pelvis --genre house --out house",
          "classify --model " + at + "/classifier " + clip + " " + at + "/dance.npz",
          "view " + at + "/dances --out dances.html",
          "evaluate --model " + at + "/pretrained --data " + at + "/dances"})
      std::printf("  %s %s\n", program_.c_str(), command.c_str());
  }

  WalkOptions options_;
  const std::string program_ = program();
  fs::path out_;
  Dataset dataset_;
  std::unique_ptr<Generator> generator_;
  GenerateRequest request_;
  GenerateResult result_;
  std::string prompt_name_;
  std::vector<Table> tables_;
};

}  // namespace

void walk(const WalkOptions& options) {
  check_choices(options);
  prepare(options.out);
  Walk(options).go();
}

}  // namespace mocaplm
