#include "body/fidelity/mesh_thickness.h"

#include <algorithm>

#include "body/sizing/edge_length.h"
#include "body/sizing/sheets.h"

namespace umtet {
namespace {

// In edges: sheets farther than this do not matter.
constexpr double kFarthestSheet = 4;
// In edges: a step along the normal.
constexpr double kNormalStep = .25;

}  // namespace

VertexThickness vertex_thickness(const Domain& domain, const TetMesh& mesh, const std::vector<int>& boundary,
                                 const MeshEdge& h, const Context& context) {
  VertexThickness made;
  for (const int i : boundary) made.vertices.push_back(mesh.V[i]);
  if (made.vertices.empty()) return made;
  const std::vector<double> h_at = h.at(made.vertices);
  made.thickness = body_thickness(domain, made.vertices, h_at, kNormalStep, kFarthestSheet, context);
  made.least_over_h = kFarthestSheet;
  for (std::size_t i = 0; i < made.vertices.size(); ++i) {
    made.least_over_h = std::min(made.least_over_h, made.thickness[i] / h_at[i]);
    if (made.thickness[i] < kLeastEdgesAcross * h_at[i]) made.thin.push_back(made.vertices[i]);
  }
  return made;
}

PointThickness with_lost_parts(const VertexThickness& vertices, const std::vector<Difference>& lost,
                               const Domain& domain, const MeshEdge& h, const Context& context) {
  PointThickness all;
  for (const Difference& d : lost) all.points.push_back(d.where);
  all.thickness = body_thickness(domain, all.points, h.at(all.points), kNormalStep, kFarthestSheet, context);
  all.points.insert(all.points.end(), vertices.vertices.begin(), vertices.vertices.end());
  all.thickness.insert(all.thickness.end(), vertices.thickness.begin(), vertices.thickness.end());
  return all;
}

}  // namespace umtet
