#include "body/fidelity/volume_match.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "common/polled_loops.h"
#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

// Relative differences of volume: below the first the volumes count as equal, and below the second the rounds end.
constexpr double kSame = 1e-3, kSettled = 1e-5;
constexpr int kRounds = 3;
// In h: a shift of more is no correction, but another body.
constexpr double kMostShift = .1;
// In h: vertices on psi = 0 are much nearer, those that have stepped back much farther.
constexpr double kOnSurface = 1e-6;
// Of its mean ratio, that a tet has to keep.
constexpr double kKept = .5;

double volume_of(const std::vector<Vec3>& V, const std::vector<Tet>& C) {
  double sum = 0;
  for (const Tet& t : C) sum += (V[t[1]] - V[t[0]]).cross(V[t[2]] - V[t[0]]).dot(V[t[3]] - V[t[0]]) / 6;
  return sum;
}

double area_of(const std::vector<Vec3>& V, const std::vector<Triangle>& faces) {
  double sum = 0;
  for (const Triangle& f : faces) sum += (V[f[1]] - V[f[0]]).cross(V[f[2]] - V[f[0]]).norm() / 2;
  return sum;
}

}  // namespace

bool match_volume(Domain& domain, double h, const ClosestPointParams& params, UmResult& result,
                  const Context& context) {
  if (!domain.triangles || !domain.triangles->body.is_closed || !domain.fitted || domain.complement) return false;
  const double wanted = domain.triangles->body.volume;
  const std::vector<Tet>& C = result.submesh.mesh.C;
  const std::vector<Vec3> before = result.final;
  double volume = volume_of(before, C);
  if (std::abs(volume / wanted - 1) <= kSame) return true;
  std::vector<int> on_surface;
  for (const int v : result.submesh.positive_vertices) {
    Vec3 g;
    const double psi = domain.psi().value(before[v], g);
    if (std::abs(psi) <= kOnSurface * h * g.norm()) on_surface.push_back(v);
  }
  const double area = area_of(before, result.submesh.positive_faces);
  double shift = domain.level_shift;
  const double at_first = shift;
  const auto give_up = [&] {
    result.final = before;
    domain.shift_level(at_first, h);
    return false;
  };
  for (int round = 0; round < kRounds && std::abs(volume / wanted - 1) > kSettled; ++round) {
    shift += (wanted - volume) / area;
    if (!(std::abs(shift) <= kMostShift * h)) return give_up();
    domain.shift_level(shift, h);
    std::atomic<bool> all_found = true;
    polled_parallel_for(on_surface.size(), kValuesPerPoll, context, [&](std::size_t i) {
      const int v = on_surface[i];
      const ClosestPoint foot = closest_point(domain.psi(), before[v], h, params);
      if (!foot.converged) all_found = false;
      result.final[v] = foot.point;
    });
    if (!all_found) return give_up();
    volume = volume_of(result.final, C);
  }
  const bool is_kept = std::all_of(C.begin(), C.end(), [&](const Tet& t) {
    const auto q = [&t](const std::vector<Vec3>& V) { return mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]); };
    return q(result.final) >= kKept * q(before);
  });
  if (!is_kept || std::abs(volume / wanted - 1) > kSame) return give_up();
  return true;
}

}  // namespace umtet
