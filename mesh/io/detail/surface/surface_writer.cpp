#include <stdexcept>

#include "mesh/io/solver_files.h"

namespace umtet {
namespace {

template <class Holds>
void write_faces(const std::filesystem::path& path, const SolverMesh& mesh, SurfaceFormat format, const Holds& holds) {
  require_consistent(mesh);
  std::vector<Triangle> faces;
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    if (!holds(mesh.face_patch[f])) continue;
    const std::array<int, 6> ids = mesh.face(f);
    faces.push_back({ids[0], ids[1], ids[2]});
  }
  write_surface(path, mesh.nodes, faces, format);
}

}  // namespace

void write_boundary_surface(const std::filesystem::path& path, const SolverMesh& mesh, SurfaceFormat format) {
  write_faces(path, mesh, format, [](int) { return true; });
}

void write_boundary_surface(const std::filesystem::path& path, const SolverMesh& mesh, SurfaceFormat format,
                            std::size_t patch) {
  if (patch >= mesh.patches.size()) throw std::invalid_argument("write_boundary_surface: no such patch");
  write_faces(path, mesh, format, [patch](int p) { return static_cast<std::size_t>(p) == patch; });
}

}  // namespace umtet
