#include "mesh/implicit/surface_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <nanoflann.hpp>
#include <numeric>
#include <stdexcept>
#include <string>

#include "common/polled_loops.h"

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

// The longest triangles, those of half that, and so on; the last class has all that are shorter.
constexpr int kSizeClasses = 8;

std::uint8_t class_of(double reach, double greatest) {
  std::uint8_t k = 0;
  while (k + 1 < kSizeClasses && 2 * reach < greatest) reach *= 2, ++k;
  return k;
}

/// out[i] = f(i): which thread runs one cannot change a result.
template <typename F>
std::vector<double> map_indices(std::size_t n, const Context& context, F&& f) {
  std::vector<double> out(n);
  polled_parallel_for(n, kValuesPerPoll, context, [&](std::size_t i) { out[i] = f(i); });
  return out;
}

}  // namespace

/// Triangles of about one size.
struct SizeClass {
  std::vector<CentredTriangle> triangles;
  std::vector<Vec3> centroids;
  double reach = 0;  ///< the greatest of all
  PointSet set{centroids};
  std::unique_ptr<KdTree> tree;

  void build() {
    for (const CentredTriangle& t : triangles) reach = std::max(reach, t.reach);
    tree = std::make_unique<KdTree>(3, set, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize));
  }
  /// The distance to the nearest, or `bound` if all are farther.
  double distance(const Vec3& x, double bound) const {
    NearestTriangle nearest(x, triangles, reach, bound);
    tree->findNeighbors(nearest, x.data(), nanoflann::SearchParams());
    return nearest.distance();
  }
};

struct SurfaceDistance::Index {
  std::deque<SizeClass> classes;  ///< the largest number of triangles first
  double rounding = 0;            ///< more than what a distance may be off by

  double distance(const Vec3& x, double bound = std::numeric_limits<double>::infinity()) const {
    for (const SizeClass& c : classes) bound = c.distance(x, bound);
    return bound;
  }
};

SurfaceDistance::SurfaceDistance(const std::vector<Vec3>& V, const std::vector<Triangle>& faces)
    : index_(std::make_unique<Index>()) {
  if (faces.empty()) throw std::invalid_argument("distance to a surface without faces");
  std::vector<CentredTriangle> triangles;
  std::vector<Vec3> centroids;
  double magnitude = 0, greatest = 0;
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
    triangles.push_back({t, reach});
    centroids.push_back(m);
    greatest = std::max(greatest, reach);
  }
  index_->rounding = 1e-13 * magnitude;
  std::array<std::size_t, kSizeClasses> n{};
  std::vector<std::uint8_t> size_class(triangles.size());
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    ++n[size_class[k] = class_of(triangles[k].reach, greatest)];
    triangles[k].reach += 1e-14 * (triangles[k].reach + magnitude);  // centroids are rounded: a few last places
  }
  std::array<int, kSizeClasses> order{};
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return n[a] > n[b]; });
  for (const int which : order) {
    if (n[which] == 0) break;
    SizeClass& c = index_->classes.emplace_back();
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      if (size_class[k] != which) continue;
      c.triangles.push_back(triangles[k]);
      c.centroids.push_back(centroids[k]);
    }
    c.build();
  }
}

SurfaceDistance::~SurfaceDistance() = default;
SurfaceDistance::SurfaceDistance(SurfaceDistance&&) noexcept = default;
SurfaceDistance& SurfaceDistance::operator=(SurfaceDistance&&) noexcept = default;

double SurfaceDistance::distance(const Vec3& x) const { return index_->distance(x); }

std::vector<double> SurfaceDistance::distances(const std::vector<Vec3>& x, const Context& context) const {
  // Chunks are what a thread works through: where points follow each other in space, one bounds the next.
  constexpr std::size_t kChunk = 64;
  constexpr double kRoundedUp = 1 + 1e-12;
  std::vector<double> out(x.size());
  polled_parallel_for((x.size() + kChunk - 1) / kChunk, kValuesPerPoll / kChunk, context, [&](std::size_t c) {
    double bound = std::numeric_limits<double>::infinity();
    for (std::size_t i = c * kChunk; i < std::min(x.size(), (c + 1) * kChunk); ++i) {
      if (i > c * kChunk) bound = out[i - 1] + (x[i] - x[i - 1]).norm();
      out[i] = index_->distance(x[i], bound * kRoundedUp + index_->rounding);
    }
  });
  return out;
}

double point_triangle_distance(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::sqrt(triangle_distance2(x, a, b, c));
}

namespace {

/// A tree of samples that stay where they are.
struct SampleTree {
  PointSet set;
  KdTree tree;

  explicit SampleTree(const std::vector<Vec3>& samples)
      : set{checked(samples)}, tree(3, set, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}
  std::vector<double> distances(const std::vector<Vec3>& x, const Context& context) const {
    return map_indices(x.size(), context, [&](std::size_t i) {
      std::uint32_t nearest = 0;
      double distance2 = 0;
      tree.knnSearch(x[i].data(), 1, &nearest, &distance2);
      return std::sqrt(distance2);
    });
  }

 private:
  static const std::vector<Vec3>& checked(const std::vector<Vec3>& samples) {
    if (samples.empty()) throw std::invalid_argument("distance to a cloud without samples");
    check_finite(samples, "sample");
    return samples;
  }
};

}  // namespace

struct SampleDistance::Index {
  std::vector<Vec3> samples;
  SampleTree tree;
  explicit Index(std::vector<Vec3> of) : samples(std::move(of)), tree(samples) {}
};

SampleDistance::SampleDistance(std::vector<Vec3> samples) : index_(std::make_unique<Index>(std::move(samples))) {}

SampleDistance::~SampleDistance() = default;
SampleDistance::SampleDistance(SampleDistance&&) noexcept = default;
SampleDistance& SampleDistance::operator=(SampleDistance&&) noexcept = default;

std::vector<double> SampleDistance::distances(const std::vector<Vec3>& x, const Context& context) const {
  return index_->tree.distances(x, context);
}

std::vector<double> distances_to_samples(const std::vector<Vec3>& samples, const std::vector<Vec3>& x,
                                         const Context& context) {
  return SampleTree(samples).distances(x, context);
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
