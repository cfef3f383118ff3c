#include <string>
#include <string_view>
#include <vector>

#include "mesh/io/checked_file.h"
#include "mesh/io/solver_files.h"

namespace umtet {
namespace {

constexpr std::size_t kIdsPerLine = 16;
constexpr int kBoundary = -1;  // in place of a patch

void write_nodes(CheckedFile& file, const SolverMesh& mesh) {
  file.text("    <Nodes name=\"").text(mesh.body.name).text("\">\n");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    file.text("      <node id=\"").number(i + 1).text("\">");
    for (int k = 0; k < 3; ++k) {
      if (k > 0) file.text(",");
      file.number(mesh.nodes[i][k]);
    }
    file.text("</node>\n");
  }
  file.text("    </Nodes>\n");
}

/// An element or a facet. FEBio numbers the middles of tet10 and tri6 as VTK does: 01 12 20 03 13 23, and 01 12 20
/// (FETet10::shape_fnc of its FECore/FESolidElementShape.cpp).
void write_ids(CheckedFile& file, std::string_view tag, std::size_t id, const int* ids, int n) {
  file.text("      <").text(tag).text(" id=\"").number(id).text("\">");
  for (int k = 0; k < n; ++k) {
    if (k > 0) file.text(",");
    file.number(ids[k] + 1);
  }
  file.text("</").text(tag).text(">\n");
}

void write_elements(CheckedFile& file, const SolverMesh& mesh) {
  const std::vector<MeshPart> parts = mesh.parts();
  std::size_t id = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    file.text("    <Elements type=\"").text(mesh.nodes_per_tet == 4 ? "tet4" : "tet10").text("\" name=\"");
    file.text(parts[p].name).text("\">\n");
    for (std::size_t t = 0; t < mesh.n_tets(); ++t) {
      if (mesh.part_of(t) == p) write_ids(file, "elem", ++id, mesh.tet(t).data(), mesh.nodes_per_tet);
    }
    file.text("    </Elements>\n");
  }
}

void write_node_set(CheckedFile& file, const std::string& name, const std::vector<int>& nodes) {
  if (nodes.empty()) return;
  file.text("    <NodeSet name=\"").text(name).text("\">");
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (k > 0) file.text(",");
    if (k % kIdsPerLine == 0) file.text("\n      ");
    file.number(nodes[k] + 1);
  }
  file.text("\n    </NodeSet>\n");
}

/// @param patch  kBoundary: all of the boundary
void write_surface_set(CheckedFile& file, const SolverMesh& mesh, const std::string& name, int patch) {
  std::size_t id = 0;
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    if (patch == kBoundary ? mesh.is_interface(mesh.face_patch[f]) : mesh.face_patch[f] != patch) continue;
    if (id == 0) file.text("    <Surface name=\"").text(name).text("\">\n");
    write_ids(file, mesh.nodes_per_tet == 4 ? "tri3" : "tri6", ++id, mesh.face(f).data(), mesh.nodes_per_face());
  }
  if (id > 0) file.text("    </Surface>\n");
}

}  // namespace

void write_feb(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  CheckedFile file(path);
  // FEBio looks for <?xml at the very beginning, and wants <Module> before all others.
  file.text("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<febio_spec version=\"4.0\">\n");
  file.text("  <!-- umtet: nodes, tets, node sets and surfaces -->\n  <Module type=\"solid\"/>\n  <Mesh>\n");
  write_nodes(file, mesh);
  write_elements(file, mesh);
  // Sets come behind all elements: readers look their nodes up.
  const std::vector<std::vector<int>> nodes = patch_nodes(mesh);
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) write_node_set(file, mesh.patches[p].name, nodes[p]);
  if (mesh.patches.size() > 1) write_node_set(file, kWholeBoundary, boundary_nodes(mesh));
  for (const MeshCurve& curve : mesh.curves) write_node_set(file, curve.part.name, curve_nodes(curve));
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    write_surface_set(file, mesh, mesh.patches[p].name, static_cast<int>(p));
  }
  if (mesh.patches.size() > 1) write_surface_set(file, mesh, kWholeBoundary, kBoundary);
  file.text("  </Mesh>\n</febio_spec>\n");
  file.close();
}

}  // namespace umtet
