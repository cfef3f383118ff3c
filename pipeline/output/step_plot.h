#pragma once

#include <string>
#include <vector>

namespace umtet {

/// A point of the plot: the qualities of the mesh at one time.
struct StepQuality {
  double t;
  bool made;  ///< false: the time is marked, and the qualities are ignored
  double min, p01;
};

/// Returns an SVG document with the minimum mean ratio and its 1 % quantile over time, as in Fig. 21 of the paper.
std::string step_plot(const std::vector<StepQuality>& steps);

}  // namespace umtet
