#include "mesh/implicit/surface_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nanoflann.hpp>
#include <stdexcept>
#include <string>

namespace umtet {
namespace {

struct PointSet {
  const std::vector<Vec3>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t k) const { return points[i][static_cast<Eigen::Index>(k)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using KdTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointSet>, PointSet, 3, std::uint32_t>;
constexpr std::size_t kLeafSize = 16;

void check_finite(const std::vector<Vec3>& points, const char* name) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite())
      throw std::invalid_argument(std::string(name) + " " + std::to_string(i) + " is not finite");
  }
}

double segment_distance2(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const double l2 = e.squaredNorm();
  const double s = l2 > 0 ? std::clamp((x - a).dot(e) / l2, 0.0, 1.0) : 0.0;
  return (x - a - s * e).squaredNorm();
}

double triangle_distance2(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const Vec3 n = ab.cross(ac);
  const double n2 = n.squaredNorm();
  if (n2 > 0) {
    // Barycentric coordinates of the foot point in the plane, times n2.
    const double gamma = ab.cross(ax).dot(n), beta = ax.cross(ac).dot(n);
    if (gamma >= 0 && beta >= 0 && gamma + beta <= n2) {
      const double height = ax.dot(n);
      return height * height / n2;
    }
  }
  return std::min({segment_distance2(x, a, b), segment_distance2(x, b, c), segment_distance2(x, c, a)});
}

struct CentredTriangle {
  std::array<Vec3, 3> corners;
  double reach;  ///< greatest centroid-corner distance, rounded up
};

/// What nanoflann calls a result set: sees centroids, keeps the least triangle distance, and shrinks the search radius
/// as it goes.
class NearestTriangle {
 public:
  /// @param reach  of all triangles
  /// @param bound  more than the distance that will be found
  NearestTriangle(const Vec3& x, const std::vector<CentredTriangle>& triangles, double reach,
                  double bound = std::numeric_limits<double>::infinity())
      : x_(x), triangles_(triangles), reach_(reach), best_(bound), worst2_((bound + reach) * (bound + reach)) {}
  std::size_t size() const { return full() ? 1 : 0; }
  bool full() const { return best_ < std::numeric_limits<double>::infinity(); }
  double worstDist() const { return worst2_; }
  /// @param centroid2  squared distance to the centroid. The tree calls worstDist() once a leaf; within one, most
  ///                   triangles are farther away than their own reach allows.
  bool addPoint(double centroid2, std::uint32_t k) {
    const CentredTriangle& t = triangles_[k];
    const double near = best_ + t.reach;
    if (centroid2 > near * near) return true;
    const double d = std::sqrt(triangle_distance2(x_, t.corners[0], t.corners[1], t.corners[2]));
    if (d < best_) {
      best_ = d;
      worst2_ = (d + reach_) * (d + reach_);
    }
    return true;
  }
  double distance() const { return best_; }

 private:
  const Vec3& x_;
  const std::vector<CentredTriangle>& triangles_;
  double reach_, best_, worst2_;
};

/// out[i] = f(i): which thread runs one cannot change a result.
template <typename F>
std::vector<double> map_indices(std::size_t n, const Context& context, F&& f) {
  std::vector<double> out(n);
  polled_parallel_for(n, kValuesPerPoll, context, [&](std::size_t i) { out[i] = f(i); });
  return out;
}

}  // namespace

struct SurfaceDistance::Index {
  std::vector<CentredTriangle> triangles;
  std::vector<Vec3> centroids;
  double reach = 0;     ///< the greatest of all
  double rounding = 0;  ///< more than what a distance may be off by
  PointSet set{centroids};
  std::unique_ptr<KdTree> tree;
};

SurfaceDistance::SurfaceDistance(const std::vector<Vec3>& V, const std::vector<Triangle>& faces)
    : index_(std::make_unique<Index>()) {
  if (faces.empty()) throw std::invalid_argument("distance to a surface without faces");
  index_->triangles.reserve(faces.size());
  index_->centroids.reserve(faces.size());
  double magnitude = 0;
  for (const Triangle& f : faces) {
    for (const int v : f) {
      if (v < 0 || static_cast<std::size_t>(v) >= V.size()) {
        throw std::invalid_argument("face vertex " + std::to_string(v) + " is out of range");
      }
      if (!V[v].allFinite()) throw std::invalid_argument("vertex " + std::to_string(v) + " is not finite");
      magnitude = std::max(magnitude, V[v].cwiseAbs().maxCoeff());
    }
    const std::array<Vec3, 3> t = {V[f[0]], V[f[1]], V[f[2]]};
    const Vec3 m = (t[0] + t[1] + t[2]) / 3.0;
    double reach = 0;
    for (const Vec3& corner : t) reach = std::max(reach, (corner - m).norm());
    index_->triangles.push_back({t, reach});
    index_->centroids.push_back(m);
  }
  index_->rounding = 1e-13 * magnitude;
  for (CentredTriangle& t : index_->triangles) {
    t.reach += 1e-14 * (t.reach + magnitude);  // centroids are rounded: a few units in the last place
    index_->reach = std::max(index_->reach, t.reach);
  }
  index_->tree = std::make_unique<KdTree>(3, index_->set, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize));
}

SurfaceDistance::~SurfaceDistance() = default;
SurfaceDistance::SurfaceDistance(SurfaceDistance&&) noexcept = default;
SurfaceDistance& SurfaceDistance::operator=(SurfaceDistance&&) noexcept = default;

double SurfaceDistance::distance(const Vec3& x) const {
  NearestTriangle nearest(x, index_->triangles, index_->reach);
  index_->tree->findNeighbors(nearest, x.data(), nanoflann::SearchParams());
  return nearest.distance();
}

std::vector<double> SurfaceDistance::distances(const std::vector<Vec3>& x, const Context& context) const {
  // Chunks are what a thread works through: where points follow each other in space, one bounds the next.
  constexpr std::size_t kChunk = 64;
  constexpr double kRoundedUp = 1 + 1e-12;
  std::vector<double> out(x.size());
  polled_parallel_for((x.size() + kChunk - 1) / kChunk, kValuesPerPoll / kChunk, context, [&](std::size_t c) {
    double bound = std::numeric_limits<double>::infinity();
    for (std::size_t i = c * kChunk; i < std::min(x.size(), (c + 1) * kChunk); ++i) {
      if (i > c * kChunk) bound = out[i - 1] + (x[i] - x[i - 1]).norm();
      bound = bound * kRoundedUp + index_->rounding;
      NearestTriangle nearest(x[i], index_->triangles, index_->reach, bound);
      index_->tree->findNeighbors(nearest, x[i].data(), nanoflann::SearchParams());
      out[i] = nearest.distance();
    }
  });
  return out;
}

double point_triangle_distance(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::sqrt(triangle_distance2(x, a, b, c));
}

struct SampleDistance::Index {
  std::vector<Vec3> samples;
  PointSet set{samples};
  std::unique_ptr<KdTree> tree;
};

SampleDistance::SampleDistance(std::vector<Vec3> samples) : index_(std::make_unique<Index>()) {
  if (samples.empty()) throw std::invalid_argument("distance to a cloud without samples");
  check_finite(samples, "sample");
  index_->samples = std::move(samples);
  index_->tree = std::make_unique<KdTree>(3, index_->set, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize));
}

SampleDistance::~SampleDistance() = default;
SampleDistance::SampleDistance(SampleDistance&&) noexcept = default;
SampleDistance& SampleDistance::operator=(SampleDistance&&) noexcept = default;

std::vector<double> SampleDistance::distances(const std::vector<Vec3>& x, const Context& context) const {
  return map_indices(x.size(), context, [&](std::size_t i) {
    std::uint32_t nearest = 0;
    double distance2 = 0;
    index_->tree->knnSearch(x[i].data(), 1, &nearest, &distance2);
    return std::sqrt(distance2);
  });
}

double unsupported_area_fraction(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                 const std::vector<double>& distance, double radius) {
  std::vector<double> area(V.size(), 0);  // a third of the faces around a vertex
  double all = 0;
  for (const Triangle& f : faces) {
    const double third = (V[f[1]] - V[f[0]]).cross(V[f[2]] - V[f[0]]).norm() / 6;
    for (const int v : f) area[v] += third;
    all += 3 * third;
  }
  double unsupported = 0;
  for (std::size_t v = 0; v < V.size(); ++v) {
    if (area[v] > 0 && distance[v] > radius) unsupported += area[v];
  }
  return all > 0 ? unsupported / all : 0;
}

double unsupported_area_fraction(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                 const SampleDistance& samples, double radius, const Context& context) {
  std::vector<char> used(V.size(), 0);
  for (const Triangle& f : faces) {
    for (const int v : f) used[v] = 1;
  }
  std::vector<int> vertices;
  std::vector<Vec3> places;
  for (std::size_t v = 0; v < V.size(); ++v) {
    if (used[v]) vertices.push_back(static_cast<int>(v)), places.push_back(V[v]);
  }
  const std::vector<double> found = samples.distances(places, context);
  std::vector<double> distance(V.size(), 0);
  for (std::size_t i = 0; i < vertices.size(); ++i) distance[vertices[i]] = found[i];
  return unsupported_area_fraction(V, faces, distance, radius);
}

}  // namespace umtet
