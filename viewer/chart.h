// Bars and matrices as SVG, drawn as plots are (viewer/plot.h): files of their own that also fit
// into a page.
#pragma once

#include <string>
#include <vector>

namespace mocaplm {

// Shares in percent: a row of bars for each class, a bar for each method.
struct BarChart {
  std::string title;
  std::vector<std::string> methods;  // in the legend
  struct Row {
    std::string name;
    std::vector<double> percent;  // 0 to 100, one a method; not finite: no bar
    std::string note;             // said with the numbers, may be empty
  };
  std::vector<Row> rows;
};

// Throws UsageError when there is no row, or a row has another number of values than there are
// methods.
std::string bars_svg(const BarChart& chart);

// Counts of true (rows) and predicted classes (columns); a field is the darker the larger its share
// of its row.
struct MatrixChart {
  std::string title;
  std::vector<std::string> classes;
  std::vector<std::vector<long>> counts;  // (classes, classes)
};

// Throws UsageError when there is no class or the counts are not square.
std::string matrix_svg(const MatrixChart& chart);

}  // namespace mocaplm
