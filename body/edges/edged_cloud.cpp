#include "body/edges/edged_cloud.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "body/edges/cloud_domain.h"
#include "body/edges/edged_body.h"
#include "reconstruct/patches/segment_cloud.h"

namespace umtet {
namespace {

bool has_sharp_border(const SamplePatches& patches) {
  return std::any_of(patches.borders.begin(), patches.borders.end(),
                     [](const SamplePatches::Border& b) { return b.sharp; });
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
