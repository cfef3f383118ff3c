#include "pipeline/output/inspect_formula.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "body/body.h"
#include "body/pieces/zero_set_choice.h"
#include "body/piecewise_body.h"
#include "body/sizing/background_choice.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/domain/body_options.h"
#include "pipeline/domain/load_domain.h"

namespace umtet {
namespace {

/// @param on_boundary  points of psi = 0, at most about h apart
FormulaInspection::Edges edges_of(const PiecewiseDomain& body, const std::vector<Vec3>& on_boundary, double h) {
  FormulaInspection::Edges edges;
  std::set<int> patches;
  for (const Vec3& x : on_boundary) patches.insert(body.active(x));
  const FeatureGraph graph = trace_features(body, on_boundary, h, until_interrupted());
  for (const FeatureCurve& curve : graph.curves) {
    patches.insert(curve.patches.begin(), curve.patches.end());
    edges.length += curve.length();
    const auto [least, most] = std::minmax_element(curve.angle_deg.begin(), curve.angle_deg.end());
    const bool is_first = edges.max_angle_deg == 0;
    edges.min_angle_deg = is_first ? *least : std::min(edges.min_angle_deg, *least);
    edges.max_angle_deg = std::max(edges.max_angle_deg, *most);
  }
  edges.n_patches = patches.size();
  edges.n_curves = graph.curves.size();
  edges.n_corners = graph.corners.size();
  edges.n_faults = graph.defects.size();
  return edges;
}

}  // namespace

FormulaInspection inspect_formula(const Parameters& parameters, Progress& progress) {
  progress.report("inspect", "survey", 0);
  Domain domain = formula_domain(parameters);
  BackgroundChoice background(body_options(parameters), domain);
  const double h = background.edge_length(domain, until_interrupted()).h;
  FormulaInspection found;
  found.formula = parameters.mesh().implicit;
  found.prediction = prediction_of(h, background.expected_tets(domain, h), 0, parameters);
  progress.report("inspect", "edges", .5);
  const ZeroSetChoice pieces = choose_components(domain, h, until_interrupted());
  found.n_pieces = pieces.seeds.size();
  for (const std::size_t c : pieces.kept) {
    for (const double a : pieces.topology.areas_of(pieces.topology.components[c])) found.area += a;
  }
  if (domain.piecewise) found.edges = edges_of(domain.piecewise->domain, kept_points(pieces), h);
  return found;
}

Json to_json(const FormulaInspection& found) {
  Json json = {{"formula", found.formula},
               {"area", found.area},
               {"pieces", found.n_pieces},
               {"edges", Json(nullptr)},
               {"prediction", to_json(found.prediction)}};
  if (const auto& e = found.edges) {
    json["edges"] = {{"curves", e->n_curves},
                     {"corners", e->n_corners},
                     {"patches", e->n_patches},
                     {"faults", e->n_faults},
                     {"length", e->length},
                     {"min_angle_deg", e->min_angle_deg},
                     {"max_angle_deg", e->max_angle_deg}};
  }
  return json;
}

std::string inspection_text(const FormulaInspection& found) {
  std::string out = fmt::format("formula   {}\nboundary  {} piece{}, area about {:.3g}\n", found.formula,
                                found.n_pieces, found.n_pieces == 1 ? "" : "s", found.area);
  if (const auto& e = found.edges) {
    out += fmt::format("edges     {} sharp edges, {} corners, {} patches", e->n_curves, e->n_corners, e->n_patches);
    if (e->n_curves > 0) {
      out += fmt::format("; length {:.4g}, dihedral angles {:.3g} to {:.3g} degrees", e->length, e->min_angle_deg,
                         e->max_angle_deg);
    }
    if (e->n_faults > 0) out += fmt::format("; curves break off at {} places", e->n_faults);
    out += "\n";
  } else {
    out += "edges     none: the formula is smooth\n";
  }
  return out + prediction_text(found.prediction);
}

}  // namespace umtet
