// The pictures of `mocaplm gesture`, on a page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/table.h"
#include "gesture/juggling/juggle.h"
#include "gesture/model.h"
#include "viewer/plot.h"

namespace mocaplm {

// One page (viewer/report_page.h): the plots, then the tables.
void write_figures(const std::filesystem::path& path, const std::string& title,
                   const std::vector<Plot>& plots, const std::vector<Table>& tables);

// One line of a plot, thinned to `most` points.
PlotSeries line_series(const std::string& name, const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                       const std::string& colour = "", Eigen::Index most = 100);

// Of a phase: the movements as measured and as generated from their boundaries (figure 3); one of
// them over time with the 95% interval, a coordinate a plot; and the coefficient that depends most
// on its conditions, as measured against the hyperplane (figure 2).
std::vector<Plot> phase_plots(const PhaseModel& model, const PhaseData& data);

// The first cycles: hand and ball in the plane, and their heights over time.
std::vector<Plot> juggle_plots(const JuggleRun& run);

}  // namespace mocaplm
