#include "mesh/second_order/mid_side_projection.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/second_order/jacobian_bounds.h"

namespace umtet {
namespace {

// A foot farther from the chord than this share of its length belongs to another part of psi = 0: the arc over it would
// be more than a half-circle.
constexpr double kMostSag = .5;
constexpr std::size_t kTetsPerPoll = 1 << 16;

}  // namespace

std::vector<CurvedEdge> edges_of_faces(const std::vector<Triangle>& faces, const MidSideNumbers& number,
                                       std::size_t n_corners) {
  std::vector<CurvedEdge> all;
  all.reserve(3 * faces.size());
  for (const Triangle& f : faces) {
    for (int k = 0; k < 3; ++k) {
      const int a = std::min(f[k], f[(k + 1) % 3]), b = std::max(f[k], f[(k + 1) % 3]), e = number(a, b);
      if (e < 0) throw std::invalid_argument("a face with an edge that no tet has");
      all.push_back({static_cast<int>(n_corners) + e, a, b});
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::size_t project_mid_sides(const std::vector<CurvedEdge>& edges, ImplicitFunctionRef psi, double h,
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

}  // namespace umtet
