#include "mesh/second_order/quadratic_tets.h"

#include <stdexcept>

#include "mesh/second_order/mid_side_numbers.h"
#include "mesh/second_order/mid_side_projection.h"
#include "mesh/second_order/mid_side_relaxation.h"

namespace umtet {

std::vector<std::string> problems(const SecondOrderParams& params) {
  std::vector<std::string> all = problems(params.closest_point);
  if (!(params.target > 0 && params.target < 1)) all.emplace_back("target: must be between 0 and 1");
  if (!(params.least >= 0 && params.least <= params.target)) all.emplace_back("least: must be in [0, target]");
  if (params.sweeps < 0) all.emplace_back("sweeps: must be >= 0");
  return all;
}

SecondOrder quadratic_tets(const TetMesh& mesh, const std::vector<Triangle>& curved_faces, ImplicitFunctionRef psi,
                           double h, const SecondOrderParams& params, const Context& context) {
  std::string broken;
  for (const std::string& problem : problems(params)) broken += (broken.empty() ? "" : "; ") + problem;
  if (!(h > 0)) broken += "; h: must be > 0";
  if (!broken.empty()) throw std::invalid_argument("quadratic_tets: " + broken);

  const std::size_t n_corners = mesh.V.size();
  SecondOrder result;
  std::vector<MidSide> kind;
  std::vector<CurvedEdge> edges;
  {
    const MidSideNumbers number(mesh.C, n_corners);
    context.poll();
    result.mesh = number.straight_mesh(mesh);
    edges = edges_of_faces(curved_faces, number, n_corners);
    kind.assign(number.n_edges(), MidSide::Free);
  }
  std::vector<Vec3>& V = result.mesh.V;
  result.n_psi_evaluations = project_mid_sides(edges, psi, h, params.closest_point, V, kind, context);
  for (const CurvedEdge& e : edges) result.n_unprojected += kind[e.mid_side - n_corners] == MidSide::Fixed;

  std::vector<int> below = tets_below(result.mesh, kind, params.target, context);
  if (!below.empty()) {
    const std::vector<Vec3> before(V.begin() + static_cast<std::ptrdiff_t>(n_corners), V.end());
    MidSideRelaxation relaxation(result.mesh, n_corners, kind, psi, h, params);
    result.n_psi_evaluations += relaxation.relax(below, context);
    relaxation.retreat(below);
    for (std::size_t m = 0; m < kind.size(); ++m) {
      const bool moved = V[n_corners + m] != before[m];
      result.n_slid += moved && kind[m] == MidSide::Surface;
      result.n_relaxed += moved && kind[m] == MidSide::Free;
    }
  }
  for (const CurvedEdge& e : edges) {
    result.boundary_mid_sides.push_back(e.mid_side);
    if (kind[e.mid_side - n_corners] == MidSide::Fixed) result.off_surface.push_back(e.mid_side);
  }
  return result;
}

}  // namespace umtet
