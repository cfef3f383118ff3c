#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/output/report_scene.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet::detail {

/// A value at every vertex of a surface; NaN: unknown.
struct VertexField {
  std::string name;
  std::vector<double> values;
  SceneHead::Range range;  ///< range of the colours
};

/// Returns a scene of triangles without tets: those arrays of ReportScene that exist. Triangles beyond `most`
/// are coarsened.
/// @param shift  added to the vertices
ReportScene triangle_scene(const std::vector<Vec3>& V, const std::vector<Triangle>& F, const Vec3& shift,
                           std::size_t most, const std::vector<VertexField>& fields = {});

/// Returns the vertices of these triangles in the order of first use: the order of the vertices of such a scene, if its
/// triangles are not coarsened.
std::vector<int> order_of_use(const std::vector<Triangle>& F, std::size_t n_vertices);

}  // namespace umtet::detail
