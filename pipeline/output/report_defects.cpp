#include "pipeline/output/report_defects.h"

#include <fmt/format.h>

#include <optional>

#include "pipeline/output/report_page.h"

namespace umtet {
namespace {

const char* said_of(DefectKind kind) {
  switch (kind) {
    case DefectKind::Folded:
      return "folded over";
    case DefectKind::Off:
      return "off ψ = 0";
    case DefectKind::Filled:
      return "gap filled";
    case DefectKind::Cut:
      return "body cut away";
    case DefectKind::Thin:
      return "thin part lost";
    case DefectKind::Topology:
      return "components or handles that differ";
    case DefectKind::Missed:
      return "samples missed";
    case DefectKind::Edges:
      return "sharp edges or corners lost";
  }
  return "";
}

}  // namespace

std::string hole_table(const Certificate& c) {
  const std::optional<SupportReport>& support = c.measured.domain.support;
  if (!support || support->closed_holes.empty()) return "";
  const std::string unit = c.units ? ", " + html_text(*c.units) : "";
  std::string rows = fmt::format(
      "<tr><th></th><th>centre{0}</th><th>area</th><th>share of the boundary</th><th>farthest from a sample{0}</th>"
      "<th>in spacings</th><th>width{0}</th><th>length of the rim{0}</th><th>rims</th></tr>\n",
      unit);
  double part = 0;
  for (std::size_t k = 0; k < support->closed_holes.size(); ++k) {
    const ClosedHole& hole = support->closed_holes[k];
    part += hole.area_fraction;
    rows += fmt::format(
        "<tr><td><button type=\"button\" data-hole=\"{}\">show {}</button></td><td>({:.4g}, {:.4g}, {:.4g})</td>"
        "<td>{:.3g}</td><td>{:.2g} %</td><td>{:.3g}</td><td>{:.0f}</td>"
        "<td>{:.3g}</td><td>{:.3g}</td><td>{}</td></tr>\n",
        k, k + 1, hole.centre.x(), hole.centre.y(), hole.centre.z(), hole.area, 100 * hole.area_fraction, hole.deepest,
        hole.deepest_over_spacing, hole.rim_diameter, hole.rim_length, hole.n_rims);
  }
  const std::size_t n = support->n_closed_holes, n_listed = support->closed_holes.size();
  const std::string rest = n > n_listed ? fmt::format(" These are the largest {} of {}.", n_listed, n) : "";
  return fmt::format(
      "<div class=\"table\" id=\"holes\"><h2>{} of the scan closed without samples: {}{:.2g} % of the boundary</h2>\n"
      "<p>No sample is near {} of the surface: the shape there is a guess of the fit. In exported files, it is the "
      "patch <code>closed_holes</code>, which extends to the surrounding samples.{}</p>\n<table>\n{}</table></div>\n",
      n == 1 ? "1 hole" : fmt::format("{} holes", n), n > n_listed ? "over " : "", 100 * part,
      n == 1 ? "this part" : "these parts", rest, rows);
}

std::string missed_table(const Certificate& c) {
  const std::optional<SampleDistances>& cloud = c.measured.cloud;
  if (!cloud || cloud->missed.empty()) return "";
  const std::string unit = c.units ? ", " + html_text(*c.units) : "";
  std::string rows = fmt::format(
      "<tr><th></th><th>farthest sample{0}</th><th>from the mesh{0}</th><th>in h</th><th>samples</th></tr>\n", unit);
  for (std::size_t k = 0; k < cloud->missed.size(); ++k) {
    const MissedPlace& p = cloud->missed[k];
    rows += fmt::format(
        "<tr><td>{}</td><td>({:.4g}, {:.4g}, {:.4g})</td><td>{:.3g}</td><td>{:.2g}</td><td>{}</td></tr>\n", k + 1,
        p.farthest.x(), p.farthest.y(), p.farthest.z(), p.distance, p.distance / c.measured.mesh.h, p.n_samples);
  }
  const std::size_t n = cloud->n_missed_places, n_listed = cloud->missed.size();
  const std::string rest = n > n_listed ? fmt::format(" These are the farthest {} of {}.", n_listed, n) : "";
  return fmt::format(
      "<div class=\"table\" id=\"missed\"><h2>Samples that the mesh misses</h2>\n<p>Neither noise nor flat faces "
      "explain why these samples are farther than {:.3g} from the mesh. Possible causes: detail that psi or h is too "
      "coarse for, a second sheet, "
      "outliers.{}</p>\n<table>\n{}</table></div>\n",
      cloud->missed_beyond, rest, rows);
}

std::string defect_table(const Certificate& c) {
  const DefectReport& defects = c.measured.defects;
  if (defects.empty()) return "";
  const std::string unit = c.units ? ", " + html_text(*c.units) : "";
  std::string rows = fmt::format(
      "<tr><th></th><th>what</th><th>where{0}</th><th>off, h</th><th>size, h</th><th>feature of ψ = 0, h</th><th>shown "
      "by h{0}</th>"
      "<th>of</th><th></th></tr>\n",
      unit);
  const auto number = [](const std::optional<double>& x) { return x ? fmt::format("{:.3g}", *x) : std::string("–"); };
  for (std::size_t k = 0; k < defects.listed.size(); ++k) {
    const MeshDefect& p = defects.listed[k];
    rows += fmt::format(
        "<tr><td><button type=\"button\" data-place=\"{}\">show {}</button></td><td>{}</td>"
        "<td>({:.4g}, {:.4g}, "
        "{:.4g})</td><td>{:.2g}</td><td>{:.2g}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        k, k + 1, said_of(p.kind), p.where.x(), p.where.y(), p.where.z(), p.off_over_h, p.size_over_h,
        number(p.feature_over_h), number(p.h_needed), p.n, is_small(p) ? "small" : "");
  }
  const std::size_t n = defects.n(), n_listed = defects.listed.size();
  const std::string rest = n > n_listed ? fmt::format(" These are the worst {} of {}.", n_listed, n) : "";
  return fmt::format(
      "<div class=\"table\" id=\"places\"><h2>Defects: where the mesh is not ψ = 0</h2>\n<p>A defect is small, and the "
      "mesh passes, "
      "if it is no deeper than h and no larger than {} h, or if ψ = 0 is finer than {} h, which this h cannot "
      "resolve.{}</p>\n<table>\n{}</table>"
      "</div>\n",
      kSmallSize, kLeastEdgesAcross, rest, rows);
}

}  // namespace umtet
