// mocaplm tokenize: fit a tokenizer, say what it loses, write motion as text and read it back; and
// the report of many tokenizers.
#include <cstdio>
#include <map>
#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/read_options.h"
#include "app/tokenize_page.h"
#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "tokenizer/tokenize.h"
#include "viewer/open.h"
#include "viewer/plot.h"

namespace mocaplm {

namespace {

struct TokenizeCommand {
  TokenizeOptions options;
  std::string decode, json, plot, page;
  std::vector<std::string> report;
};

template <class Config>
void refuse_settings(const CLI::App& app, const std::string& beside) {
  const Json settings = settings_json(Config());
  for (const auto& item : settings.items())
    if (app.get_option(option_flag(item.key()))->count() > 0)
      throw UsageError(option_flag(item.key()) + " cannot be combined with " + beside +
                       ", which fixes it");
}

// How much motion fits in the context against what it loses; where the settings are frames alone
// that differ in their bins, the error against the number of bins, as in the thesis's Figure 4.5.
Plot report_plot(const std::vector<ReportRow>& rows) {
  Plot plot;
  bool only_bins = true;
  std::map<std::string, std::size_t> kinds;
  for (const ReportRow& row : rows) only_bins = only_bins && row.setting.tiles.tiles == 0;
  if (only_bins) {
    plot = {"What bins lose", "bins", "geodesic error, rad", true, true, {}};
    for (const ReportRow& row : rows)
      for (const bool max : {false, true}) {
        const std::string name = row.setting.frames.binning + (max ? ", max" : ", mean");
        const auto at = kinds.emplace(name, plot.series.size());
        if (at.second) plot.series.push_back({name, {}, true});
        plot.series[at.first->second].points.push_back(
            {static_cast<double>(row.setting.frames.bins),
             max ? row.measure.geodesic.max : row.measure.geodesic.mean(), row.setting.name});
      }
    return plot;
  }
  plot = {"What words tell and lose",
          "seconds in 1,024 tokens",
          "mean geodesic error, rad",
          false,
          true,
          {}};
  for (const ReportRow& row : rows) {
    const TileConfig& tiles = row.setting.tiles;
    std::string name = tiles.tiles == 0 ? "frames" : tiles.lapped ? "lapped tiles" : "tiles";
    if (tiles.tiles > 0 && tiles.pca > 0) name += ", PCA";
    if (tiles.tiles > 0 && tiles.ica > 0) name += ", ICA";
    if (row.setting.pieces.any()) name += ", in pieces";
    const auto at = kinds.emplace(name, plot.series.size());
    if (at.second) plot.series.push_back({name, {}, false});
    plot.series[at.first->second].points.push_back(
        {row.measure.seconds_in(1024), row.measure.geodesic.mean(), row.setting.name});
  }
  return plot;
}

void run_report(const TokenizeCommand& command) {
  check_writable(command.plot);
  check_writable(command.page);
  check_writable(command.json);
  std::string note;
  const std::vector<ReportRow> rows = tokenize_report(command.options, command.report, note);
  Table table = report_table(rows);
  table.note(note);
  const Plot plot = report_plot(rows);
  if (!command.page.empty()) {
    Page page;
    page.title = plot.title;
    page.plots.push_back({plot_svg(plot), plot_table(plot)});
    page.tables.push_back(table);
    write_page(command.page, page);
    table.note(command.page + ": the page");
  }
  if (!command.plot.empty()) {
    write_file(command.plot, plot_svg(plot));
    table.note(command.plot + ": the plot");
  }
  print_table(table, command.json);
}

void run_tokenize(const CLI::App& app, TokenizeCommand& command) {
  TokenizeOptions& options = command.options;
  if (!command.page.empty()) {
    check_page_path(command.page);
    check_writable(command.page);
    if (!command.decode.empty())
      throw UsageError(
          "--page shows clips beside their tokens: it cannot be combined with --decode");
  }
  if (!command.decode.empty() && (!options.inputs.empty() || options.text))
    throw UsageError("--decode takes neither clips nor --text");
  if (!command.decode.empty())
    refuse_read_options(options.read, " is for motion files: --decode reads none");
  if (command.decode.empty() && options.inputs.empty())
    throw UsageError("give a dataset folder or motion files, or --decode with a corpus");
  if (!options.tokenizer.empty()) {
    refuse_settings<TokenizerConfig>(app, "--tokenizer");
    refuse_settings<TileConfig>(app, "--tokenizer");
  }
  if (!command.report.empty()) {
    if (!command.decode.empty() || options.text || !options.out.empty() ||
        !options.tokenizer.empty())
      throw UsageError("--report takes none of --decode, --text, --out and --tokenizer");
    run_report(command);
    return;
  }
  if (!command.plot.empty()) throw UsageError("--plot is the picture of a --report");
  if (options.out.empty()) throw UsageError("--out is required, but for a --report");
  // Steps are for frames.
  if (options.tiles.tiles > 0 && app.get_option("--root")->count() == 0)
    options.config.root = "absolute";
  if (command.decode.empty()) {
    const Table table = tokenize(options);
    print_table(table, command.json);
    if (command.page.empty()) return;
    const bool to_file = lower(options.out.extension().string()) == ".json";
    write_page(
        command.page,
        tokenize_page(options, to_file ? options.out : options.out / "tokenizer.json", table));
    std::printf("page: %s\n", command.page.c_str());
    return;
  }
  if (options.tokenizer.empty())
    throw UsageError("--decode needs --tokenizer, the tokenizer.json that wrote the text");
  print_table(untokenize(command.decode, options.tokenizer, options.out), command.json);
}

}  // namespace

void add_tokenize(CLI::App& app) {
  CLI::App* tokenize =
      app.add_subcommand("tokenize", "fit a tokenizer, write motion as text, or decode text");
  auto command = std::make_shared<TokenizeCommand>();
  TokenizeOptions& options = command->options;
  tokenize->add_option("INPUT", options.inputs, kMotionFiles + std::string("or dataset folders"));
  tokenize->add_option(
      "--out", options.out,
      "folder for tokenizer.json and the text, or a .json file; with --decode for the clips");
  tokenize->add_option("--tokenizer", options.tokenizer,
                       "use this tokenizer.json instead of fitting one");
  tokenize->add_flag("--text", options.text,
                     "write corpus.txt, one clip a line, a character a value");
  tokenize->add_option("--decode", command->decode,
                       "bring the clips of this corpus.txt back as .npz");
  tokenize
      ->add_option("--report", command->report,
                   "fit and measure tokenizers, a row each: settings that change the others "
                   "given, \"tiles:60,keep:0.1,pca:42,lapped\", or a .json list of them")
      ->type_name("SETTINGS");
  tokenize->add_option("--plot", command->plot, "write the report as an .svg picture, too");
  tokenize->add_option("--page", command->page,
                       "also write a page with clips beside what their tokens say, or with the "
                       "report, .html");
  add_json_option(*tokenize, command->json);
  bind_options(*tokenize, options.config);
  bind_options(*tokenize, options.tiles);
  bind_options(*tokenize, options.pieces);
  add_read_options(*tokenize, options.read);
  tokenize->callback([tokenize, command] { run_tokenize(*tokenize, *command); });
}

}  // namespace mocaplm
