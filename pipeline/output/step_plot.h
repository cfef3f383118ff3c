#pragma once

#include <string>
#include <vector>

namespace umtet {

/// A point of the plot: qualities of the mesh at a time.
struct StepQuality {
  double t;
  bool made;  ///< else the time is marked, and the qualities are not read
  double min, p01;
};

/// Least mean ratio and its 1 % quantile over time, as in Fig. 21 of the paper: an SVG document.
std::string step_plot(const std::vector<StepQuality>& steps);

}  // namespace umtet
