#include "pipeline/output/report_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace umtet {
namespace {

// Dimensions of the document and of the axes in it, in drawing units.
constexpr double kWidth = 560, kHeight = 300, kLeft = 62, kRight = 530, kTop = 34, kBottom = 250;
constexpr double kLegendStep = 17, kCharacter = 6.2;

struct Axis {
  bool log = false;
  double first = std::numeric_limits<double>::infinity(), last = -first;

  bool shows(double v) const { return std::isfinite(v) && (!log || v > 0); }
  double place(double v) const { return log ? std::log10(v) : v; }
  void extend(double v) {
    first = std::min(first, place(v));
    last = std::max(last, place(v));
  }
  double fraction(double v) const { return (place(v) - first) / (last - first); }
  std::vector<double> round_off();
};

/// Extends the axis to round numbers; returns the ticks.
std::vector<double> Axis::round_off() {
  if (!(last >= first)) first = 0, last = 1;
  if (last - first < 1e-12 * std::max(1., std::abs(last))) last = first + 1;
  double step = 1;
  if (!log) {
    step = std::pow(10, std::floor(std::log10((last - first) / 4)));
    for (const double factor : {5., 2.}) {
      if ((last - first) / (factor * step) >= 4) {
        step *= factor;
        break;
      }
    }
  } else if (last - first > 8) {
    step = std::ceil((last - first) / 8);
  }
  // Rounding errors must not add a step.
  first = step * std::floor(first / step + 1e-9);
  last = step * std::ceil(last / step - 1e-9);
  std::vector<double> ticks;
  const int n = static_cast<int>(std::lround((last - first) / step));
  for (int k = 0; k <= n; ++k) {
    const double at = first + k * step;
    ticks.push_back(log ? std::pow(10, at) : std::abs(at) < step / 2 ? 0 : at);
  }
  return ticks;
}

/// Writes 0.0001 to 1000000 in full, for which an axis has room.
std::string tick_text(double t) {
  return t != 0 && (std::abs(t) < 1e-4 || std::abs(t) > 1e6) ? fmt::format("{:.0e}", t) : fmt::format("{:.7g}", t);
}

class LinePlot {
 public:
  LinePlot(const PlotAxes& axes, const std::vector<PlotCurve>& curves)
      : axes_(axes), curves_(curves), x_{axes.log_x}, y_{axes.log_y} {}
  std::string operator()();

 private:
  double px(double x) const { return kLeft + (kRight - kLeft) * x_.fraction(x); }
  double py(double y) const { return kBottom + (kTop - kBottom) * y_.fraction(y); }
  void text(double x, double y, const char* anchor, const std::string& words, const char* more = "") {
    svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more, words);
  }
  void draw_axes();
  void draw_curve(const PlotCurve& curve);
  void draw_legend();

  const PlotAxes& axes_;
  const std::vector<PlotCurve>& curves_;
  Axis x_, y_;
  std::string svg_;
};

void LinePlot::draw_axes() {
  for (const double t : y_.round_off()) {
    svg_ += fmt::format("<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>\n", kLeft, py(t), kRight);
    text(kLeft - 6, py(t) + 4, "end", tick_text(t));
  }
  for (const double t : x_.round_off()) {
    svg_ += fmt::format("<path class=\"grid\" d=\"M{:.1f} {}V{}\"/>\n", px(t), kTop, kBottom);
    text(px(t), kBottom + 17, "middle", tick_text(t));
  }
  text(kLeft, 18, "start", axes_.title, " class=\"title\"");
  text((kLeft + kRight) / 2, kBottom + 37, "middle", axes_.x_label);
  text(14, (kTop + kBottom) / 2, "middle", axes_.y_label,
       fmt::format(" transform=\"rotate(-90 14 {})\"", (kTop + kBottom) / 2).c_str());
}

void LinePlot::draw_curve(const PlotCurve& curve) {
  std::string points;
  for (const auto& [x, y] : curve.points) {
    if (x_.shows(x) && y_.shows(y)) points += fmt::format("{:.1f},{:.1f} ", px(x), py(y));
  }
  svg_ += fmt::format("<polyline class=\"curve {}\" points=\"{}\"/>\n", curve.css_class, points);
}

/// Draws the legend on a panel at the left, where quality vectors leave room below the final mesh and above the
/// projected mesh.
void LinePlot::draw_legend() {
  std::size_t longest = 0;
  double n = 0;
  for (const PlotCurve& c : curves_) {
    longest = std::max(longest, c.name.size());
    n += !c.name.empty();
  }
  if (n < 2) return;
  const double width = kCharacter * static_cast<double>(longest) + 50, left = kLeft + 10;
  double y = kTop + .36 * (kBottom - kTop);
  svg_ += fmt::format("<rect class=\"panel\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"4\"/>\n",
                      left, y, width, n * kLegendStep + 8);
  for (const PlotCurve& c : curves_) {
    if (c.name.empty()) continue;
    svg_ += fmt::format("<path class=\"curve {}\" d=\"M{:.1f} {:.1f}h24\"/>\n", c.css_class, left + 8, y + 12);
    text(left + 38, y + 16, "start", c.name);
    y += kLegendStep;
  }
}

std::string LinePlot::operator()() {
  for (const PlotCurve& c : curves_) {
    for (const auto& [x, y] : c.points) {
      if (!x_.shows(x) || !y_.shows(y)) continue;
      x_.extend(x);
      y_.extend(y);
    }
  }
  svg_ = fmt::format("<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", kWidth, kHeight,
                     axes_.title);
  draw_axes();
  for (const PlotCurve& c : curves_) draw_curve(c);
  draw_legend();
  return svg_ + "</svg>\n";
}

}  // namespace

std::string line_plot(const PlotAxes& axes, const std::vector<PlotCurve>& curves) { return LinePlot(axes, curves)(); }

std::vector<std::array<double, 2>> histogram_outline(const std::vector<double>& heights, double first, double last) {
  std::vector<std::array<double, 2>> outline;
  const double bin = (last - first) / static_cast<double>(heights.size());
  for (std::size_t k = 0; k < heights.size(); ++k) {
    outline.push_back({first + static_cast<double>(k) * bin, heights[k]});
    outline.push_back({first + static_cast<double>(k + 1) * bin, heights[k]});
  }
  return outline;
}

}  // namespace umtet
