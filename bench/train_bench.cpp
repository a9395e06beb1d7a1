// Whole training steps (forward, backward, clipping, AdamW) beside the machine's own limit: the
// rate of its best bf16 product (LibTorch's or our own), measured in the same run, over the
// products of a step. Options:
// --model A|B (default both), --batch N, --steps N, --dropout P, --precision bf16|f32, --ops (the
// time of each operation), --json FILE.
#include <ATen/Parallel.h>
#include <ATen/record_function.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bench/models.h"
#include "bench/result.h"
#include "common/json.h"
#include "common/table.h"
#include "common/text.h"
#include "model/transformer/cpu/block.h"
#include "model/transformer/setup.h"
#include "model/transformer/transformer.h"
#include "train/optimizer.h"

namespace {

using namespace mocaplm;
using bench::median;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Options {
  std::string model, json, precision = "auto";
  std::int64_t batch = 0, steps = 8;
  double dropout = 0;
  bool ops = false;
};

Options parse(int count, char** words) {
  Options o;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--ops") {
      o.ops = true;
      continue;
    }
    if (i + 1 == count) {
      std::fprintf(stderr, "%s wants a value\n", words[i]);
      std::exit(2);
    }
    const std::string value = words[++i];
    if (word == "--model") {
      o.model = value;
    } else if (word == "--json") {
      o.json = value;
    } else if (word == "--precision") {
      o.precision = value;
    } else if (word == "--batch") {
      o.batch = std::atoll(value.c_str());
    } else if (word == "--steps") {
      o.steps = std::max(1LL, std::atoll(value.c_str()));
    } else if (word == "--dropout") {
      o.dropout = std::atof(value.c_str());
    } else {
      std::fprintf(stderr, "unknown option %s (see the head of train_bench.cpp)\n", words[i - 1]);
      std::exit(2);
    }
  }
  return o;
}

// x (rows, depth) times w^T by the kernels of the transformer.
at::Tensor own_linear(const at::Tensor& x, const LinearWeights& w) {
  const at::Tensor y = at::empty({x.size(0), w.weight.size(0)}, at::kBFloat16);
  const auto halves = [](const at::Tensor& t) {
    return reinterpret_cast<cpu::bf16*>(t.data_ptr<at::BFloat16>());
  };
  const cpu::Product product{halves(x), x.size(1), halves(w.packed->forward(w.weight)), y.size(1)};
  at::parallel_for(0, x.size(0), cpu::kBlockRows, [&](std::int64_t first, std::int64_t last) {
    cpu::block_kernels()->linear(product, nullptr, halves(y), first, last);
  });
  return y;
}

struct Rates {
  double library = 0, own = 0;
  double best() const { return std::max(library, own); }
};

// FLOP/s of the best of several large products: LibTorch's and our own.
Rates product_rates() {
  Rates best;
  for (const auto& [rows, depth, columns] : std::vector<std::array<std::int64_t, 3>>{
           {4096, 1024, 1024}, {4096, 512, 2048}, {4096, 2048, 512}, {2048, 2048, 2048}}) {
    const at::Tensor x = at::randn({rows, depth}).to(at::kBFloat16);
    LinearWeights w;
    w.weight = at::randn({columns, depth});
    const at::Tensor half = w.weight.to(at::kBFloat16);
    const double flops = 2.0 * static_cast<double>(rows * depth * columns);
    for (int i = 0; i < 10; ++i) {
      double start = now();
      const at::Tensor library = at::linear(x, half);
      best.library = std::max(best.library, flops / (now() - start));
      if (!cpu::products_available(depth)) continue;
      start = now();
      const at::Tensor own = own_linear(x, w);
      best.own = std::max(best.own, i > 0 ? flops / (now() - start) : 0);
    }
  }
  return best;
}

struct Case {
  char name;
  std::int64_t batch;
  double goal;  // share of the limit
};

ModelDescription describe(const Case& c, double dropout) {
  ModelDescription d = bench_description(c.name);
  d.config.dropout = dropout;
  return d;
}

// FLOPs of the products of a token's forward and backward pass: six a weight of a matrix, and the
// two products of attention over the half that the mask leaves, the backward pass counted twice.
double flops_a_token(const ModelDescription& d) {
  const auto width = static_cast<double>(d.config.n_embd),
             layers = static_cast<double>(d.config.n_layer);
  const double weights =
      layers * 12 * width * width + static_cast<double>(d.shape.vocabulary) * width;
  const double attention = layers * 2 * 2 * static_cast<double>(d.config.block_size) / 2 * width;
  return 6 * weights + 3 * attention;
}

Batch random_batch(const ModelDescription& d, std::int64_t size) {
  Batch batch;
  batch.token = at::randint(d.shape.vocabulary, {size, d.config.block_size}, at::kLong);
  batch.target = at::randint(d.shape.vocabulary, {size, d.config.block_size}, at::kLong);
  for (auto member : {&Batch::frame, &Batch::channel, &Batch::centre, &Batch::surprise,
                      &Batch::velocity, &Batch::last_surprise})
    batch.*member = at::zeros_like(batch.token);
  return batch;
}

// The self times of LibTorch's operations, and of the scopes that our own kernels open (which take
// in whatever is called within them).
class Profile {
 public:
  static Profile& get() {
    static Profile profile;
    return profile;
  }

  void start() {
    seconds_.clear();
    handle_ = at::addGlobalCallback(
        at::RecordFunctionCallback(
            [](const at::RecordFunction& f) -> std::unique_ptr<at::ObserverContext> {
              get().begin(f);
              return nullptr;
            },
            [](const at::RecordFunction&, at::ObserverContext*) { get().end(); })
            .scopes({at::RecordScope::FUNCTION, at::RecordScope::BACKWARD_FUNCTION,
                     at::RecordScope::USER_SCOPE}));
  }
  void stop() { at::removeCallback(handle_); }
  const std::map<std::string, double>& seconds() const { return seconds_; }

 private:
  struct Open {
    std::string name;
    bool scope;
    double start, inner;
  };
  void begin(const at::RecordFunction& f) {
    if (std::this_thread::get_id() != thread_) return;  // it stands for the others
    const bool scope = f.scope() == at::RecordScope::USER_SCOPE;
    const bool within = !open_.empty() && open_.back().scope && !scope;
    open_.push_back(
        {within ? open_.back().name : std::string(f.name()), scope || within, now(), 0});
  }
  void end() {
    if (std::this_thread::get_id() != thread_) return;
    const Open last = open_.back();
    open_.pop_back();
    const double seconds = now() - last.start;
    seconds_[last.name] += seconds - last.inner;
    if (!open_.empty()) open_.back().inner += seconds;
  }

  const std::thread::id thread_ = std::this_thread::get_id();
  at::CallbackHandle handle_ = 0;
  std::vector<Open> open_;
  std::map<std::string, double> seconds_;
};

const std::vector<std::string> kGroups = {"linears",       "attention", "layer norm", "GELU",
                                          "head and loss", "optimiser", "rest"};

std::string group(const std::string& name) {
  static const std::vector<std::pair<std::string, std::string>> parts = {
      {"attention", "attention"},   {"linear", "linears"},      {"mm", "linears"},
      {"Addmm", "linears"},         {"gelu", "GELU"},           {"Gelu", "GELU"},
      {"layer_norm", "layer norm"}, {"LayerNorm", "layer norm"}};
  for (const std::string& known : kGroups)
    if (name == known) return known;
  for (const auto& [part, where] : parts)
    if (name.find(part) != std::string::npos) return where;
  return "rest";
}

Json measure(const Case& c, const Options& options, double limit) {
  at::manual_seed(1);
  const ModelDescription d = describe(c, options.dropout);
  Transformer model(d);
  model.set_precision(choose_precision(options.precision, at::kCPU));
  model.train();
  Optimizer optimizer(model, TrainConfig{});
  const std::int64_t size = options.batch > 0 ? options.batch : c.batch;
  const Batch batch = random_batch(d, size);
  const auto tokens = static_cast<double>(size * d.config.block_size);
  const auto step = [&] {
    optimizer.zero_grad();
    (model.loss(model.hidden(batch), batch).sum() / tokens).backward();
    RECORD_USER_SCOPE("optimiser");
    optimizer.step(1e-4);
  };
  for (int i = 0; i < 2; ++i) step();
  rusage before{}, after{};
  ::getrusage(RUSAGE_SELF, &before);
  std::vector<double> times;
  for (std::int64_t i = 0; i < options.steps; ++i) {
    const double start = now();
    step();
    times.push_back(now() - start);
  }
  ::getrusage(RUSAGE_SELF, &after);
  Profile::get().start();
  const double profile_start = now();
  const std::int64_t profiled = std::max<std::int64_t>(1, options.steps / 2);
  for (std::int64_t i = 0; i < profiled; ++i) step();
  const double profile_seconds = now() - profile_start;
  Profile::get().stop();

  const double rate = tokens / median(times),
               best = tokens / *std::min_element(times.begin(), times.end()),
               ceiling = limit / flops_a_token(d);
  Json out = {{"name", std::string(1, c.name) + ", batch " + std::to_string(size)},
              {"value", rate},
              {"unit", "tokens/s"},
              {"limit", ceiling},
              {"limit_name", "the rate of a large bf16 product over the step's causal products"},
              {"ratio", rate / ceiling},
              {"goal", c.goal},
              {"best_step_of_limit", best / ceiling},
              {"page_faults_a_step", static_cast<double>(after.ru_minflt - before.ru_minflt) /
                                         static_cast<double>(options.steps)},
              {"peak_memory_mib", static_cast<double>(after.ru_maxrss) / 1024}};
  std::map<std::string, double> shares;
  double known = 0;
  for (const auto& [name, seconds] : Profile::get().seconds()) {
    const std::string where = group(name);
    if (where != "rest") shares[where] += seconds / profile_seconds, known += seconds;
    if (options.ops && seconds > 0.002 * profile_seconds)
      std::printf("%8.2f ms  %5.1f %%  %-14s %s\n", 1e3 * seconds / static_cast<double>(profiled),
                  100 * seconds / profile_seconds, where.c_str(), name.c_str());
  }
  shares["rest"] = 1 - known / profile_seconds;
  for (const std::string& name : kGroups) out["shares"][name] = shares[name];
  return out;
}

}  // namespace

int main(int count, char** words) {
  const Options options = parse(count, words);
  set_up_cpu(0);
  const Rates rates = product_rates();
  const double limit = rates.best();
  const std::vector<Case> cases = {{'B', 8, 0.5}, {'A', 4, 0.8}};
  std::vector<std::string> columns = {"model",     "tokens/s",      "limit",   "of limit",
                                      "best step", "faults a step", "peak MiB"};
  for (const std::string& name : kGroups) columns.push_back(name + " %");
  Table table("training step", columns);
  table.digits({-1, 0, 0, 3, 3, 0, 0, 1, 1, 1, 1, 1, 1, 1});
  Json all = {{"bench", "train"},
              {"product_gflops", limit * 1e-9},
              {"product_gflops_libtorch", rates.library * 1e-9},
              {"product_gflops_own", rates.own * 1e-9},
              {"threads", at::get_num_threads()},
              {"results", Json::array()}};
  for (const Case& c : cases) {
    if (!options.model.empty() && options.model != std::string(1, c.name)) continue;
    const Json one = measure(c, options, limit);
    all["results"].push_back(one);
    std::vector<Json> cells;
    for (const char* key : {"name", "value", "limit", "ratio", "best_step_of_limit",
                            "page_faults_a_step", "peak_memory_mib"})
      cells.push_back(one[key]);
    for (const std::string& name : kGroups)
      cells.push_back(100 * one["shares"][name].get<double>());
    table.row(cells);
  }
  table.note("bf16 product: LibTorch's " + format_fixed(rates.library * 1e-9, 0) + ", own " +
             format_fixed(rates.own * 1e-9, 0) + " GFLOP/s; " +
             std::to_string(at::get_num_threads()) + " threads");
  std::printf("%s", table.text().c_str());
  if (!options.json.empty()) save_json(options.json, all);
}
