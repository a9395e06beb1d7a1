// A page with ten dances of a minute at 60 frames a second (docs/viewer.md) in headless Chromium:
// how long it takes to load, the script's work for a frame, and frames as they are drawn. There is
// no graphics card in headless Chromium; what draws there is the processor, so the last figure
// says more of it than of the page.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <memory>
#include <string>

#include "common/temporary_folder.h"
#include "motion/synth.h"
#include "tests/support/browser.h"
#include "viewer/page.h"

namespace {

using namespace mocaplm;

constexpr int kDances = 10;
constexpr double kLoadSeconds = 2, kDisplay = 60;

// The page in a file, and the browser that looks at it.
class Stage {
 public:
  // Null without Chromium.
  static Stage* get() {
    static const std::unique_ptr<Stage> stage(find_browser().empty() ? nullptr : new Stage);
    return stage.get();
  }
  Browser& browser() { return browser_; }
  std::filesystem::path file() const { return folder_ / "page.html"; }
  void open(const std::string& hash) { browser_.open("file://" + file().string() + hash); }

 private:
  Stage() : browser_(find_browser()) {
    SynthConfig config;
    config.seconds = 60;
    Page page;
    page.title = "Ten dances";
    page.note = "procedural dances";
    for (const Dance& dance : plan_dances(config)) {
      page.motions.push_back({dance.name, make_dance(dance, config), {}, {}, ""});
      if (page.motions.size() == kDances) break;
    }
    write_page(file(), page);
    browser_.window(1280, 800);
  }

  TemporaryFolder folder_;
  Browser browser_;
};

// What `script` says in milliseconds is the time of an iteration.
void measure(benchmark::State& state, const std::string& script, bool open_anew) {
  Stage* const stage = Stage::get();
  if (stage == nullptr) return state.SkipWithError("no Chromium");
  stage->open("#t=3");
  for (auto unused : state) {
    if (open_anew) stage->open("#t=3");
    state.SetIterationTime(stage->browser().evaluate(script).get<double>() / 1000);
  }
}

benchmark::Counter rate(double count) {
  return {count, benchmark::Counter::kIsIterationInvariantRate};
}

// From the navigation until the first picture's script has run.
void load(benchmark::State& state) {
  measure(state, "performance.getEntriesByType('navigation')[0].domComplete", true);
  if (Stage::get() == nullptr) return;
  state.counters["loads/s"] = rate(1);
  state.counters["of one in 2 s"] = rate(kLoadSeconds);
  state.counters["goal"] = 1;
  state.counters["MB"] =
      static_cast<double>(std::filesystem::file_size(Stage::get()->file())) / 1e6;
  state.SetLabel("page of ten dances of a minute, loaded");
}

// All that a frame takes but the drawing, which is the graphics card's.
void script(benchmark::State& state) {
  measure(state, R"js((() => {
    const {view} = mocaplm, {render} = view.renderer;
    if (!document.getElementById('trails').checked) controls.toggle('trails');
    view.renderer.render = () => {};
    const start = performance.now();
    for (let i = 0; i < 100; i++) view.show(i / 60);
    view.renderer.render = render;
    return (performance.now() - start) / 100;
  })())js",
          false);
  state.counters["frames/s"] = rate(1);
  state.counters["of a display's 60"] = rate(1 / kDisplay);
  state.counters["goal"] = 1;
  state.SetLabel("page of ten dances, the script for a frame");
}

void drawn(benchmark::State& state) {
  measure(state, R"js(new Promise((done) => {
    let frames = 0, from = 0;
    const tick = (now) => {
      from = from || now;
      if (now - from > 4000) return done((now - from) / frames);
      frames++;
      requestAnimationFrame(tick);
    };
    mocaplm.player.play(true);
    requestAnimationFrame(tick);
  }))js",
          false);
  state.counters["frames/s"] = rate(1);
  state.counters["of a display's 60"] = rate(1 / kDisplay);
  state.SetLabel("page of ten dances, drawn without a graphics card");
}

}  // namespace

BENCHMARK(load)->UseManualTime()->Iterations(5)->Unit(benchmark::kMillisecond);
BENCHMARK(script)->UseManualTime()->Iterations(4)->Unit(benchmark::kMillisecond);
BENCHMARK(drawn)->UseManualTime()->Iterations(1)->Unit(benchmark::kMillisecond);
