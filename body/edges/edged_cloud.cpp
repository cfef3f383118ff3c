#include "body/edges/edged_cloud.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "body/edges/cloud_domain.h"
#include "body/edges/edged_body.h"
#include "reconstruct/patches/segment_cloud.h"

namespace umtet {
namespace {

// A cloud of more samples is divided only if this many of them show a sharp edge: most clouds have none.
constexpr std::size_t kAsked = 60'000;

bool has_sharp_border(const SamplePatches& patches) {
  return std::any_of(patches.borders.begin(), patches.borders.end(),
                     [](const SamplePatches::Border& b) { return b.sharp; });
}

/// Whether every k-th sample alone shows a sharp edge; samples are sorted in space.
bool some_show_edges(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, bool has_measured_normals) {
  const std::size_t every = (points.size() + kAsked - 1) / kAsked;
  std::vector<Vec3> some, of_some;
  for (std::size_t i = 0; i < points.size(); i += every) {
    some.push_back(points[i]);
    of_some.push_back(normals[i]);
  }
  const double spacing = sample_spacing(neighbour_distances(some, kAreaNeighbours));
  return has_sharp_border(segment_cloud(some, of_some, spacing, {.measured_normals = has_measured_normals}));
}

}  // namespace

EdgedCloud edged_cloud(const OrientedPointCloud& cloud, NeighbourDistances near, bool has_measured_normals,
                       const Context& context) {
  EdgedCloud made;
  if (cloud.points.size() < kFewestSegmented) return made;
  Box box;
  for (const Vec3& x : cloud.points) box.extend(x);
  made.shift = box.center();
  std::vector<Vec3> points = cloud.points;
  for (Vec3& x : points) x -= made.shift;
  if (points.size() > kAsked && !some_show_edges(points, cloud.normals, has_measured_normals)) return made;
  if (near.nearest.empty()) near = neighbour_distances(points, kAreaNeighbours);
  made.patches = segment_cloud(points, cloud.normals, sample_spacing(near), {.measured_normals = has_measured_normals});
  if (!has_sharp_border(made.patches)) return made;
  std::optional<CloudDomain> domain = cloud_domain(points, made.patches, context);
  if (!domain || domain->graph.curves.empty() || !domain->broken.empty()) return made;
  // Curves are common zeros of their patches to rounding; corners of four patches and more are a point near all of
  // them.
  made.body = std::make_shared<const PiecewiseBody>(PiecewiseBody{std::move(domain->domain), std::move(domain->graph)});
  return made;
}

Domain edged_domain(const EdgedCloud& edged, OrientedPointCloud cloud, const std::optional<Box>& box, double h) {
  Domain domain;
  domain.shift = edged.shift;
  for (Vec3& x : cloud.points) x -= edged.shift;
  Box of_body;
  for (const Vec3& x : cloud.points) of_body.extend(x);
  domain.diagonal = of_body.diagonal().norm();
  domain.box = box ? Box(box->min() - edged.shift, box->max() - edged.shift) : with_margin(of_body, h);
  domain.cloud = std::move(cloud);
  domain.cloud_spacing = edged.patches.spacing;
  domain.noise = edged.patches.noise;
  set_body(domain, edged.body);
  return domain;
}

}  // namespace umtet
