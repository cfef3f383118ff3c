#include <Eigen/Geometry>
#include <cstdint>
#include <limits>

#include "mesh/detail/checked_file.h"
#include "mesh/tet_mesh_io.h"

namespace umtet {
namespace {

constexpr int kTriangle = 2, kTetrahedron = 4;  // Gmsh's element types
constexpr int kBody = 1, kBoundary = 2;         // physical groups; entities carry the same numbers

void write_head(detail::CheckedFile& file, const char* version, MshEncoding encoding) {
  file.text("$MeshFormat\n").text(version).text(encoding == MshEncoding::Binary ? " 1 8\n" : " 0 8\n");
  if (encoding == MshEncoding::Binary) file.raw(std::int32_t{1}).text("\n");  // tells the reader our byte order
  file.text("$EndMeshFormat\n$PhysicalNames\n2\n2 ").number(kBoundary).text(" \"boundary\"\n3 ");
  file.number(kBody).text(" \"body\"\n$EndPhysicalNames\n");
}

/// One number, followed by a separator in ascii files only.
template <typename T>
void put(detail::CheckedFile& file, MshEncoding encoding, T value, const char* separator) {
  if (encoding == MshEncoding::Binary) {
    file.raw(value);
  } else {
    file.number(value).text(separator);
  }
}

void put_point(detail::CheckedFile& file, MshEncoding encoding, const Vec3& x, const char* last) {
  for (int k = 0; k < 3; ++k) put(file, encoding, x[k], k < 2 ? " " : last);
}

void check_sizes(const TetMesh& mesh, const std::vector<Triangle>& boundary) {
  if (mesh.C.size() + boundary.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw std::invalid_argument("a .msh file of more than 2^31 elements");
  }
}

template <typename Simplices>
void write_elements22(detail::CheckedFile& file, MshEncoding encoding, const Simplices& simplices, int type, int group,
                      std::int32_t& id) {
  if (simplices.empty()) return;
  constexpr std::int32_t kTags = 2;  // physical group, entity
  if (encoding == MshEncoding::Binary) {
    file.raw(std::int32_t{type}).raw(static_cast<std::int32_t>(simplices.size())).raw(kTags);
  }
  for (const auto& simplex : simplices) {
    put(file, encoding, ++id, " ");
    if (encoding == MshEncoding::Ascii) file.number(type).text(" ").number(kTags).text(" ");
    put(file, encoding, std::int32_t{group}, " ");
    put(file, encoding, std::int32_t{group}, " ");
    for (std::size_t k = 0; k < simplex.size(); ++k) {
      put(file, encoding, std::int32_t{simplex[k] + 1}, k + 1 < simplex.size() ? " " : "\n");
    }
  }
}

void write_entities41(detail::CheckedFile& file, MshEncoding encoding, const Eigen::AlignedBox3d& box,
                      std::uint64_t n_surfaces) {
  file.text("$Entities\n");
  const std::uint64_t none = 0, one = 1;
  put(file, encoding, none, " ");
  put(file, encoding, none, " ");
  put(file, encoding, n_surfaces, " ");
  put(file, encoding, one, "\n");
  const auto put_entity = [&](int entity, std::uint64_t n_bounding) {
    put(file, encoding, std::int32_t{entity}, " ");
    put_point(file, encoding, box.min(), " ");
    put_point(file, encoding, box.max(), " ");
    put(file, encoding, one, " ");
    put(file, encoding, std::int32_t{entity}, " ");
    put(file, encoding, n_bounding, n_bounding ? " " : "\n");
  };
  if (n_surfaces) put_entity(kBoundary, none);
  put_entity(kBody, n_surfaces);
  if (n_surfaces) put(file, encoding, std::int32_t{kBoundary}, "\n");
  file.text("$EndEntities\n");
}

void write_block_head41(detail::CheckedFile& file, MshEncoding encoding, int dimension, int entity, int third,
                        std::size_t n) {
  put(file, encoding, std::int32_t{dimension}, " ");
  put(file, encoding, std::int32_t{entity}, " ");
  put(file, encoding, std::int32_t{third}, " ");
  put(file, encoding, std::uint64_t{n}, "\n");
}

void write_nodes41(detail::CheckedFile& file, MshEncoding encoding, const TetMesh& mesh,
                   const std::vector<Triangle>& boundary) {
  std::vector<char> on_boundary(mesh.V.size(), 0);
  for (const Triangle& f : boundary) {
    for (const int v : f) on_boundary[v] = 1;
  }
  std::vector<int> of_entity[2];  // a node belongs to the entity of least dimension it lies on
  for (std::size_t i = 0; i < mesh.V.size(); ++i) of_entity[on_boundary[i] ? 0 : 1].push_back(static_cast<int>(i));

  file.text("$Nodes\n");
  put(file, encoding, std::uint64_t{!of_entity[0].empty()} + std::uint64_t{!of_entity[1].empty()}, " ");
  put(file, encoding, std::uint64_t{mesh.V.size()}, " ");
  put(file, encoding, std::uint64_t{mesh.V.empty() ? 0u : 1u}, " ");
  put(file, encoding, std::uint64_t{mesh.V.size()}, "\n");
  for (int e = 0; e < 2; ++e) {
    if (of_entity[e].empty()) continue;
    write_block_head41(file, encoding, 2 + e, e == 0 ? kBoundary : kBody, 0, of_entity[e].size());
    for (const int i : of_entity[e]) put(file, encoding, static_cast<std::uint64_t>(i) + 1, "\n");
    for (const int i : of_entity[e]) put_point(file, encoding, mesh.V[i], "\n");
  }
  file.text("$EndNodes\n");
}

template <typename Simplices>
void write_elements41(detail::CheckedFile& file, MshEncoding encoding, const Simplices& simplices, int dimension,
                      int group, int type, std::uint64_t& id) {
  if (simplices.empty()) return;
  write_block_head41(file, encoding, dimension, group, type, simplices.size());
  for (const auto& simplex : simplices) {
    put(file, encoding, ++id, " ");
    for (std::size_t k = 0; k < simplex.size(); ++k) {
      put(file, encoding, static_cast<std::uint64_t>(simplex[k]) + 1, k + 1 < simplex.size() ? " " : "\n");
    }
  }
}

}  // namespace

void write_msh22(const std::filesystem::path& path, const TetMesh& mesh, const std::vector<Triangle>& boundary,
                 MshEncoding encoding) {
  check_sizes(mesh, boundary);
  detail::CheckedFile file(path);
  write_head(file, "2.2", encoding);
  file.text("$Nodes\n").number(mesh.V.size()).text("\n");
  for (std::size_t i = 0; i < mesh.V.size(); ++i) {
    put(file, encoding, static_cast<std::int32_t>(i) + 1, " ");
    put_point(file, encoding, mesh.V[i], "\n");
  }
  file.text("$EndNodes\n$Elements\n").number(mesh.C.size() + boundary.size()).text("\n");
  std::int32_t id = 0;
  write_elements22(file, encoding, boundary, kTriangle, kBoundary, id);
  write_elements22(file, encoding, mesh.C, kTetrahedron, kBody, id);
  file.text("$EndElements\n");
  file.close();
}

void write_msh41(const std::filesystem::path& path, const TetMesh& mesh, const std::vector<Triangle>& boundary,
                 MshEncoding encoding) {
  check_sizes(mesh, boundary);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : mesh.V) box.extend(x);
  if (mesh.V.empty()) box.extend(Vec3::Zero().eval());
  detail::CheckedFile file(path);
  write_head(file, "4.1", encoding);
  write_entities41(file, encoding, box, boundary.empty() ? 0 : 1);
  write_nodes41(file, encoding, mesh, boundary);
  const std::uint64_t n = mesh.C.size() + boundary.size();
  file.text("$Elements\n");
  put(file, encoding, std::uint64_t{!boundary.empty()} + std::uint64_t{!mesh.C.empty()}, " ");
  put(file, encoding, n, " ");
  put(file, encoding, std::uint64_t{n > 0}, " ");
  put(file, encoding, n, "\n");
  std::uint64_t id = 0;
  write_elements41(file, encoding, boundary, 2, kBoundary, kTriangle, id);
  write_elements41(file, encoding, mesh.C, 3, kBody, kTetrahedron, id);
  file.text("$EndElements\n");
  file.close();
}

}  // namespace umtet
