#include "mesh/submesh/assumptions.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/core/sort_faces.h"
#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

// Right angles of a background count as right in spite of rounding.
constexpr double kRightAngleDeg = 90 - 1e-9;
constexpr std::size_t kFacesPerTask = 1 << 10;  // a tenth of a microsecond each

void add(BrokenAssumption& broken, std::span<const int> vertices, std::size_t n_vertices) {
  ++broken.count;
  broken.at_vertex.resize(n_vertices, false);
  for (const int i : vertices) broken.at_vertex[i] = true;
}

/// The greater conditioning angle of a positively cut tet, degrees.
double conditioning_angle(const TetMesh& mesh, const Tet& tet, Triangle face, const std::vector<double>& distance) {
  const auto nearer = [&](int i, int j) { return distance[i] < distance[j]; };
  const auto proximal_vertex = std::min_element(face.begin(), face.end(), nearer);
  std::rotate(face.begin(), proximal_vertex, face.end());
  const int inside = *std::find_if(tet.begin(), tet.end(),
                                   [&](int i) { return std::find(face.begin(), face.end(), i) == face.end(); });
  const auto angle_at = [&](int edge_end, int other) {
    return dihedral_angle_deg(mesh.V[face[0]], mesh.V[edge_end], mesh.V[other], mesh.V[inside]);
  };
  return std::max(angle_at(face[1], face[2]), angle_at(face[2], face[1]));
}

}  // namespace

bool BrokenAssumption::is_broken_at(std::span<const int> vertices) const {
  return count > 0 && std::any_of(vertices.begin(), vertices.end(), [&](int i) { return at_vertex[i]; });
}

BrokenAssumption double_positive_faces(const Submesh& submesh) {
  std::vector<Triangle> faces = submesh.positive_faces;
  for (Triangle& face : faces) std::sort(face.begin(), face.end());
  sort_faces(faces, submesh.mesh.V.size());
  BrokenAssumption broken;
  for (std::size_t f = 1; f < faces.size(); ++f) {
    if (faces[f] == faces[f - 1]) add(broken, faces[f], submesh.mesh.V.size());
  }
  return broken;
}

ConditioningAngles conditioning_angles(const Submesh& submesh, std::span<const double> distance) {
  const std::vector<int>& positive = submesh.positive_vertices;
  if (distance.size() != positive.size()) {
    throw std::invalid_argument(std::to_string(distance.size()) + " distances for " + std::to_string(positive.size()) +
                                " positive vertices");
  }
  std::vector<double> distance_of_vertex(submesh.mesh.V.size(), 0);
  for (std::size_t k = 0; k < positive.size(); ++k) distance_of_vertex[positive[k]] = distance[k];
  ConditioningAngles angles;
  const auto tet_of = [&](std::size_t f) -> const Tet& { return submesh.mesh.C[submesh.positive_tets[f]]; };
  std::vector<double> greatest(submesh.positive_faces.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, greatest.size(), kFacesPerTask), [&](const auto& range) {
    for (std::size_t f = range.begin(); f != range.end(); ++f) {
      greatest[f] = conditioning_angle(submesh.mesh, tet_of(f), submesh.positive_faces[f], distance_of_vertex);
    }
  });
  for (std::size_t f = 0; f < greatest.size(); ++f) {
    angles.max_deg = std::max(angles.max_deg, greatest[f]);
    if (greatest[f] >= kRightAngleDeg) add(angles.not_acute, tet_of(f), submesh.mesh.V.size());
  }
  return angles;
}

}  // namespace umtet
