#pragma once

#include <array>
#include <string>
#include <vector>

namespace umtet {

/// A line of a plot: class c0 ... c5 gives its colour; dashed lines have the class `dashed` too.
struct PlotCurve {
  std::string name;
  std::string css_class;
  std::vector<std::array<double, 2>> points;  ///< those that an axis cannot show (log of <= 0, not finite) are left out
};

struct PlotAxes {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
};

/// Curves, axes with round ticks, and a legend where more than one has a name: one <svg> element, coloured by the
/// style sheet of the page. Texts must be free of markup.
std::string line_plot(const PlotAxes& axes, const std::vector<PlotCurve>& curves);

/// The outline of a histogram of equal bins from `first` to `last`.
std::vector<std::array<double, 2>> histogram_outline(const std::vector<double>& heights, double first, double last);

}  // namespace umtet
