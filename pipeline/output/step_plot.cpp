#include "pipeline/output/step_plot.h"

#include <fmt/format.h>

#include <algorithm>

namespace umtet {
namespace {

// Dimensions of the document and of the axes in it, in pixels.
constexpr double kStepWidth = 640, kStepHeight = 300, kStepLeft = 50, kStepRight = 620, kStepTop = 30,
                 kStepBottom = 255;

class Plot {
 public:
  explicit Plot(const std::vector<StepQuality>& steps) : steps_(steps) {
    if (steps.empty()) return;
    first_ = steps.front().t;
    last_ = std::max(steps.back().t, steps.front().t + 1e-9);
  }

  std::string operator()();

 private:
  double x(double t) const { return kStepLeft + (kStepRight - kStepLeft) * (t - first_) / (last_ - first_); }
  static double y(double q) { return kStepBottom + (kStepTop - kStepBottom) * std::clamp(q, 0., 1.); }
  void text(double at_x, double at_y, const char* anchor, const std::string& words) {
    svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", at_x, at_y, anchor, words);
  }
  void axes();
  void curve(double StepQuality::*value, const char* colour, const char* name, double name_x);

  const std::vector<StepQuality>& steps_;
  double first_ = 0, last_ = 1;
  std::string svg_;
};

void Plot::axes() {
  for (int k = 0; k <= 5; ++k) {
    const double q = k / 5.;
    svg_ += fmt::format("<path d=\"M{} {:.1f}H{}\" stroke=\"#ddd\"/>\n", kStepLeft, y(q), kStepRight);
    text(kStepLeft - 6, y(q) + 4, "end", fmt::format("{:.1f}", q));
    const double t = first_ + q * (last_ - first_);
    text(x(t), kStepBottom + 18, "middle", fmt::format("{:.3g}", t));
  }
  text((kStepLeft + kStepRight) / 2, kStepBottom + 36, "middle", "t");
}

void Plot::curve(double StepQuality::*value, const char* colour, const char* name, double name_x) {
  std::string points;
  for (const StepQuality& s : steps_) {
    if (s.made) points += fmt::format("{:.1f},{:.1f} ", x(s.t), y(s.*value));
  }
  svg_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", points, colour);
  svg_ += fmt::format("<g fill=\"{}\">", colour);
  text(name_x, kStepTop - 10, "start", name);
  svg_ += "</g>\n";
}

std::string Plot::operator()() {
  svg_ = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      kStepWidth, kStepHeight);
  axes();
  curve(&StepQuality::p01, "#1f77b4", "1 % quantile", kStepLeft + 120);
  curve(&StepQuality::min, "#2ca02c", "minimum mean ratio", kStepLeft);
  for (const StepQuality& s : steps_) {
    if (!s.made) svg_ += fmt::format("<path d=\"M{:.1f} {}V{}\" stroke=\"#d62728\"/>\n", x(s.t), kStepTop, kStepBottom);
  }
  return svg_ + "</svg>\n";
}

}  // namespace

std::string step_plot(const std::vector<StepQuality>& steps) { return Plot(steps)(); }

}  // namespace umtet
