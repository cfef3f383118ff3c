#include "mesh/fast/defects/patch_state.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "mesh/core/max_min.h"
#include "mesh/core/tet_quality.h"
#include "mesh/implicit/closest_point.h"

namespace umtet {

double normal_cosine(ImplicitFunctionRef psi, const Vec3& a, const Vec3& b, const Vec3& c, double h,
                     std::size_t& evaluations) {
  constexpr int kSteps = 4;  // from within h; where these do not arrive, the gradient on the way has to do
  // A normal that turns by .05 over .05 h does not lead from here to kMisalignedCosine.
  constexpr double kSure = .9, kNear = .05;
  const Vec3 centroid = (a + b + c) / 3;
  Vec3 y = centroid, g;
  const Vec3 n = (b - a).cross(c - a);
  const auto cosine = [&] {
    const double lengths = n.norm() * g.norm();
    return lengths > 0 ? n.dot(g) / lengths : -1.;
  };
  double value = psi.value(y, g);
  ++evaluations;
  for (int k = 0; k < kSteps; ++k) {
    const double slope = g.norm();
    if (!(slope > 0) || std::abs(value) <= 1e-3 * h * slope) break;
    if (std::abs(value) <= kNear * h * slope && cosine() >= kSure) break;
    y -= std::clamp(value / slope, -.5 * h, .5 * h) / slope * g;
    value = psi.value(y, g);
    ++evaluations;
  }
  // At a sharp edge of the domain the steps above may end at a point that is not the closest one.
  if (cosine() < kSure) {
    const ClosestPoint foot = closest_point(psi, centroid, h, {});
    evaluations += static_cast<std::size_t>(foot.iterations) + 1;
    if (foot.converged) psi.value(foot.point, g);
  }
  return cosine();
}

bool positive_face(const Tet& tet, const std::vector<std::uint8_t>& inside, Triangle& face) {
  int apex = -1;
  for (int k = 0; k < 4; ++k) {
    if (inside[tet[k]] == 0) continue;
    if (apex >= 0) return false;
    apex = k;
  }
  if (apex < 0) return false;
  const auto& f = kTetFace[apex];
  face = {tet[f[0]], tet[f[1]], tet[f[2]]};
  return true;
}

bool PatchState::is_no_worse_than(const PatchState& other) const {
  return least >= std::min(other.least, target) && below_target <= other.below_target &&
         misaligned <= other.misaligned && folded_over <= other.folded_over &&
         (misaligned < other.misaligned || least_cosine >= std::min(other.least_cosine, kMisalignedCosine));
}

bool PatchState::is_better_than(const PatchState& other) const {
  const auto key = [](const PatchState& s) {
    return std::tuple(s.folded_over, s.misaligned + s.below_target, -std::min(s.least, s.target),
                      -std::min(s.least_cosine, kMisalignedCosine));
  };
  return key(*this) < key(other);
}

PatchState tet_state(const ActiveLayer& layer, double target) {
  PatchState s;
  s.target = target;
  // Q^3 in place of Q: no roots but the last.
  const double below_target_f = std::pow(target / kMeanRatioFactor, 3);
  double least_f = std::pow(1 / kMeanRatioFactor, 3);
  for (const Tet& t : layer.C) {
    const Vec3 &a = layer.V[t[0]], &b = layer.V[t[1]], &c = layer.V[t[2]], &d = layer.V[t[3]];
    const double V = volume6(a, b, c, d), L = sum_of_squared_edges(a, b, c, d), f = V * std::abs(V) / (L * L * L);
    least_f = std::min(least_f, f);
    s.below_target += f < below_target_f;
  }
  s.least = quality_of(least_f);
  return s;
}

PatchState patch_state(const ActiveLayer& layer, const std::vector<std::uint8_t>& inside, ImplicitFunctionRef psi,
                       double target, std::size_t& evaluations) {
  PatchState s = tet_state(layer, target);
  std::vector<Triangle> faces;
  Triangle face;
  for (const Tet& t : layer.C) {
    if (positive_face(t, inside, face)) faces.push_back(face);
  }
  std::vector<double> cosines(faces.size());
  const auto measure = [&](std::size_t k) {
    const Triangle& f = faces[k];
    cosines[k] = normal_cosine(psi, layer.V[f[0]], layer.V[f[1]], layer.V[f[2]], layer.h_at(f[0]), evaluations);
  };
  if (const SideBySide* side_by_side = psi.side_by_side()) {
    side_by_side->for_each(faces.size(), measure);
  } else {
    for (std::size_t k = 0; k < faces.size(); ++k) measure(k);
  }
  for (const double cosine : cosines) {
    s.least_cosine = std::min(s.least_cosine, cosine);
    s.misaligned += cosine < kMisalignedCosine;
    s.folded_over += cosine < 0;
  }
  return s;
}

}  // namespace umtet
