// mocaplm gesture play: movements of a model as CSV.
#include <cmath>
#include <cstdio>
#include <memory>

#include "app/gesture_commands.h"
#include "app/gesture_figures.h"
#include "app/options.h"
#include "common/error.h"
#include "common/files.h"
#include "gesture/player.h"
#include "gesture/variants.h"

namespace mocaplm {

namespace {

struct PlayCommand {
  std::string model, phase, out, json, page;
  std::vector<double> from, to, more;
  double duration = 0, rate = 200, correct_at = 0;
  std::vector<std::string> end_velocity;
  std::vector<double> state, target;
  std::string on = "hyperplane", correction = "hyperplane";
  int cycles = 1;
  std::uint64_t seed = 1;
};

Eigen::VectorXd given(const std::vector<double>& numbers, const Eigen::VectorXd& fallback,
                      const char* option) {
  if (numbers.empty()) return fallback;
  if (static_cast<Eigen::Index>(numbers.size()) != fallback.size())
    throw UsageError(std::string(option) + " needs " + std::to_string(fallback.size()) +
                     " numbers, " + std::to_string(numbers.size()) + " are given");
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), fallback.size());
}

Boundary boundary_of(const PhaseModel& phase, const PlayCommand& command) {
  const auto n = static_cast<double>(phase.demonstrations.size());
  Boundary mean = phase.demonstrations[0];
  Eigen::VectorXd start = Eigen::VectorXd::Zero(phase.dimensions()), end = start;
  Eigen::VectorXd more = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mean.more.size()));
  double duration = 0;
  for (const Boundary& one : phase.demonstrations) {
    start += one.start / n;
    end += *one.end / n;
    more += Eigen::Map<const Eigen::VectorXd>(one.more.data(), more.size()) / n;
    duration += one.duration / n;
  }
  mean.start = given(command.from, start, "--from");
  mean.end = given(command.to, end, "--to");
  const Eigen::VectorXd columns = given(command.more, more, "--more");
  mean.more.assign(columns.data(), columns.data() + columns.size());
  mean.duration = command.duration > 0 ? command.duration : duration;
  return mean;
}

std::vector<std::optional<double>> velocities(const PlayCommand& command) {
  std::vector<std::optional<double>> all;
  for (const std::string& text : command.end_velocity) {
    if (text == "free") {
      all.emplace_back();
      continue;
    }
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != 0 || !std::isfinite(value))
      throw UsageError("--end-velocity: expected a number or \"free\", found \"" + text + "\"");
    all.emplace_back(value);
  }
  return all;
}

std::vector<Plot> variant_plots(const std::vector<MovementVariant>& variants,
                                const PhaseModel& phase, double duration) {
  std::vector<Plot> plots;
  for (Eigen::Index v = 0; v < phase.dimensions(); ++v) {
    const std::string& name = phase.coordinates[static_cast<std::size_t>(v)];
    Plot plot{"Phase " + phase.name + ", " + name, "s", name, false, false, {}};
    for (const MovementVariant& one : variants)
      plot.series.push_back(
          line_series(one.name, Eigen::VectorXd::LinSpaced(120, one.from * duration, duration),
                      sampled(one, 120).col(v)));
    plots.push_back(plot);
  }
  return plots;
}

// The movement as planned, and what was asked for in all its variants; `chosen` is the one to play.
std::vector<MovementVariant> all_variants(const PhaseModel& phase, const Boundary& boundary,
                                          const PlayCommand& command, std::size_t& chosen) {
  std::vector<MovementVariant> all = {{"planned", phase.coefficients(boundary), 0}};
  chosen = 0;
  const auto choose = [&](const std::string& name) {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].name == name) chosen = i;
  };
  if (!command.end_velocity.empty()) {
    all = end_velocity_variants(phase, all[0].p, velocities(command), boundary.duration);
    choose(command.on);
  }
  if (command.correct_at <= 0) return all;
  const Eigen::MatrixXd p = all[chosen].p;
  const Basis basis(phase.harmonics);
  const Eigen::VectorXd now = p.transpose() * basis.at(command.correct_at);
  const Eigen::VectorXd last = p.transpose() * basis.at(1);
  all = correction_variants(phase, p, command.correct_at, given(command.state, now, "--state"),
                            given(command.target, last, "--target"));
  choose(command.correction);
  return all;
}

PlayedMovement play_phase(const PhaseModel& phase, const PlayCommand& command,
                          std::vector<Table>& tables, std::vector<Plot>& plots) {
  const Boundary boundary = boundary_of(phase, command);
  std::size_t chosen = 0;
  const std::vector<MovementVariant> all = all_variants(phase, boundary, command, chosen);
  tables.push_back(variant_table(all, phase, boundary.duration));
  plots = variant_plots(all, phase, boundary.duration);
  const double count = std::floor(boundary.duration * command.rate + 1e-9);
  if (count > 1e7) throw UsageError("--rate and --duration ask for more than ten million samples");
  PlayedMovement played;
  const auto n = static_cast<Eigen::Index>(count) + 1;
  const Basis basis(phase.harmonics);
  played.time = Eigen::VectorXd::LinSpaced(n, 0, static_cast<double>(n - 1) / command.rate);
  played.values.resize(n, phase.dimensions());
  for (Eigen::Index i = 0; i < n; ++i) {
    const double tau = played.time(i) / boundary.duration;
    // The past stays as it was.
    const Eigen::MatrixXd& p = tau < all[chosen].from ? all[0].p : all[chosen].p;
    played.values.row(i) = (p.transpose() * basis.at(tau)).transpose();
  }
  played.phases.assign(static_cast<std::size_t>(n), phase.name);
  return played;
}

std::string csv_of(const PlayedMovement& played, const std::vector<std::string>& coordinates) {
  std::string text = "time," + join(coordinates, ",") + ",phase\n";
  char buffer[40];
  for (Eigen::Index i = 0; i < played.time.size(); ++i) {
    std::snprintf(buffer, sizeof buffer, "%.9g", played.time(i));
    text += buffer;
    for (Eigen::Index v = 0; v < played.values.cols(); ++v) {
      std::snprintf(buffer, sizeof buffer, ",%.9g", played.values(i, v));
      text += buffer;
    }
    text += "," + played.phases[static_cast<std::size_t>(i)] + "\n";
  }
  return text;
}

void run_play(const CLI::App& app, const PlayCommand& command) {
  for (const std::string& file : {command.out, command.json, command.page}) check_writable(file);
  const GestureModel model = load_gesture(command.model);
  const std::vector<std::string>& coordinates = model.phases[0].coordinates;
  std::vector<Table> tables;
  std::vector<Plot> plots;
  PlayedMovement played;
  if (!command.phase.empty()) {
    played = play_phase(model.phases[model.find(command.phase)], command, tables, plots);
  } else {
    refuse_options_except(app,
                          {"--model", "--out", "--json", "--page", "--rate", "--cycles", "--seed"},
                          " is for one phase: give --phase too");
    played = play_all(model, command.rate, command.cycles, command.seed);
    Table table("all phases, one after the other", {"phase", "ended by"});
    for (std::size_t i = 0; i < played.ended.size(); ++i)
      table.row({model.phases[i % model.phases.size()].name, played.ended[i]});
    tables.push_back(table);
    for (std::size_t v = 0; v < coordinates.size(); ++v)
      plots.push_back({coordinates[v],
                       "s",
                       coordinates[v],
                       false,
                       false,
                       {line_series("", played.time,
                                    played.values.col(static_cast<Eigen::Index>(v)), "", 400)}});
  }
  if (!command.out.empty()) {
    write_file(command.out, csv_of(played, coordinates));
    tables.back().note(command.out + ": " + std::to_string(played.time.size()) + " samples");
  }
  if (!command.page.empty()) write_figures(command.page, "Played: " + command.model, plots, tables);
  print_tables(tables, command.json);
}

}  // namespace

void add_gesture_play(CLI::App& gesture) {
  CLI::App* play = gesture.add_subcommand("play", "write movements of a model");
  auto command = std::make_shared<PlayCommand>();
  const auto numbers = [&](const char* name, std::vector<double>& values, const char* help) {
    play->add_option(name, values, help)->delimiter(',')->check(BindOptions::finite());
  };
  const auto number = [&](const char* name, double& value, double most, const char* help) {
    play->add_option(name, value, help)
        ->check(CLI::Range(0.0, most))
        ->check(BindOptions::finite())
        ->capture_default_str();
  };
  play->add_option("--model", command->model, "a .json file of gesture fit")->required();
  play->add_option("--phase", command->phase,
                   "the phase to play once; without it all phases, ends and times by chance");
  numbers("--from", command->from, "where it starts (default: the demonstrations' mean)");
  numbers("--to", command->to, "where it ends (default: the demonstrations' mean)");
  numbers("--more", command->more, "conditions that are columns (default: their mean)");
  number("--duration", command->duration, 1e4, "T in seconds, 0: the demonstrations' mean");
  play->add_option("--end-velocity", command->end_velocity,
                   "at the end (equation 9): a number for each coordinate, or free")
      ->delimiter(',');
  play->add_option("--on", command->on, "where the movement with that velocity is looked for")
      ->check(one_of({"hyperplane", "closest", "free"}))
      ->capture_default_str();
  number("--correct-at", command->correct_at, 0.999, "replans at this share of T (equation 10)");
  numbers("--state", command->state, "where the movement is then (default: as planned)");
  numbers("--target", command->target, "where it shall end then (default: as planned)");
  play->add_option("--correction", command->correction, "how it is replanned")
      ->check(one_of({"minimum", "smooth", "hyperplane"}))
      ->capture_default_str();
  play->add_option("--rate", command->rate, "samples a second")
      ->check(CLI::Range(1.0, 1e5))
      ->check(BindOptions::finite())
      ->capture_default_str();
  play->add_option("--cycles", command->cycles, "without --phase: times through all phases")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  play->add_option("--seed", command->seed, "without --phase: of ends and times")
      ->capture_default_str();
  play->add_option("--out", command->out, "the samples, a .csv file");
  add_json_option(*play, command->json);
  play->add_option("--page", command->page, "also write a page with figures, a .html file");
  play->callback([play, command] { run_play(*play, *command); });
}

}  // namespace mocaplm
