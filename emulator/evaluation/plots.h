// The evaluation's pictures.
#pragma once

#include <string>
#include <vector>

#include "common/table.h"
#include "emulator/evaluation/evaluation.h"
#include "viewer/plot.h"

namespace mocaplm {

struct NamedPlot {
  std::string name;     // a file's stem: letters, digits, - and _
  std::string chapter;  // the class, or "" for what concerns all
  Plot plot;
};

// "walk 60-80 %" -> "walk-60-80"; never empty.
std::string file_stem(const std::string& text);

// For each class: scaling of unseen and simulated motions (Figure 15, one plot a scheme), steps
// from frame to frame (16), quantiles of the log-likelihood (19), reconstruction errors and their
// two-sample tests over d1 and d2 where they were asked for (13), the two-level simulation's
// likelihoods (19); for all: how the number of posture clusters was found.
std::vector<NamedPlot> evaluation_plots(const Evaluation& evaluation);

// OUT/report.html with all tables, plots and settings; the plots are also in OUT/plots/NAME.svg,
// the settings in OUT/settings.json. Files of these names are replaced. Throws DataError when the
// disk refuses.
void write_report(const std::filesystem::path& out, const Evaluation& evaluation,
                  const std::vector<Table>& tables);

}  // namespace mocaplm
