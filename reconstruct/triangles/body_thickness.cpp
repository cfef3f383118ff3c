#include "reconstruct/triangles/body_thickness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/polled_loops.h"

namespace umtet {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Of the limit: nearer hits are the triangle itself, or bodies that touch.
constexpr double kSelf = 1e-6;
// Cosine between sheets that face each other or look away from each other, and the planes of which meet: from 30
// degrees on a wedge is no thin part, however far its ridge is.
constexpr double kFacing = -.866;
// The ridge of a wedge, by its planes, is this near to the surface, in thicknesses: off by rounding where it is sharp,
// by its radius where it is rounded.
constexpr double kRidge = .25;

class Rays {
 public:
  Rays(const TriangleMesh& mesh, const TriangleTree& tree, double limit) : mesh_(mesh), tree_(tree), limit_(limit) {}

  /// @param side  -1: through the body, 1: outside
  double along(const Vec3& x, std::uint32_t face, double side) const {
    const Vec3 n = mesh_.area_vector(face).normalized();
    const auto faces_it = [&](std::uint32_t g) { return mesh_.area_vector(g).dot(n) < 0; };
    const auto hit = tree_.first_on_ray(x, side * n, kSelf * limit_, limit_, faces_it);
    if (!hit) return kInfinity;
    const Vec3 m = mesh_.area_vector(hit->face).normalized();
    const double cosine = m.dot(n);
    if (cosine > kFacing || is_wedge(x, n, m, side, hit->distance)) return kInfinity;
    return hit->distance;
  }

 private:
  bool is_wedge(const Vec3& x, const Vec3& n, const Vec3& m, double side, double t) const {
    const Vec3 along = m - m.dot(n) * n;
    const double sine = along.norm();
    const double off = t * -m.dot(n) / sine;  // t / tan(angle)
    if (!(off < limit_ / kSelf)) return false;
    const Vec3 ridge = x - side * off / sine * along;
    return tree_.nearest(ridge, kRidge * t, [](std::uint32_t) { return true; }).has_value();
  }

  const TriangleMesh& mesh_;
  const TriangleTree& tree_;
  const double limit_;
};

}  // namespace

std::vector<FacingSheets> facing_sheets(const TriangleMesh& mesh, const TriangleTree& tree,
                                        const std::vector<Vec3>& points, const std::vector<std::uint32_t>& faces,
                                        double limit, const Context& context) {
  std::vector<FacingSheets> found(points.size());
  const Rays rays(mesh, tree, limit);
  polled_parallel_for(points.size(), kValuesPerPoll, context, [&](std::size_t i) {
    found[i] = {rays.along(points[i], faces[i], -1), rays.along(points[i], faces[i], 1)};
  });
  return found;
}

std::vector<double> sheet_thickness(const TriangleMesh& mesh, const TriangleTree& tree, const std::vector<Vec3>& points,
                                    const std::vector<std::uint32_t>& faces, double limit, const Context& context) {
  std::vector<double> t;
  for (const FacingSheets& s : facing_sheets(mesh, tree, points, faces, limit, context))
    t.push_back(std::min(s.body, s.gap));
  return t;
}

double thin_share_of(std::vector<double> thickness, double share) {
  if (thickness.empty()) return kInfinity;
  const auto at = thickness.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(thickness.size() - 1));
  std::nth_element(thickness.begin(), at, thickness.end());
  return *at;
}

}  // namespace umtet
