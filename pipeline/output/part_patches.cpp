#include "pipeline/output/part_patches.h"

#include <utility>

#include "mesh/core/tet_mesh.h"
#include "pipeline/meshing/sample_fields.h"

namespace umtet {
namespace {

constexpr std::uint8_t kOpposite = 3;  // index of the corner of each tet behind its face

/// Returns the faces, each with its own tet. The fourth corner of all tets is one node after all others, which has no
/// meaning.
SolverMesh with_faces_alone(const MeshWithBoundary& mesh) {
  SolverMesh made;
  made.nodes = mesh.V;
  made.nodes.push_back(Vec3::Zero());
  for (const Triangle& f : mesh.faces) {
    Tet tet{};
    for (int k = 0; k < 3; ++k) tet[kTetFace[kOpposite][k]] = f[k];
    tet[kOpposite] = static_cast<int>(mesh.V.size());
    made.face_tet.push_back(static_cast<int>(made.face_tet.size()));
    made.tets.insert(made.tets.end(), tet.begin(), tet.end());
  }
  made.face_opposite.assign(mesh.faces.size(), kOpposite);
  made.face_patch.assign(mesh.faces.size(), 0);
  made.patches = {{kWholeBoundary, 2}};
  return made;
}

/// Returns a file with the data that mark faces.
MeshFile file_of(const MeshWithBoundary& mesh) {
  MeshFile file;
  file.mesh.V = mesh.V;
  for (const BoundaryData::Array& a : mesh.data.arrays) {
    if (a.name == "support") file.point_data[a.name] = a.values;
  }
  return file;
}

}  // namespace

PieceData piece_data(const MeshWithBoundary& mesh, const OrientedPointCloud& cloud,
                     const std::optional<SupportReport>& support, const Parameters& parameters, const Warn& warn,
                     const std::vector<std::string>& names_of_file) {
  SolverMesh faces = with_faces_alone(mesh);
  divide_boundary(faces, marked_faces(faces, file_of(mesh), support), cloud, parameters, warn, names_of_file);
  PieceData made{std::move(faces.patches), faces.body.number, std::move(faces.face_patch), mesh.data};
  if (parameters.mesh().order > 1)  // files of one process contain no more
    std::erase_if(made.of_vertices.arrays, [](const BoundaryData::Array& a) { return !is_of_scan(a.name); });
  return made;
}

}  // namespace umtet
