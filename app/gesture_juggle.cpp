// mocaplm gesture juggle: the task of section III in a closed loop.
#include <cmath>
#include <memory>

#include "app/gesture_commands.h"
#include "app/gesture_figures.h"
#include "app/options.h"
#include "common/error.h"
#include "common/files.h"
#include "gesture/juggling/demonstrator.h"
#include "gesture/juggling/juggle.h"

namespace mocaplm {

namespace {

struct JuggleCommand {
  JuggleConfig config;
  std::string model, demonstrations, out, json, page;
};

std::string spread(const std::vector<double>& values) {
  if (values.empty()) return "-";
  double mean = 0, square = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) square += std::pow(value - mean, 2);
  return format_fixed(mean, 2) + " +- " +
         format_fixed(std::sqrt(square / static_cast<double>(values.size())), 2);
}

Table run_table(const JuggleRun& run, const JuggleConfig& config) {
  Table table("juggling, " + std::to_string(run.cycles) + " cycles at " +
                  format_number(config.rate) + " Hz",
              {"", "count"});
  table.row({"balls tossed", run.tosses});
  table.row({"tosses missed: the hand never slowed down enough", run.missed_tosses});
  table.row({"balls caught", run.catches});
  table.row({"balls dropped", run.drops});
  table.row({"most catches in a row", run.longest});
  table.row({"corrections on the way", run.corrections});
  return table;
}

Table style_table(const JuggleRun& shown, const JuggleRun& run) {
  Table table("demonstrated and juggled",
              {"phase", "shown s", "juggled s", "shown peak m/s", "juggled peak m/s",
               "ended by rule", "by time", "jump m/s"});
  for (std::size_t i = 0; i < run.phases.size(); ++i) {
    const PhaseTally& ours = run.phases[i];
    const bool there = i < shown.phases.size();
    table.row({ours.name, there ? Json(spread(shown.phases[i].seconds)) : Json(),
               spread(ours.seconds), there ? Json(spread(shown.phases[i].peak_speed)) : Json(),
               spread(ours.peak_speed), ours.by_rule, ours.by_time, spread(ours.jump)});
  }
  table.note("vertical speed of the tossed ball, m/s: shown " +
             (shown.toss_speed.empty() ? "-" : spread(shown.toss_speed)) + ", juggled " +
             spread(run.toss_speed));
  table.note("jump: of the planned velocity against the hand's, where a phase begins");
  return table;
}

void run_juggle(const JuggleCommand& command) {
  for (const std::string& file : {command.demonstrations, command.out, command.json, command.page})
    check_writable(file);
  GestureModel model;
  JuggleRun shown;
  if (command.model.empty()) {
    const Recordings recordings = demonstrate_juggling(command.config);
    const GestureConfig phases = juggling_phases(command.config);
    if (!command.demonstrations.empty())
      write_file(command.demonstrations, recordings_csv(recordings));
    shown = tally_demonstrations(recordings, phases);
    model = fit_gesture(recordings, phases);
    if (!command.out.empty()) save_gesture(command.out, model);
  } else {
    if (!command.demonstrations.empty() || !command.out.empty())
      throw UsageError("--model takes a model as it is: neither --write-demonstrations nor --out");
    model = load_gesture(command.model);
  }
  const JuggleRun run = juggle(model, command.config);
  std::vector<Table> tables = {run_table(run, command.config), style_table(shown, run)};
  tables.back().note("settings: " + settings_json(command.config).dump());
  if (!command.page.empty())
    write_figures(command.page, "A model juggles", juggle_plots(run), tables);
  print_tables(tables, command.json);
}

}  // namespace

void add_gesture_juggle(CLI::App& gesture) {
  CLI::App* juggle = gesture.add_subcommand(
      "juggle", "the juggling task: a made-up user shows it, a model of that does it");
  auto command = std::make_shared<JuggleCommand>();
  juggle->add_option("--model", command->model,
                     "a .json file of gesture fit with the phases toss, down, catch and return; "
                     "without it demonstrations are made up and a model is fitted");
  juggle->add_option("--write-demonstrations", command->demonstrations,
                     "the made-up demonstrations, a .csv file for gesture fit");
  juggle->add_option("--out", command->out, "the fitted model, a .json file");
  add_json_option(*juggle, command->json);
  juggle->add_option("--page", command->page, "also write a page with figures, a .html file");
  bind_options(*juggle, command->config);
  juggle->callback([command] { run_juggle(*command); });
}

}  // namespace mocaplm
