#pragma once

#include <array>
#include <string>
#include <vector>

namespace umtet {

/// A line of a plot. The class c0 ... c5 gives its colour; dashed lines also have the class `dashed`.
struct PlotCurve {
  std::string name;
  std::string css_class;
  /// Points; those that an axis cannot show (log of <= 0, not finite) are omitted.
  std::vector<std::array<double, 2>> points;
};

struct PlotAxes {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
};

/// Returns a plot as one <svg> element: curves, axes with round ticks, and a legend if more than one curve has a name.
/// The style sheet of the page defines the colours. Texts must not contain markup.
std::string line_plot(const PlotAxes& axes, const std::vector<PlotCurve>& curves);

/// Returns the outline of a histogram of equal bins from `first` to `last`.
std::vector<std::array<double, 2>> histogram_outline(const std::vector<double>& heights, double first, double last);

}  // namespace umtet
