// Names of schemes, "Representation/DimensionReduction/Model" as in section 4.3, and their
// settings.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mocaplm {

struct Scheme {
  std::string representation;  // SIEM, IS-TVF, S-TVF, M-TVF; PWI stands alone
  std::string reduction;       // SequentialPCA, MPCA; SpatialPCA for VAR; "" with PWI
  std::string model;           // IG, MVG, VAR, Copula, Mixture, Bootstrap, Local; "" with PWI
};

// "SIEM/SequentialPCA/MVG", "IS-TVF/SpatialPCA/VAR", "PWI". Throws UsageError with the nearest
// known name, or when the parts do not go together.
Scheme parse_scheme(const std::string& name);
std::string to_string(const Scheme& scheme);

struct SchemeOptions {
  std::int64_t d1 = 10, d2 = 5;
  double variance1 = 0, variance2 = 0;
  double shrinkage = -1;
  std::int64_t order = 12;
  std::int64_t mixture = 0;
  double bandwidth = 0;
  std::int64_t neighbours = 6;
  double spread = 0.7;
  double floor = 0.2;
  bool stratified = true;
  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("d1", d1, 1, 1000, "spatial components");
    v.integer("d2", d2, 1, 10000, "components in time, of each spatial one");
    v.number("variance1", variance1, 0, 1, "choose d1 for this share of the variance; 0: as given");
    v.number("variance2", variance2, 0, 1, "choose d2 for this share of the variance; 0: as given");
    v.number("shrinkage", shrinkage, -1, 1,
             "of covariances towards their diagonal; -1: from the data");
    v.integer("order", order, 1, 100, "of VAR");
    v.integer("mixture", mixture, 0, 100, "Gaussians of Mixture; 0: chosen by likelihood");
    v.number("bandwidth", bandwidth, 0, 10,
             "of Copula's and Bootstrap's kernels, in Silverman's; 0: chosen from the data");
    v.integer("neighbours", neighbours, 1, 1000, "that shape each of Local's kernels");
    v.number("spread", spread, 0.01, 1,
             "share of a neighbourhood's deviation that Local draws anew; the rest is the clip's");
    v.number("floor", floor, 0.001, 1,
             "share of its kernels' variance that is independent noise of each coefficient");
    v.boolean("stratified", stratified,
              "draw kernels and Gaussians of Mixture in turn, not independently");
  }
};

}  // namespace mocaplm
