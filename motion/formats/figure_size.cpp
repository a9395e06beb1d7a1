#include "motion/formats/figure_size.h"

#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

struct Unit {
  double metres;
  const char* name;
  double least, most;  // metres that a figure may be tall for this unit to be taken
};
// The usual ones first, with room for children and giants; the others do not overlap.
constexpr Unit kUnits[] = {{0.01, "centimetres", 1.1, 2.3},
                           {1, "metres", 1.1, 2.3},
                           {0.001, "millimetres", 1.1, 2.3},
                           {0.0254, "inches", 1.4, 2.1},
                           {0.0254 / 0.45, "1/0.45 inches (CMU)", 1.4, 2.1},
                           {0.1, "decimetres", 1.4, 2.1},
                           {0.3048, "feet", 1.4, 2.1}};
constexpr int kUsualUnits = 3;
constexpr double kPerson = 1.70;

double smpl_leg() {
  const auto bone = [](int a, int b) {
    return (rest_joints().row(a) - rest_joints().row(b)).norm();
  };
  return 0.5 * (bone(1, 4) + bone(4, 7) + bone(2, 5) + bone(5, 8));
}

double unit_of(double height, FigureSize& size) {
  for (int i = 0; i < static_cast<int>(std::size(kUnits)); ++i) {
    const Unit& unit = kUnits[i];
    const double metres = height * unit.metres;
    if (metres < unit.least || metres > unit.most) continue;
    if (i >= kUsualUnits)
      size.remarks.push_back({"unit", std::string("lengths are read as ") + unit.name +
                                          ", with which the figure is " + format_fixed(metres, 2) +
                                          " m tall"});
    return unit.metres;
  }
  const double unit = kPerson / height;
  size.remarks.push_back({"unit",
                          "no usual unit gives the figure a person's size; a unit is read "
                          "as " +
                              format_number(unit) + " m, so that it is " +
                              format_fixed(kPerson, 2) + " m tall (--unit gives another)"});
  return unit;
}

}  // namespace

FigureSize find_size(double leg, double height, const RetargetMap& map, const BvhOptions& options,
                     const std::string& file) {
  FigureSize size;
  if (!(leg > 1e-9) || !std::isfinite(leg) || !std::isfinite(height))
    throw DataError(in_file(file), "the figure's legs have no length");
  if (options.unit || map.unit) {
    size.unit = options.unit ? *options.unit : *map.unit;
    const double metres = height * size.unit;
    if (!(metres > 0.3 && metres < 5))
      throw DataError(in_file(file), "the figure would be " + format_number(metres) +
                                         " m tall at " + format_number(size.unit) +
                                         " m per unit; give another unit, or none");
  } else {
    size.unit = unit_of(height, size);
  }
  if (options.keep_path) return size;
  const double scale = smpl_leg() / (leg * size.unit);
  // SMPL's own legs, but for the digits of a text.
  if (std::abs(scale - 1) > 1e-4) size.path = scale;
  if (scale < 0.8 || scale > 1.25)
    size.remarks.push_back({"path", "the root's path is multiplied by " + format_fixed(scale, 2) +
                                        ", since the legs are " + format_fixed(leg * size.unit, 2) +
                                        " m long and SMPL's " + format_fixed(smpl_leg(), 2) +
                                        " m (--keep-path keeps the source's own)"});
  return size;
}

}  // namespace mocaplm
