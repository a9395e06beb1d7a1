// mocaplm gesture: movements by function expansion (Lippi, Avizzano and Ruffaldi 2012). Here: fit
// and test; play and juggle have files of their own.
#include <cmath>
#include <memory>

#include "app/commands.h"
#include "app/gesture_commands.h"
#include "app/gesture_figures.h"
#include "app/gesture_input.h"
#include "app/options.h"
#include "common/error.h"
#include "common/files.h"
#include "gesture/report.h"

namespace mocaplm {

namespace {

struct GestureCommand {
  GestureInput input;
  GestureConfig config;
  ReportConfig report;
  std::string out, json, page;
};

// All that fit and test need of each phase.
struct Fitted {
  GestureModel model;
  std::vector<PhaseData> data;
  Cut cut;
};

Fitted fit_all(const GestureCommand& command) {
  for (const std::string& file : {command.out, command.json, command.page}) check_writable(file);
  const Recordings recordings = command.input.read(command.config);
  Fitted fitted;
  fitted.cut = cut_recordings(recordings, command.config);
  fitted.model.config = command.config;
  fitted.model.source = recordings.source;
  for (const PhaseDemonstrations& phase : fitted.cut.phases) {
    fitted.data.push_back(phase_data(phase, recordings, command.config));
    fitted.model.phases.push_back(fit_phase(phase, recordings, command.config, fitted.data.back()));
  }
  return fitted;
}

void write_page(const GestureCommand& command, const Fitted& fitted, const std::string& title,
                const std::vector<Table>& tables) {
  if (command.page.empty()) return;
  std::vector<Plot> plots;
  for (std::size_t i = 0; i < fitted.data.size(); ++i)
    for (const Plot& plot : phase_plots(fitted.model.phases[i], fitted.data[i]))
      plots.push_back(plot);
  write_figures(command.page, title, plots, tables);
}

void run_fit(const GestureCommand& command) {
  const Fitted fitted = fit_all(command);
  save_gesture(command.out, fitted.model);
  Table table("gesture model " + command.out,
              {"phase", "ends by", "demonstrations", "shortest s", "longest s", "conditions",
               "independent", "RMS error of N sines"});
  table.digits({-1, -1, -1, 2, 2, -1, -1, 5});
  for (const PhaseModel& phase : fitted.model.phases)
    table.row(
        {phase.name, phase.rule.text.empty() ? "time" : phase.rule.text,
         phase.demonstrations.size(), phase.shortest(), phase.longest(), phase.n_conditions(),
         phase.rank - 1,
         std::sqrt(phase.truncation.squaredNorm() / static_cast<double>(phase.dimensions()))});
  for (const PhaseModel& phase : fitted.model.phases)
    if (phase.rank - 1 < phase.n_conditions())
      table.note(
          "Phase " + phase.name +
          ": conditions depend on each other or are constant; the smallest slopes are taken.");
  if (fitted.cut.unfinished > 0)
    table.note(std::to_string(fitted.cut.unfinished) +
               " pieces at the end of a recording are left out: their phase does not end.");
  table.note("settings: " + settings_json(command.config).dump());
  write_page(command, fitted, "Gesture model", {table});
  print_table(table, command.json);
}

void run_test(const GestureCommand& command) {
  const Fitted fitted = fit_all(command);
  std::vector<Table> tables;
  for (std::size_t i = 0; i < fitted.data.size(); ++i) {
    const PhaseReport report =
        phase_report(fitted.model.phases[i], fitted.data[i], command.config, command.report);
    tables.push_back(report.coefficients);
    tables.push_back(report.summary);
  }
  tables.back().note("settings: " + settings_json(command.config).dump());
  write_page(command, fitted, "Gesture model: statistics", tables);
  print_tables(tables, command.json);
}

std::shared_ptr<GestureCommand> add_input(CLI::App& app) {
  auto command = std::make_shared<GestureCommand>();
  command->input.add_options(app);
  bind_options(app, command->config);
  add_json_option(app, command->json);
  app.add_option("--page", command->page, "also write a page with figures, a .html file");
  return command;
}

}  // namespace

void add_gesture(CLI::App& app) {
  CLI::App* gesture = app.add_subcommand(
      "gesture", "learn movements from demonstrations; make them between new ends");
  gesture->require_subcommand(1);
  CLI::App* fit = gesture->add_subcommand("fit", "make a model of demonstrated movements");
  const auto fitting = add_input(*fit);
  fit->add_option("--out", fitting->out, "the model, a .json file")->required();
  fit->callback([fitting] { run_fit(*fitting); });
  CLI::App* test = gesture->add_subcommand(
      "test", "statistics of the regression: F-tests, normality, jackknife, left out movements");
  const auto testing = add_input(*test);
  bind_options(*test, testing->report);
  test->callback([testing] { run_test(*testing); });
  add_gesture_play(*gesture);
  add_gesture_juggle(*gesture);
}

}  // namespace mocaplm
