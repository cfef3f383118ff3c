#pragma once

#include <memory>
#include <optional>

#include "body/body.h"
#include "body/given_triangles.h"
#include "body/piecewise_body.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// The body of triangles with sharp edges, with one function for each smooth patch (triangle_domain.h).
/// @return null if the triangles have no sharp edge, bound no closed body, or are partly inside of it
std::shared_ptr<const PiecewiseBody> edged_body(const GivenTriangles& triangles);

/// The domain of such a body. psi is the function of the patches; there is no fitted level set.
/// @param body   edged_body() of the triangles
/// @param cloud  samples of the triangles, model coordinates
/// @param shift  origin of the working coordinates, model coordinates
/// @param box    the box to be meshed, model coordinates; empty: with_margin() of the box of the triangles
/// @param h      edge length, if it is given, or 0
Domain edged_domain(std::shared_ptr<const GivenTriangles> triangles, std::shared_ptr<const PiecewiseBody> body,
                    OrientedPointCloud cloud, const Vec3& shift, const std::optional<Box>& box, double h);

/// The box of a body with a margin of a tenth of its diagonal, or of five edges of length h: the background needs two
/// edges or more around the body.
Box with_margin(const Box& of_body, double h);

/// The origin of the working coordinates: the middle of the box of the triangles.
Vec3 middle_of(const TriangleMesh& mesh);

}  // namespace umtet
