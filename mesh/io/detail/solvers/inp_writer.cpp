#include <string>

#include "mesh/io/checked_file.h"
#include "mesh/io/detail/solvers/fixed_width.h"
#include "mesh/io/solver_files.h"

namespace umtet {
namespace {

constexpr int kCoordinateWidth = 20;  // CalculiX reads the first 20 characters of a number, Abaqus as many
constexpr int kIdsPerLine = 16;
constexpr int kBoundary = -1;  // in place of a patch

/// Abaqus' number of the face opposite to corner k: S1 = 1-2-3, S2 = 1-4-2, S3 = 2-4-3, S4 = 3-4-1.
constexpr int kFaceNumber[4] = {3, 4, 2, 1};

void write_node_set(CheckedFile& file, const std::string& name, const std::vector<int>& nodes) {
  if (nodes.empty()) return;
  file.text("*NSET, NSET=").text(name).text("\n");
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const bool last = k + 1 == nodes.size() || (k + 1) % kIdsPerLine == 0;
    file.number(nodes[k] + 1).text(last ? "\n" : ", ");
  }
}

/// @param patch  kBoundary: all of the boundary
void write_surface_set(CheckedFile& file, const SolverMesh& mesh, const std::string& name, int patch) {
  bool begun = false;
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    if (patch == kBoundary ? mesh.is_interface(mesh.face_patch[f]) : mesh.face_patch[f] != patch) continue;
    if (!begun) file.text("*SURFACE, NAME=").text(name).text(", TYPE=ELEMENT\n");
    begun = true;
    file.number(mesh.face_tet[f] + 1).text(", S").number(kFaceNumber[mesh.face_opposite[f]]).text("\n");
  }
}

}  // namespace

void write_inp(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  CheckedFile file(path);
  file.text("*HEADING\numtet: tets, node sets and surfaces\n*NODE\n");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    file.number(i + 1);
    for (int k = 0; k < 3; ++k) {
      const detail::FixedWidth x(mesh.nodes[i][k], kCoordinateWidth, detail::FixedWidth::Style::C);
      file.text(", ").text(x.text());
    }
    file.text("\n");
  }
  // Their node order is VTK's.
  const std::vector<MeshPart> parts = mesh.parts();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    file.text("*ELEMENT, TYPE=").text(mesh.nodes_per_tet == 4 ? "C3D4" : "C3D10").text(", ELSET=");
    file.text(parts[p].name).text("\n");
    for (std::size_t t = 0; t < mesh.n_tets(); ++t) {
      if (mesh.part_of(t) != p) continue;
      file.number(t + 1);
      for (const int v : mesh.tet(t)) file.text(", ").number(v + 1);
      file.text("\n");
    }
  }
  const std::vector<std::vector<int>> nodes = patch_nodes(mesh);
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    write_node_set(file, mesh.patches[p].name, nodes[p]);
    write_surface_set(file, mesh, mesh.patches[p].name, static_cast<int>(p));
  }
  if (mesh.patches.size() > 1) {
    write_node_set(file, kWholeBoundary, boundary_nodes(mesh));
    write_surface_set(file, mesh, kWholeBoundary, kBoundary);
  }
  for (const MeshCurve& curve : mesh.curves) write_node_set(file, curve.part.name, curve_nodes(curve));
  file.close();
}

}  // namespace umtet
