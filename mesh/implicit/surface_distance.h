#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/context.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Distance from x to the triangle abc, edges and corners included, model units. Degenerate triangles are segments or
/// points.
double point_triangle_distance(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// Exact distances from points to a triangle surface.
///
/// The search uses a kd-tree over centroids and one provable bound: no point of triangle k is closer to x than |x -
/// m_k| - r, where m_k is its centroid and r the greatest centroid-corner distance of all. The search therefore ends
/// only when every remaining centroid is farther than (best distance so far) + r. Triangles whose r differ by a factor
/// of two or more are in separate trees. The object keeps its own copy of the triangles. Immutable; queries are
/// thread-safe.
class SurfaceDistance {
 public:
  /// \throw std::invalid_argument without faces, for an index out of range or a corner that is not finite
  SurfaceDistance(const std::vector<Vec3>& V, const std::vector<Triangle>& faces);
  ~SurfaceDistance();
  SurfaceDistance(SurfaceDistance&&) noexcept;
  SurfaceDistance& operator=(SurfaceDistance&&) noexcept;

  double distance(const Vec3& x) const;
  /// One distance per point. Uses threads over points. Takes half the time if consecutive points are close in space.
  /// \throw Cancelled
  std::vector<double> distances(const std::vector<Vec3>& x, const Context& context = {}) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

/// Distances from points to samples, by a kd-tree for repeated queries. Keeps its own copy of the samples. Immutable;
/// queries are thread-safe.
class SampleDistance {
 public:
  /// \throw std::invalid_argument without samples or for one that is not finite
  explicit SampleDistance(std::vector<Vec3> samples);
  ~SampleDistance();
  SampleDistance(SampleDistance&&) noexcept;
  SampleDistance& operator=(SampleDistance&&) noexcept;

  /// Distance from each x to the nearest sample, model units. Uses threads over x. \throw Cancelled
  std::vector<double> distances(const std::vector<Vec3>& x, const Context& context = {}) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

/// Distances from points to samples for a single call; samples are not copied, and the tree is not kept.
/// \throw std::invalid_argument without samples or for one that is not finite; Cancelled
std::vector<double> distances_to_samples(const std::vector<Vec3>& samples, const std::vector<Vec3>& x,
                                         const Context& context = {});

/// Fraction of the surface area without support by data: the area of vertices (a third of the faces around each)
/// farther than `radius` (for example three sample spacings) from every sample. Vertices are tested rather than face
/// centroids, because where psi = 0 is curved, centroids are far from samples that are much denser than the faces. 0
/// for an empty surface. \throw Cancelled
double unsupported_area_fraction(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                 const SampleDistance& samples, double radius, const Context& context = {});
/// Returns the same fraction from known distances.
/// @param distance  distance of each vertex; arbitrary for vertices without a face
double unsupported_area_fraction(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                 const std::vector<double>& distance, double radius);

}  // namespace umtet
