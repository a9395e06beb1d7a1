// mocaplm query: motions of a dataset that are like a given one, and how well that tells labels.
#include "spectral/query.h"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/read_options.h"
#include "app/spectral_files.h"
#include "common/error.h"
#include "common/files.h"
#include "spectral/evaluation.h"
#include "viewer/open.h"
#include "viewer/page.h"

namespace mocaplm {

namespace {

struct QueryCommand {
  QueryOptions options;
  QueryEvaluation evaluation;
  std::string page, json;
  std::int64_t show = 5;
};

void write_query_page(const QueryResult& result, const QueryCommand& command, const Table& table) {
  Page page;
  page.title = "Motions like " + command.options.clip;
  if (result.dataset.procedural) page.note = "procedural dances made by this program";
  // The part of the query that the best match is like stands beside the matches.
  const double begin = result.matches.front().query_from - result.from;
  const auto first = static_cast<Eigen::Index>(begin * result.query.fps + 0.5);
  const auto count = std::min(result.query.frames() - first,
                              static_cast<Eigen::Index>(result.seconds * result.query.fps + 0.5));
  page.motions.push_back({"query",
                          slice(result.query, first, std::max<Eigen::Index>(count, 1)),
                          {},
                          {},
                          "The query: " + command.options.clip + ", from " +
                              format_fixed(result.matches.front().query_from, 2) + " s"});
  const bool cosine = command.options.query.metric == "cosine";
  const auto shown = std::min(static_cast<std::size_t>(command.show), result.matches.size());
  for (std::size_t i = 0; i < shown; ++i) {
    const QueryMatch& match = result.matches[i];
    const std::string value =
        cosine ? "cosine similarity " + format_fixed(match.neighbour.similarity, 3)
               : "distance " + format_fixed(match.neighbour.distance, 2);
    page.motions.push_back({std::to_string(i + 1),
                            match_clip(result, match),
                            {},
                            {},
                            match.clip + " from " + format_fixed(match.from, 2) + " s, " + value +
                                " to the query from " + format_fixed(match.query_from, 2) + " s"});
  }
  page.tables.push_back(table);
  add_settings(page, settings_json(command.options.query));
  add_settings(page, settings_json(command.options.config));
  write_page(command.page, page);
}

void run(const CLI::App& app, QueryCommand& command) {
  QueryOptions& options = command.options;
  QueryEvaluation& evaluation = command.evaluation;
  check_writable(command.json);
  if (!evaluation.labels.empty()) {
    if (!options.clip.empty()) throw UsageError("--evaluate takes no CLIP: its clips are queries");
    refuse_read_options(options.read, " is for a CLIP that is a file: --evaluate reads none");
    refuse_options(app, {"--page", "--show", "--per-clip"},
                   " lists a query's matches and does not go with --evaluate");
    if (app.get_option("--feature")->count() > 0) evaluation.features = {options.config.feature};
    if (app.get_option("--metric")->count() > 0) evaluation.metrics = {options.query.metric};
    evaluation.dataset = options.dataset;
    evaluation.keep = options.keep;
    evaluation.config = options.config;
    evaluation.query = options.query;
    evaluation.threads = options.threads;
    print_table(evaluate_query(evaluation), command.json);
    return;
  }
  refuse_options(app, {"--features", "--metrics", "--split", "--against"}, " goes with --evaluate");
  if (options.clip.empty()) throw UsageError("give a CLIP to look for, or --evaluate LABEL");
  if (!command.page.empty()) {
    check_page_path(command.page);
    check_writable(command.page);
  }
  const QueryResult result = run_query(options);
  Table table = query_table(result, options);
  if (!command.page.empty()) {
    write_query_page(result, command, table);
    table.note(command.page + ": query and matches side by side");
  }
  print_table(table, command.json);
}

}  // namespace

void add_query(CLI::App& app) {
  CLI::App* query =
      app.add_subcommand("query", "find the motions of a dataset that are like a given one");
  auto command = std::make_shared<QueryCommand>();
  QueryOptions& options = command->options;
  query->add_option("--index", options.dataset, "dataset folder to search; its index is kept there")
      ->required();
  query->add_option("CLIP", options.clip,
                    "clip of the dataset or motion file, CLIP:from-to for a part (seconds), "
                    "FILE#PART of several people or takes");
  add_read_options(*query, options.read);
  query->add_option("--keep", options.keep, "keep the index in this folder instead");
  query->add_option("--page", command->page, "a .html page: query and matches side by side");
  query->add_option("--show", command->show, "matches on the page")
      ->check(CLI::Range(1, 40))
      ->capture_default_str();
  add_json_option(*query, command->json);
  add_threads_option(*query, options.threads);
  bind_options(*query, options.query);
  bind_options(*query, options.config);
  QueryEvaluation& evaluation = command->evaluation;
  query
      ->add_option("--evaluate", evaluation.labels,
                   "instead of a query: how well the nearest windows tell these labels")
      ->delimiter(',');
  query
      ->add_option("--features", evaluation.features,
                   "--evaluate: features to compare, a row each (--feature: this one alone)")
      ->delimiter(',')
      ->capture_default_str();
  query
      ->add_option("--metrics", evaluation.metrics,
                   "--evaluate: metrics to compare (--metric: this one alone)")
      ->delimiter(',')
      ->capture_default_str();
  query
      ->add_option("--split", evaluation.split,
                   "--evaluate: split whose windows are queries, or all")
      ->capture_default_str();
  query
      ->add_option("--against", evaluation.against,
                   "--evaluate: split whose windows may be found, or all")
      ->capture_default_str();
  query->callback([query, command] { run(*query, *command); });
}

}  // namespace mocaplm
