#include "pipeline/domain/edged_case.h"

#include <algorithm>

#include "body/edges/edged_body.h"

namespace umtet {

EdgedTriangles edged_triangles(TriangleMesh mesh, const Vec3& shift, const Parameters& parameters) {
  EdgedTriangles made;
  made.shift = shift;
  made.triangles = given_triangles(std::move(mesh), shift, parameters.reconstruct().feature_angle);
  if (parameters.reconstruct().edges == SharpEdgeUse::Auto) made.body = edged_body(*made.triangles);
  return made;
}

bool has_edges(const StageRecord& level_set) {
  const auto& files = level_set.outputs;
  return std::any_of(files.begin(), files.end(), [](const RecordedFile& f) { return f.name == kFeatureFile; });
}

}  // namespace umtet
