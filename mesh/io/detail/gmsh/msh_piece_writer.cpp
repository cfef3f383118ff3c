#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>

#include "mesh/io/checked_file.h"
#include "mesh/io/detail/gmsh/msh_node_data.h"
#include "mesh/io/msh_piece.h"
#include "mesh/io/solver_files.h"

namespace umtet {
namespace {

constexpr std::int32_t kTriangle = 2, kTetrahedron = 4;  // types of Gmsh
constexpr std::uint64_t kNone = 0;

/// Tags of entities: those of the whole are the numbers of patches and body; those of parts come behind.
class PieceWriter {
 public:
  PieceWriter(const std::filesystem::path& path, const MshPiece& piece);
  void write();

 private:
  struct Entity {
    std::int32_t dimension, tag, parent;
    Eigen::AlignedBox3d box = {};
    std::vector<int> nodes = {};
  };
  template <class T>
  void put(T value) {
    file_.raw(value);
  }
  void put(const Eigen::AlignedBox3d& box);
  std::int32_t tag_in_part(int number) const { return most_ + 1 + piece_.part * most_ + number; }
  std::int32_t ghost_tag() const { return most_ + 1 + piece_.n_parts * most_ + piece_.part + 1; }
  void head();
  void entities();
  void partitioned_entities();
  void nodes();
  void block(std::int32_t dimension, std::int32_t tag, std::int32_t type, std::size_t n);
  template <std::size_t n>
  void element(std::uint64_t tag, const std::array<int, n>& corners);
  void elements();
  void ghost_elements();
  void boundary_data();

  const MshPiece& piece_;
  CheckedFile file_;
  std::int32_t most_ = 0;         ///< the largest number of an entity of the whole
  std::vector<Entity> surfaces_;  ///< of this part, by patch; those without faces have no nodes
  Entity volume_{}, ghost_{};
};

PieceWriter::PieceWriter(const std::filesystem::path& path, const MshPiece& piece) : piece_(piece), file_(path) {
  most_ = piece.body.number;
  for (const MeshPart& patch : piece.patches) most_ = std::max(most_, patch.number);
  for (const MeshPart& patch : piece.patches) surfaces_.push_back({2, tag_in_part(patch.number), patch.number});
  volume_ = {3, tag_in_part(piece.body.number), piece.body.number};
  ghost_ = {3, ghost_tag(), piece.body.number};
  // A node is of the entity of least dimension that it lies on; on a border of patches of the first.
  std::vector<Entity*> of_node(piece.nodes.size(), nullptr);
  const auto take = [&](Entity& entity, std::span<const int> corners) {
    for (const int v : corners) {
      entity.box.extend(piece.nodes[v]);
      if (!of_node[v]) of_node[v] = &entity;
    }
  };
  for (std::size_t p = 0; p < surfaces_.size(); ++p) {
    for (std::size_t f = 0; f < piece.faces.size(); ++f)
      if (piece.face_patch[f] == static_cast<int>(p)) take(surfaces_[p], piece.faces[f]);
  }
  for (const Tet& t : piece.tets) take(volume_, t);
  for (const Tet& t : piece.ghosts) take(ghost_, t);
  for (std::size_t v = 0; v < of_node.size(); ++v)
    if (of_node[v]) of_node[v]->nodes.push_back(static_cast<int>(v));
}

void PieceWriter::put(const Eigen::AlignedBox3d& box) {
  const bool is_empty = box.isEmpty();
  for (const Vec3& x : {Vec3(box.min()), Vec3(box.max())})
    for (int k = 0; k < 3; ++k) put(is_empty ? 0. : x[k]);
}

void PieceWriter::head() {
  file_.text("$MeshFormat\n4.1 1 8\n").raw(std::int32_t{1}).text("\n$EndMeshFormat\n$PhysicalNames\n");
  file_.number(piece_.patches.size() + 1).text("\n");
  for (const MeshPart& patch : piece_.patches)
    file_.text("2 ").number(patch.number).text(" \"").text(patch.name).text("\"\n");
  file_.text("3 ").number(piece_.body.number).text(" \"").text(piece_.body.name).text("\"\n$EndPhysicalNames\n");
}

/// Boxes are of what is in this file.
void PieceWriter::entities() {
  file_.text("$Entities\n");
  for (const std::uint64_t n : {kNone, kNone, std::uint64_t{surfaces_.size()}, std::uint64_t{1}}) put(n);
  const auto put_entity = [&](const Entity& entity, std::uint64_t n_bounding) {
    put(entity.parent);
    put(entity.box);
    put(std::uint64_t{1});
    put(entity.parent);
    put(n_bounding);
  };
  for (const Entity& surface : surfaces_) put_entity(surface, 0);
  put_entity(volume_, surfaces_.size());
  for (const Entity& surface : surfaces_) put(surface.parent);
  file_.text("\n$EndEntities\n");
}

void PieceWriter::partitioned_entities() {
  file_.text("$PartitionedEntities\n");
  put(static_cast<std::uint64_t>(piece_.n_parts));
  put(std::uint64_t{1});
  put(ghost_.tag);
  put(std::int32_t{piece_.part + 1});
  std::vector<const Entity*> here;
  for (const Entity& surface : surfaces_)
    if (!surface.box.isEmpty()) here.push_back(&surface);
  const std::uint64_t n_surfaces = here.size();
  here.push_back(&volume_);
  for (const std::uint64_t n : {kNone, kNone, n_surfaces, std::uint64_t{1}}) put(n);
  for (const Entity* entity : here) {
    put(entity->tag);
    put(entity->dimension);
    put(entity->parent);
    put(std::uint64_t{1});
    put(std::int32_t{piece_.part + 1});
    put(entity->box);
    put(std::uint64_t{1});
    put(entity->parent);
    put(entity->dimension == 3 ? n_surfaces : kNone);
    for (const Entity* bounding : here)
      if (entity->dimension == 3 && bounding->dimension == 2) put(bounding->tag);
  }
  file_.text("\n$EndPartitionedEntities\n");
}

void PieceWriter::block(std::int32_t dimension, std::int32_t tag, std::int32_t type, std::size_t n) {
  put(dimension);
  put(tag);
  put(type);
  put(std::uint64_t{n});
}

void PieceWriter::nodes() {
  std::vector<const Entity*> blocks;
  for (const Entity& surface : surfaces_) blocks.push_back(&surface);
  blocks.push_back(&volume_);
  blocks.push_back(&ghost_);
  std::erase_if(blocks, [](const Entity* e) { return e->nodes.empty(); });
  const auto& number = piece_.node_number;
  const auto [least, most] = std::minmax_element(number.begin(), number.end());
  file_.text("$Nodes\n");
  put(std::uint64_t{blocks.size()});
  put(std::uint64_t{number.size()});
  put(number.empty() ? kNone : static_cast<std::uint64_t>(*least) + 1);
  put(number.empty() ? kNone : static_cast<std::uint64_t>(*most) + 1);
  for (const Entity* entity : blocks) {
    block(entity->dimension, entity->tag, 0, entity->nodes.size());
    for (const int v : entity->nodes) put(static_cast<std::uint64_t>(number[v]) + 1);
    for (const int v : entity->nodes)
      for (int k = 0; k < 3; ++k) put(piece_.nodes[v][k]);
  }
  file_.text("\n$EndNodes\n");
}

template <std::size_t n>
void PieceWriter::element(std::uint64_t tag, const std::array<int, n>& corners) {
  put(tag);
  for (const int v : corners) put(static_cast<std::uint64_t>(piece_.node_number[v]) + 1);
}

void PieceWriter::elements() {
  std::vector<std::uint64_t> tags;
  for (const std::int64_t f : piece_.face_number) tags.push_back(static_cast<std::uint64_t>(f) + 1);
  for (const auto* list : {&piece_.tet_number, &piece_.ghost_number})
    for (const std::int64_t t : *list) tags.push_back(piece_.n_faces + static_cast<std::uint64_t>(t) + 1);
  const std::size_t n_faces = piece_.faces.size(), n_tets = piece_.tets.size();
  std::vector<std::size_t> of_patch(surfaces_.size(), 0);
  for (const int p : piece_.face_patch) ++of_patch[p];
  const auto n_blocks = static_cast<std::uint64_t>(of_patch.size()) -
                        static_cast<std::uint64_t>(std::count(of_patch.begin(), of_patch.end(), 0)) +
                        (n_tets > 0 ? 1 : 0) + (piece_.ghosts.empty() ? 0 : 1);
  file_.text("$Elements\n");
  put(n_blocks);
  put(std::uint64_t{tags.size()});
  put(tags.empty() ? kNone : *std::min_element(tags.begin(), tags.end()));
  put(tags.empty() ? kNone : *std::max_element(tags.begin(), tags.end()));
  for (std::size_t p = 0; p < surfaces_.size(); ++p) {
    if (of_patch[p] == 0) continue;
    block(2, surfaces_[p].tag, kTriangle, of_patch[p]);
    for (std::size_t f = 0; f < n_faces; ++f)
      if (piece_.face_patch[f] == static_cast<int>(p)) element(tags[f], piece_.faces[f]);
  }
  if (n_tets > 0) block(3, volume_.tag, kTetrahedron, n_tets);
  for (std::size_t t = 0; t < n_tets; ++t) element(tags[n_faces + t], piece_.tets[t]);
  if (!piece_.ghosts.empty()) block(3, ghost_.tag, kTetrahedron, piece_.ghosts.size());
  for (std::size_t g = 0; g < piece_.ghosts.size(); ++g) element(tags[n_faces + n_tets + g], piece_.ghosts[g]);
  file_.text("\n$EndElements\n");
}

void PieceWriter::ghost_elements() {
  file_.text("$GhostElements\n");
  put(std::uint64_t{piece_.ghosts.size()});
  for (std::size_t g = 0; g < piece_.ghosts.size(); ++g) {
    put(piece_.n_faces + static_cast<std::uint64_t>(piece_.ghost_number[g]) + 1);
    put(std::int32_t{piece_.ghost_part[g] + 1});
    put(std::uint64_t{1});
    put(std::int32_t{piece_.part + 1});
  }
  file_.text("\n$EndGhostElements\n");
}

void PieceWriter::boundary_data() {
  for (const auto& [name, values] : piece_.boundary_data)
    write_node_data(file_, {name, values, piece_.node_number, piece_.part + 1}, true);
}

void PieceWriter::write() {
  head();
  entities();
  partitioned_entities();
  nodes();
  elements();
  ghost_elements();
  boundary_data();
  file_.close();
}

}  // namespace

void write_msh41_piece(const std::filesystem::path& path, const MshPiece& piece) { PieceWriter(path, piece).write(); }

void write_msh41_piece(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  if (mesh.nodes_per_tet != 4) throw std::invalid_argument("parts for Gmsh are of tets with 4 nodes");
  if (!mesh.regions.empty()) throw std::invalid_argument("parts for Gmsh are of one body");
  MshPiece piece;
  piece.body = mesh.body;
  piece.patches = mesh.patches;
  piece.n_faces = mesh.n_faces();
  piece.nodes = mesh.nodes;
  piece.face_patch = mesh.face_patch;
  for (std::size_t t = 0; t < mesh.n_tets(); ++t) {
    const std::span<const int> c = mesh.tet(t);
    piece.tets.push_back({c[0], c[1], c[2], c[3]});
  }
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> c = mesh.face(f);
    piece.faces.push_back({c[0], c[1], c[2]});
  }
  piece.node_number.resize(piece.nodes.size());
  piece.tet_number.resize(piece.tets.size());
  piece.face_number.resize(piece.faces.size());
  for (auto* numbers : {&piece.node_number, &piece.tet_number, &piece.face_number})
    std::iota(numbers->begin(), numbers->end(), 0);
  piece.boundary_data = mesh.boundary_data;
  write_msh41_piece(path, piece);
}

}  // namespace umtet
