#include "mesh/certify/quadratic_tets.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "mesh/certify/detail/mid_side_numbers.h"
#include "mesh/certify/detail/mid_side_relaxation.h"
#include "mesh/certify/jacobian_bounds.h"
#include "mesh/core/asking_psi.h"

namespace umtet {
namespace {

using detail::MidSide;

// A foot farther from the chord than this share of its length belongs to another part of psi = 0: the arc over it would
// be more than a half-circle.
constexpr double kMostSag = .5;
constexpr std::size_t kTetsPerPoll = 1 << 16;

/// An edge of the curved faces.
struct CurvedEdge {
  int mid_side, a, b;
  auto operator<=>(const CurvedEdge&) const = default;
};

std::vector<CurvedEdge> edges_of(const std::vector<Triangle>& faces, const detail::MidSideNumbers& number,
                                 std::size_t n_corners) {
  std::vector<CurvedEdge> all;
  all.reserve(3 * faces.size());
  for (const Triangle& f : faces) {
    for (int k = 0; k < 3; ++k) {
      const int a = std::min(f[k], f[(k + 1) % 3]), b = std::max(f[k], f[(k + 1) % 3]), e = number(a, b);
      if (e < 0) throw std::invalid_argument("quadratic_tets: a face with an edge that no tet has");
      all.push_back({static_cast<int>(n_corners) + e, a, b});
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// Step 1: mid-sides of the edges to psi = 0; those that find none near stay, and are Fixed.
/// @return evaluations of psi
std::size_t project(const std::vector<CurvedEdge>& edges, ImplicitFunctionRef psi, double h,
                    const ClosestPointParams& params, std::vector<Vec3>& V, std::vector<MidSide>& kind,
                    const Context& context) {
  const std::size_t n_corners = V.size() - kind.size();
  std::vector<int> evaluations(edges.size());
  for_each_asking(psi, edges.size(), kValuesPerPoll / 8, context, [&](std::size_t i) {
    const auto& [m, a, b] = edges[i];
    const ClosestPoint foot = closest_point(psi, V[m], h, params);
    const bool found = foot.converged && (foot.point - V[m]).norm() <= kMostSag * (V[b] - V[a]).norm();
    if (found) V[m] = foot.point;
    kind[m - n_corners] = found ? MidSide::Surface : MidSide::Fixed;
    evaluations[i] = foot.iterations;
  });
  return std::accumulate(evaluations.begin(), evaluations.end(), std::size_t{0});
}

/// The tets that may have a determinant below `bar` times its mean, of those with a curved edge.
std::vector<int> tets_below(const QuadraticTetMesh& mesh, const std::vector<MidSide>& kind, double bar,
                            const Context& context) {
  const std::size_t n_corners = mesh.V.size() - kind.size();
  std::vector<char> is_below(mesh.C.size(), 0);
  polled_parallel_for(mesh.C.size(), kTetsPerPoll, context, [&](std::size_t t) {
    const QuadraticTet& tet = mesh.C[t];
    const bool curved =
        std::any_of(tet.begin() + 4, tet.end(), [&](int m) { return kind[m - n_corners] == MidSide::Surface; });
    is_below[t] = curved && jacobian_bounds(nodes_of(mesh, tet)).scaled_lower() <= bar;
  });
  std::vector<int> below;
  for (std::size_t t = 0; t < is_below.size(); ++t) {
    if (is_below[t]) below.push_back(static_cast<int>(t));
  }
  return below;
}

}  // namespace

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
    const detail::MidSideNumbers number(mesh.C, n_corners);
    context.poll();
    result.mesh = number.straight_mesh(mesh);
    edges = edges_of(curved_faces, number, n_corners);
    kind.assign(number.n_edges(), MidSide::Free);
  }
  std::vector<Vec3>& V = result.mesh.V;
  result.n_psi_evaluations = project(edges, psi, h, params.closest_point, V, kind, context);
  for (const CurvedEdge& e : edges) result.n_unprojected += kind[e.mid_side - n_corners] == MidSide::Fixed;

  std::vector<int> below = tets_below(result.mesh, kind, params.target, context);
  if (!below.empty()) {
    const std::vector<Vec3> before(V.begin() + static_cast<std::ptrdiff_t>(n_corners), V.end());
    detail::MidSideRelaxation relaxation(result.mesh, n_corners, kind, psi, h, params);
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
