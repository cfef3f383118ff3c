#include "mesh/paper/boundary_dvr.h"

#include <Eigen/Geometry>
#include <atomic>
#include <cmath>
#include <numbers>

#include "mesh/core/max_min.h"
#include "mesh/paper/relaxation_direction.h"

namespace umtet {
namespace {

// Random tangents share the hash with the random directions of dvr; this keeps the two apart.
constexpr std::uint64_t kTangentStream = 0x74616e67656e7473ULL;
// A vector closer than this to the normal (1 in 5000) has a tangential part of few digits.
constexpr double kLeastTangent = .02;

/// d_i                                                                    Alg. 3, step 48
/// The first tangent of a vertex is a random vector projected onto the tangent plane, as in the paper. Each next one is
/// turned by the golden section of a half-turn: any few successive tangents are well spread, where independent
/// random ones leave some vertex without a useful direction for many iterations.
Vec3 tangent(const Vec3& normal, std::uint64_t seed, int iteration, std::int64_t vertex) {
  const Vec3 random = random_unit_vector(seed ^ kTangentStream, 0, vertex);
  const Vec3 projected = random - random.dot(normal) * normal;
  const double norm = projected.norm();
  const Vec3 first = norm > kLeastTangent ? Vec3(projected / norm) : normal.unitOrthogonal();
  const double angle = iteration * (std::numbers::pi / std::numbers::phi);
  return std::cos(angle) * first + std::sin(angle) * normal.cross(first);
}

/// Steps 48-55 for one vertex. Returns the evaluations of psi.
std::size_t relax_on_boundary(MovingMesh& mesh, int i, std::int64_t background_vertex, ImplicitFunctionRef psi,
                              const BoundaryDvrParams& params, int iteration) {
  const Vec3 x = mesh.V[i];
  Vec3 gradient;
  psi.value(x, gradient);
  std::size_t evaluations = 1;
  const double norm = gradient.norm();
  if (!(norm > 0)) return evaluations;
  const Vec3 d = tangent(gradient / norm, params.seed, iteration, background_vertex);
  const OneRing ring = mesh.ring(i);
  double best = ring.f_here * (1 + kLeastGain);
  Vec3 place = x;
  for (int s = -params.samples; s <= params.samples; ++s) {
    if (s == 0) continue;
    const Vec3 candidate = x + params.h * s / params.samples * d;
    const ClosestPoint foot = closest_point(psi, candidate, params.h, params.closest_point);
    evaluations += static_cast<std::size_t>(foot.iterations);
    if (!foot.converged) continue;
    const double f = ring.min_f(foot.point - x);
    if (f > best) best = f, place = foot.point;
  }
  if (place != x) mesh.move(i, place);  // steps 53-54
  return evaluations;
}

}  // namespace

std::size_t boundary_dvr(MovingMesh& mesh, const RelaxationOrder& boundary,
                         std::span<const std::int64_t> background_vertex, ImplicitFunctionRef psi,
                         const BoundaryDvrParams& params, int iteration) {
  std::atomic<std::size_t> n_evaluations = 0;
  const auto relax = [&](int i) {
    const std::size_t n = relax_on_boundary(mesh, i, background_vertex[i], psi, params, iteration);
    n_evaluations.fetch_add(n, std::memory_order_relaxed);
  };
  boundary.for_each([](int) { return true; }, relax, psi.side_by_side());
  return n_evaluations;
}

}  // namespace umtet
