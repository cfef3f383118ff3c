#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/io/checked_file.h"
#include "mesh/io/detail/gmsh/msh_node_data.h"
#include "mesh/io/solver_files.h"

namespace umtet {
namespace {

/// Gmsh's type of an element, and its node order: place k of an element of ours is node order[k]. It differs from VTK's
/// in the last two middles of a tet.
struct ElementKind {
  int type;
  int n_nodes;
  std::array<int, 10> order = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
};

ElementKind tet_kind(const SolverMesh& mesh) { return {mesh.nodes_per_tet == 4 ? 4 : 11, mesh.nodes_per_tet}; }
// Curves are of meshes with 4 nodes per tet.
constexpr ElementKind kLine = {1, 2};

ElementKind face_kind(const SolverMesh& mesh) { return {mesh.nodes_per_tet == 4 ? 2 : 9, mesh.nodes_per_face()}; }

class MshWriter {
 public:
  MshWriter(const std::filesystem::path& path, const SolverMesh& mesh, MshEncoding encoding)
      : mesh_(mesh),
        binary_(encoding == MshEncoding::Binary),
        file_(path),
        parts_(mesh.parts()),
        tets_in_(parts_.size(), 0),
        faces_of_(mesh.patches.size()) {
    for (std::size_t t = 0; t < mesh.n_tets(); ++t) ++tets_in_[mesh.part_of(t)];
    for (std::size_t f = 0; f < mesh.n_faces(); ++f) faces_of_[mesh.face_patch[f]].push_back(static_cast<int>(f));
    for (const std::vector<int>& faces : faces_of_) n_patches_ += !faces.empty();
    for (const MeshCurve& curve : mesh.curves) n_lines_ += curve.edges.size();
  }
  void version22();
  void version41();

 private:
  template <typename T>
  void put(T value, const char* separator);
  void put_point(const Vec3& x, const char* last);
  template <typename Id>
  void put_nodes(const int* ids, const ElementKind& kind);
  void head(const char* version);
  void element22(const ElementKind& kind, int group, const int* ids);
  void block22(const ElementKind& kind, std::size_t n);
  std::vector<std::int32_t> surfaces_of(std::size_t part) const;
  void entities41();
  void nodes41();
  void block41(int dimension, int entity, int third, std::size_t n);
  void elements41();
  void boundary_data();

  const SolverMesh& mesh_;
  bool binary_;
  CheckedFile file_;
  std::vector<MeshPart> parts_;             ///< that contain the tets
  std::vector<std::size_t> tets_in_;        ///< by part
  std::vector<std::vector<int>> faces_of_;  ///< by patch
  std::uint64_t n_patches_ = 0;             ///< that have faces
  std::size_t n_lines_ = 0;                 ///< edges of curves
  std::int32_t id_ = 0;                     ///< of the last element
};

/// One number, followed by a separator in ascii files only.
template <typename T>
void MshWriter::put(T value, const char* separator) {
  if (binary_) {
    file_.raw(value);
  } else {
    file_.number(value).text(separator);
  }
}

void MshWriter::put_point(const Vec3& x, const char* last) {
  for (int k = 0; k < 3; ++k) put(x[k], k < 2 ? " " : last);
}

template <typename Id>
void MshWriter::put_nodes(const int* ids, const ElementKind& kind) {
  for (int k = 0; k < kind.n_nodes; ++k) {
    put(static_cast<Id>(ids[kind.order[k]]) + Id{1}, k + 1 < kind.n_nodes ? " " : "\n");
  }
}

void MshWriter::head(const char* version) {
  file_.text("$MeshFormat\n").text(version).text(binary_ ? " 1 8\n" : " 0 8\n");
  if (binary_) file_.raw(std::int32_t{1}).text("\n");  // tells the reader our byte order
  file_.text("$EndMeshFormat\n$PhysicalNames\n")
      .number(mesh_.curves.size() + mesh_.patches.size() + parts_.size())
      .text("\n");
  for (const auto& [part, edges] : mesh_.curves)
    file_.text("1 ").number(part.number).text(" \"").text(part.name).text("\"\n");
  for (const MeshPart& patch : mesh_.patches) {
    file_.text("2 ").number(patch.number).text(" \"").text(patch.name).text("\"\n");
  }
  for (const MeshPart& part : parts_) file_.text("3 ").number(part.number).text(" \"").text(part.name).text("\"\n");
  file_.text("$EndPhysicalNames\n");
}

void MshWriter::block22(const ElementKind& kind, std::size_t n) {
  if (binary_ && n > 0) file_.raw(std::int32_t{kind.type}).raw(static_cast<std::int32_t>(n)).raw(std::int32_t{2});
}

void MshWriter::element22(const ElementKind& kind, int group, const int* ids) {
  put(++id_, " ");
  if (!binary_) file_.number(kind.type).text(" 2 ");
  put(std::int32_t{group}, " ");  // physical group
  put(std::int32_t{group}, " ");  // entity
  put_nodes<std::int32_t>(ids, kind);
}

void MshWriter::version22() {
  head("2.2");
  file_.text("$Nodes\n").number(mesh_.nodes.size()).text("\n");
  for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
    put(static_cast<std::int32_t>(i) + 1, " ");
    put_point(mesh_.nodes[i], "\n");
  }
  file_.text("$EndNodes\n$Elements\n").number(mesh_.n_tets() + mesh_.n_faces() + n_lines_).text("\n");
  block22(kLine, n_lines_);
  for (const auto& [part, edges] : mesh_.curves) {
    for (const std::array<int, 2>& edge : edges) element22(kLine, part.number, edge.data());
  }
  block22(face_kind(mesh_), mesh_.n_faces());
  for (std::size_t p = 0; p < faces_of_.size(); ++p) {
    for (const int f : faces_of_[p]) element22(face_kind(mesh_), mesh_.patches[p].number, mesh_.face(f).data());
  }
  block22(tet_kind(mesh_), mesh_.n_tets());
  for (std::size_t t = 0; t < mesh_.n_tets(); ++t) {
    element22(tet_kind(mesh_), parts_[mesh_.part_of(t)].number, mesh_.tet(t).data());
  }
  file_.text("$EndElements\n");
  boundary_data();
  file_.close();
}

/// The same in both versions.
void MshWriter::boundary_data() {
  for (const auto& [name, values] : mesh_.boundary_data) write_node_data(file_, {name, values}, binary_);
}

/// The numbers of the patches that bound a part.
std::vector<std::int32_t> MshWriter::surfaces_of(std::size_t part) const {
  std::vector<std::int32_t> surfaces;
  for (std::size_t p = 0; p < faces_of_.size(); ++p) {
    const auto is_of_part = [&](int f) { return mesh_.part_of(static_cast<std::size_t>(mesh_.face_tet[f])) == part; };
    bool bounds = std::any_of(faces_of_[p].begin(), faces_of_[p].end(), is_of_part);
    if (mesh_.is_interface(static_cast<int>(p))) {
      const auto& sides = mesh_.interfaces[p + mesh_.interfaces.size() - mesh_.patches.size()];
      bounds = bounds || static_cast<std::size_t>(sides[1]) == part;
    }
    if (bounds) surfaces.push_back(mesh_.patches[p].number);
  }
  return surfaces;
}

void MshWriter::entities41() {
  const auto put_entity = [&](int entity, const Eigen::AlignedBox3d& box, std::uint64_t n_bounding) {
    put(std::int32_t{entity}, " ");
    put_point(box.min(), " ");
    put_point(box.max(), " ");
    put(std::uint64_t{1}, " ");  // physical group
    put(std::int32_t{entity}, " ");
    put(n_bounding, n_bounding ? " " : "\n");
  };
  file_.text("$Entities\n");
  put(std::uint64_t{0}, " ");
  put(std::uint64_t{mesh_.curves.size()}, " ");
  put(n_patches_, " ");
  put(std::uint64_t{parts_.size()}, "\n");
  for (const MeshCurve& curve : mesh_.curves) {
    Eigen::AlignedBox3d box;
    for (const int v : curve_nodes(curve)) box.extend(mesh_.nodes[v]);
    if (!box.isEmpty()) put_entity(curve.part.number, box, 0);
  }
  for (std::size_t p = 0; p < faces_of_.size(); ++p) {
    Eigen::AlignedBox3d box;
    for (const int f : faces_of_[p]) {
      const std::array<int, 6> ids = mesh_.face(f);
      for (int k = 0; k < mesh_.nodes_per_face(); ++k) box.extend(mesh_.nodes[ids[k]]);
    }
    if (!box.isEmpty()) put_entity(mesh_.patches[p].number, box, 0);
  }
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    Eigen::AlignedBox3d box;
    if (mesh_.regions.empty()) {
      for (const Vec3& x : mesh_.nodes) box.extend(x);
    }
    for (std::size_t t = 0; !mesh_.regions.empty() && t < mesh_.n_tets(); ++t) {
      if (mesh_.part_of(t) != part) continue;
      for (const int i : mesh_.tet(t)) box.extend(mesh_.nodes[i]);
    }
    if (box.isEmpty()) box.extend(Vec3::Zero().eval());
    const std::vector<std::int32_t> surfaces = surfaces_of(part);
    put_entity(parts_[part].number, box, surfaces.size());
    for (std::size_t k = 0; k < surfaces.size(); ++k) put(surfaces[k], k + 1 < surfaces.size() ? " " : "\n");
  }
  file_.text("$EndEntities\n");
}

void MshWriter::block41(int dimension, int entity, int third, std::size_t n) {
  put(std::int32_t{dimension}, " ");
  put(std::int32_t{entity}, " ");
  put(std::int32_t{third}, " ");
  put(std::uint64_t{n}, "\n");
}

void MshWriter::nodes41() {
  // A node belongs to the entity of least dimension it lies on; on a border of equal ones to the first.
  struct Entity {
    int dimension, number;
  };
  std::vector<Entity> entities;
  std::vector<std::vector<int>> nodes_of;
  for (const MeshCurve& curve : mesh_.curves) {
    entities.push_back({1, curve.part.number});
    nodes_of.push_back(curve_nodes(curve));
  }
  for (std::vector<int>& nodes : patch_nodes(mesh_)) nodes_of.push_back(std::move(nodes));
  for (const MeshPart& patch : mesh_.patches) entities.push_back({2, patch.number});
  std::vector<char> taken(mesh_.nodes.size(), 0);
  for (std::vector<int>& nodes : nodes_of) {
    std::erase_if(nodes, [&](int i) { return taken[i] != 0; });
    for (const int i : nodes) taken[i] = 1;
  }
  // Of a region, so is any tet of a node that is on no face; a node without a tet is in the first part.
  std::vector<std::size_t> part_of(mesh_.regions.empty() ? 0 : mesh_.nodes.size(), 0);
  for (std::size_t t = 0; !part_of.empty() && t < mesh_.n_tets(); ++t) {
    for (const int i : mesh_.tet(t)) part_of[i] = mesh_.part_of(t);
  }
  const std::size_t first_part = entities.size();
  for (const MeshPart& part : parts_) entities.push_back({3, part.number});
  nodes_of.resize(entities.size());
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (!taken[i]) nodes_of[first_part + (part_of.empty() ? 0 : part_of[i])].push_back(static_cast<int>(i));
  }
  std::uint64_t n_blocks = 0;
  for (const std::vector<int>& ids : nodes_of) n_blocks += !ids.empty();
  file_.text("$Nodes\n");
  put(n_blocks, " ");
  put(std::uint64_t{mesh_.nodes.size()}, " ");
  put(std::uint64_t{mesh_.nodes.empty() ? 0u : 1u}, " ");
  put(std::uint64_t{mesh_.nodes.size()}, "\n");
  for (std::size_t e = 0; e < entities.size(); ++e) {
    if (nodes_of[e].empty()) continue;
    block41(entities[e].dimension, entities[e].number, 0, nodes_of[e].size());
    for (const int i : nodes_of[e]) put(static_cast<std::uint64_t>(i) + 1, "\n");
    for (const int i : nodes_of[e]) put_point(mesh_.nodes[i], "\n");
  }
  file_.text("$EndNodes\n");
}

void MshWriter::elements41() {
  const std::uint64_t n = mesh_.n_tets() + mesh_.n_faces() + n_lines_;
  file_.text("$Elements\n");
  const auto n_volumes = static_cast<std::uint64_t>(tets_in_.size() - std::count(tets_in_.begin(), tets_in_.end(), 0U));
  put(mesh_.curves.size() + n_patches_ + n_volumes, " ");
  put(n, " ");
  put(std::uint64_t{n > 0}, " ");
  put(n, "\n");
  for (const auto& [part, edges] : mesh_.curves) {
    block41(1, part.number, kLine.type, edges.size());
    for (const std::array<int, 2>& edge : edges) {
      put(static_cast<std::uint64_t>(++id_), " ");
      put_nodes<std::uint64_t>(edge.data(), kLine);
    }
  }
  const ElementKind face = face_kind(mesh_), tet = tet_kind(mesh_);
  for (std::size_t p = 0; p < faces_of_.size(); ++p) {
    if (faces_of_[p].empty()) continue;
    block41(2, mesh_.patches[p].number, face.type, faces_of_[p].size());
    for (const int f : faces_of_[p]) {
      put(static_cast<std::uint64_t>(++id_), " ");
      put_nodes<std::uint64_t>(mesh_.face(f).data(), face);
    }
  }
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    if (tets_in_[part] > 0) block41(3, parts_[part].number, tet.type, tets_in_[part]);
    for (std::size_t t = 0; t < mesh_.n_tets(); ++t) {
      if (mesh_.part_of(t) != part) continue;
      put(static_cast<std::uint64_t>(++id_), " ");
      put_nodes<std::uint64_t>(mesh_.tet(t).data(), tet);
    }
  }
  file_.text("$EndElements\n");
}

void MshWriter::version41() {
  head("4.1");
  entities41();
  nodes41();
  elements41();
  boundary_data();
  file_.close();
}

void check(const SolverMesh& mesh) {
  require_consistent(mesh);
  std::size_t n_lines = 0;
  for (const MeshCurve& curve : mesh.curves) n_lines += curve.edges.size();
  require_msh_tags(mesh.n_tets() + mesh.n_faces() + n_lines);
}

}  // namespace

void write_msh22(const std::filesystem::path& path, const SolverMesh& mesh, MshEncoding encoding) {
  check(mesh);
  MshWriter(path, mesh, encoding).version22();
}

void write_msh41(const std::filesystem::path& path, const SolverMesh& mesh, MshEncoding encoding) {
  check(mesh);
  MshWriter(path, mesh, encoding).version41();
}

}  // namespace umtet
