#include "pipeline/output/step_plot.h"

#include "pipeline/output/report_plot.h"

namespace umtet {
namespace {

// The style that the page gives to the plots of a report.
constexpr const char* kStyle =
    "<style>svg{font:12px sans-serif;background:#fff} .title{font-size:14px} .grid{stroke:#ddd}\n"
    ".curve{fill:none;stroke-width:1.5} .panel{fill:#fff;stroke:#ddd}\n"
    ".c0{stroke:#1f77b4} .c1{stroke:#2ca02c} .failed{stroke:#d62728}</style>\n";

}  // namespace

std::string step_plot(const std::vector<StepQuality>& steps) {
  std::vector<PlotCurve> curves = {{"1 % quantile", "c0", {}}, {"minimum mean ratio", "c1", {}}};
  // Without a colour: the axis goes from 0 to 1.
  if (!steps.empty()) curves.push_back({"", "", {{steps.front().t, 0}, {steps.front().t, 1}}});
  for (const StepQuality& s : steps) {
    if (!s.made) {
      curves.push_back({"", "failed", {{s.t, 0}, {s.t, 1}}});
      continue;
    }
    curves[0].points.push_back({s.t, s.p01});
    curves[1].points.push_back({s.t, s.min});
  }
  std::string svg = line_plot({.title = "Mean ratio of the tets", .x_label = "t", .y_label = "Q"}, curves);
  svg.insert(svg.find('\n') + 1, kStyle);
  svg.insert(svg.find(' '), " xmlns=\"http://www.w3.org/2000/svg\"");
  return svg;
}

}  // namespace umtet
