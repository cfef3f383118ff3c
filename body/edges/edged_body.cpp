#include "body/edges/edged_body.h"

#include <algorithm>
#include <utility>

#include "body/edges/triangle_domain.h"

namespace umtet {
namespace {

// Shares of the diagonal and of h.
constexpr double kMargin = .1, kEdgesAround = 5;

Box box_of(const TriangleMesh& mesh) {
  Box box;
  for (const Triangle& t : mesh.F)
    for (const int v : t) box.extend(mesh.V[v]);
  return box;
}

std::vector<int> labels_of_patches(const GivenTriangles& triangles) {
  const std::vector<int>& labels = triangles.whole.labels;
  if (labels.empty()) return {};
  constexpr int kUnknown = -1;  // no triangle yet
  std::vector<int> of_patch(triangles.edges.n_patches, kUnknown);
  for (std::size_t f = 0; f < labels.size(); ++f) {
    int& label = of_patch[triangles.edges.patch[f]];
    label = label == kUnknown || label == labels[f] ? labels[f] : 0;
  }
  return of_patch;
}

}  // namespace

std::shared_ptr<const PiecewiseBody> edged_body(const GivenTriangles& triangles) {
  if (!triangles.is_whole || triangles.edges.curves.empty()) return nullptr;
  std::optional<TriangleDomain> made = triangle_domain(triangles.whole, triangles.edges);
  if (!made) return nullptr;
  return std::make_shared<const PiecewiseBody>(PiecewiseBody{.domain = std::move(made->domain),
                                                             .graph = std::move(made->graph),
                                                             .curvature = std::move(made->curvature),
                                                             .labels = labels_of_patches(triangles),
                                                             .tolerance = made->tolerance});
}

Domain edged_domain(std::shared_ptr<const GivenTriangles> triangles, std::shared_ptr<const PiecewiseBody> body,
                    OrientedPointCloud cloud, const Vec3& shift, const std::optional<Box>& box, double h) {
  Domain domain;
  domain.shift = shift;
  const Box of_body = box_of(triangles->mesh);
  domain.diagonal = of_body.diagonal().norm();
  domain.box = box ? Box(box->min() - shift, box->max() - shift) : with_margin(of_body, h);
  domain.cloud = std::move(cloud);
  for (Vec3& x : domain.cloud.points) x -= shift;
  domain.triangles = std::move(triangles);
  domain.noise = 0;
  set_body(domain, std::move(body));
  return domain;
}

Box with_margin(const Box& of_body, double h) {
  const Vec3 margin = Vec3::Constant(std::max(kMargin * of_body.diagonal().norm(), kEdgesAround * h));
  return {of_body.min() - margin, of_body.max() + margin};
}

Vec3 middle_of(const TriangleMesh& mesh) { return box_of(mesh).center(); }

}  // namespace umtet
