#include "mesh/patches/planar_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "mesh/patches/detail/shared_edges.h"
#include "mesh/patches/patches.h"

namespace umtet {
namespace {

// Planes settle in two or three rounds; those that do not are of something round, and are not kept.
constexpr int kRounds = 8;

/// The angle between unit vectors, without the loss of acos near 0.
double angle_between(const Vec3& a, const Vec3& b) { return 2 * std::atan2((a - b).norm(), (a + b).norm()); }

class PlaneFinder {
 public:
  PlaneFinder(const std::vector<Vec3>& V, const std::vector<Triangle>& F, double angle, double least);
  std::vector<int> operator()();

 private:
  std::vector<int> faces_of(int seed, const Vec3& normal);
  Vec3 mean_normal(const std::vector<int>& faces) const;
  bool is_flat(const std::vector<int>& faces, const Vec3& normal);
  std::vector<int> grown(int seed);

  const std::vector<Vec3>& V_;
  const std::vector<Triangle>& F_;
  double angle_, least_;
  FaceGeometry faces_;
  std::vector<std::array<int, 3>> neighbours_;  ///< -1: none
  std::vector<double> bend_;                    ///< largest angle to a neighbour
  std::vector<int> plane_of_;                   ///< -1: none yet
  std::vector<int> n_outside_;                  ///< by node: boundary faces at it; less those of a plane in is_flat()
  std::vector<int> seen_in_;                    ///< the last search that met the face
  int n_searches_ = 0;
};

PlaneFinder::PlaneFinder(const std::vector<Vec3>& V, const std::vector<Triangle>& F, double angle, double least)
    : V_(V),
      F_(F),
      angle_(angle),
      least_(least),
      faces_(face_geometry(V, F)),
      neighbours_(F.size(), {-1, -1, -1}),
      bend_(F.size(), 0),
      plane_of_(F.size(), -1),
      n_outside_(V.size(), 0),
      seen_in_(F.size(), 0) {
  for (const detail::SharedEdge& e : detail::shared_edges(F)) {
    const double bend = angle_between(faces_.normal[e.face], faces_.normal[e.other]);
    for (const auto& [f, g] : {std::pair(e.face, e.other), std::pair(e.other, e.face)}) {
      *std::find(neighbours_[f].begin(), neighbours_[f].end(), -1) = g;
      bend_[f] = std::max(bend_[f], bend);
    }
  }
  for (const Triangle& face : F) {
    for (const int v : face) ++n_outside_[v];
  }
}

/// The free faces with about this normal that a way over such faces leads to, the seed first; none when it has another.
std::vector<int> PlaneFinder::faces_of(int seed, const Vec3& normal) {
  ++n_searches_;
  std::vector<int> found;
  const auto meet = [&](int f) {
    if (f < 0 || seen_in_[f] == n_searches_ || plane_of_[f] >= 0) return;
    seen_in_[f] = n_searches_;
    if (angle_between(faces_.normal[f], normal) <= angle_) found.push_back(f);
  };
  meet(seed);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const int g : neighbours_[found[i]]) meet(g);
  }
  return found;
}

Vec3 PlaneFinder::mean_normal(const std::vector<int>& faces) const {
  Vec3 sum = Vec3::Zero();
  for (const int f : faces) sum += faces_.area[f] * faces_.normal[f];
  return sum.stableNormalized();
}

bool PlaneFinder::is_flat(const std::vector<int>& faces, const Vec3& normal) {
  const auto count = [&](int step) {
    for (const int f : faces) {
      for (const int v : F_[f]) n_outside_[v] += step;
    }
  };
  count(-1);
  double area = 0, sum = 0, inner = 0;
  for (const int f : faces) {
    const double a = angle_between(faces_.normal[f], normal);
    area += faces_.area[f];
    sum += faces_.area[f] * a * a;
    const Triangle& face = F_[f];
    if (std::any_of(face.begin(), face.end(), [&](int v) { return n_outside_[v] == 0; })) inner += faces_.area[f];
  }
  count(1);
  return inner >= least_ && sum <= area * angle_ * angle_ / 9;
}

/// The faces of the plane around a seed, or none. The faces that are met are no seeds any more (bend_ < 0).
std::vector<int> PlaneFinder::grown(int seed) {
  Vec3 normal = faces_.normal[seed];
  std::vector<int> faces;
  bool stays = false;
  for (int round = 0; round < kRounds && !stays; ++round) {
    std::vector<int> next = faces_of(seed, normal);
    if (next.empty()) break;
    std::sort(next.begin(), next.end());
    stays = next == faces;
    faces = std::move(next);
    if (!stays) normal = mean_normal(faces);
  }
  bend_[seed] = -1;
  for (const int f : faces) bend_[f] = -1;
  return stays && is_flat(faces, normal) ? faces : std::vector<int>{};
}

std::vector<int> PlaneFinder::operator()() {
  std::vector<int> seeds(F_.size());
  std::iota(seeds.begin(), seeds.end(), 0);
  const std::vector<double> bend = bend_;
  std::stable_sort(seeds.begin(), seeds.end(), [&](int a, int b) { return bend[a] < bend[b]; });
  std::vector<double> area;
  for (const int seed : seeds) {
    // Around a vertex inside a plane all faces are within the angle of it.
    if (bend[seed] > 2 * angle_) break;
    if (plane_of_[seed] >= 0 || bend_[seed] < 0) continue;
    const std::vector<int> faces = grown(seed);
    if (faces.empty()) continue;
    for (const int f : faces) plane_of_[f] = static_cast<int>(area.size());
    area.push_back(0);
  }
  absorb_islands(V_, F_, least_, plane_of_);
  for (std::size_t f = 0; f < F_.size(); ++f) {
    if (plane_of_[f] >= 0) area[plane_of_[f]] += faces_.area[f];
  }
  std::vector<int> order(area.size()), number(area.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return area[a] > area[b]; });
  for (std::size_t i = 0; i < order.size(); ++i) number[order[i]] = static_cast<int>(i);
  for (int& p : plane_of_) p = p < 0 ? -1 : number[p];
  return std::move(plane_of_);
}

}  // namespace

std::vector<int> planar_pieces(const std::vector<Vec3>& V, const std::vector<Triangle>& F, double angle, double least) {
  if (!(angle > 0 && angle < 90)) throw std::invalid_argument("planar_pieces: the angle must be in (0, 90)");
  return PlaneFinder(V, F, angle * std::numbers::pi / 180, least)();
}

}  // namespace umtet
