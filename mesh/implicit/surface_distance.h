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

/// Exact distances to a triangle surface.
///
/// A kd-tree over centroids with one provable rule: no point of triangle k is nearer to x than |x - m_k| - r, where
/// m_k is its centroid and r the greatest centroid-corner distance of all. The search therefore ends only when every
/// remaining centroid is farther than (best distance so far) + r. Triangles whose r differ by two and more have trees
/// of their own.
/// Keeps its own copy of the triangles. Immutable; queries are thread-safe.
class SurfaceDistance {
 public:
  /// \throw std::invalid_argument without faces, for an index out of range or a corner that is not finite
  SurfaceDistance(const std::vector<Vec3>& V, const std::vector<Triangle>& faces);
  ~SurfaceDistance();
  SurfaceDistance(SurfaceDistance&&) noexcept;
  SurfaceDistance& operator=(SurfaceDistance&&) noexcept;

  double distance(const Vec3& x) const;
  /// One distance per point; threads over points. Takes half the time for points that follow each other in space.
  /// \throw Cancelled
  std::vector<double> distances(const std::vector<Vec3>& x, const Context& context = {}) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

/// Distances to samples: a kd-tree that several questions share. Keeps its own copy of the samples. Immutable; queries
/// are thread-safe.
class SampleDistance {
 public:
  /// \throw std::invalid_argument without samples or for one that is not finite
  explicit SampleDistance(std::vector<Vec3> samples);
  ~SampleDistance();
  SampleDistance(SampleDistance&&) noexcept;
  SampleDistance& operator=(SampleDistance&&) noexcept;

  /// Distance from each x to the nearest sample, model units; threads over x. \throw Cancelled
  std::vector<double> distances(const std::vector<Vec3>& x, const Context& context = {}) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

/// The same for one call, of samples that are not copied; the tree is gone afterwards.
/// \throw std::invalid_argument without samples or for one that is not finite; Cancelled
std::vector<double> distances_to_samples(const std::vector<Vec3>& samples, const std::vector<Vec3>& x,
                                         const Context& context = {});

/// Share of the surface that no data backs: what belongs to vertices (a third of the faces around each) that are
/// farther than `radius` (three sample spacings, say) from every sample. Not faces by their centroids, which samples
/// much finer than the faces are far from wherever psi = 0 is curved. 0 for an empty surface. \throw Cancelled
double unsupported_area_fraction(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                 const SampleDistance& samples, double radius, const Context& context = {});
/// The same where the distances are known. @param distance  by vertex; of those without a face it may be anything
double unsupported_area_fraction(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                 const std::vector<double>& distance, double radius);

}  // namespace umtet
