#include "mesh/io/tet_mesh_io.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/quality_report.h"
#include "mesh/core/used_vertices.h"
#include "mesh/io/detail/mesh_formats.h"

namespace umtet {

MeshFileRefused::MeshFileRefused(const std::filesystem::path& path, const std::string& place, const std::string& reason)
    : std::runtime_error(path.string() + (place.empty() ? "" : ": " + place) + ": " + reason) {}

MeshFile with_standard_data(TetMesh mesh, std::vector<std::int64_t> background_vertex,
                            std::vector<std::int64_t> background_tet) {
  if (!background_vertex.empty() && background_vertex.size() != mesh.V.size()) {
    throw std::invalid_argument("background_vertex: one id per vertex, or none");
  }
  if (!background_tet.empty() && background_tet.size() != mesh.C.size()) {
    throw std::invalid_argument("background_tet: one id per tet, or none");
  }
  std::vector<std::uint8_t> boundary(mesh.V.size(), 0);
  for (const Triangle& f : boundary_faces(mesh.C, mesh.V.size()).triangles) {
    for (const int v : f) boundary[v] = 1;
  }
  MeshFile file;
  file.cell_data.emplace("mean_ratio", mean_ratios(mesh));
  file.mesh = std::move(mesh);
  file.point_data.emplace("boundary", std::move(boundary));
  if (!background_vertex.empty()) file.point_data.emplace("background_vertex", std::move(background_vertex));
  if (!background_tet.empty()) file.cell_data.emplace("background_tet", std::move(background_tet));
  return file;
}

MeshFile read_tet_mesh(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".vtu") return detail::read_vtu(path);
  if (extension == ".msh") return detail::read_msh(path);
  if (extension == ".mesh") return detail::read_medit(path);
  if (extension == ".inp") return detail::read_inp(path);
  throw MeshFileRefused(path, "", "unknown extension: .vtu, .msh, .mesh and .inp are read");
}

namespace detail {

void refuse_broken_tets(const std::filesystem::path& path, const TetMesh& mesh,
                        const std::function<std::int64_t(std::size_t)>& vertex_number,
                        const std::function<std::int64_t(std::size_t)>& tet_number) {
  const auto name = [&](int v) { return std::to_string(vertex_number(static_cast<std::size_t>(v))); };
  for (std::size_t t = 0; t < mesh.C.size(); ++t) {
    const Tet& tet = mesh.C[t];
    for (int k = 0; k < 4; ++k) {
      if (std::find(tet.begin(), tet.begin() + k, tet[k]) != tet.begin() + k) {
        throw MeshFileRefused(path, "tet " + std::to_string(tet_number(t)),
                              "it has its node " + name(tet[k]) + " twice");
      }
      if (!mesh.V[tet[k]].allFinite()) {
        throw MeshFileRefused(path, "node " + name(tet[k]), "a coordinate is not a finite number");
      }
    }
  }
}

void take_mid_sides(const std::filesystem::path& path, MeshFile& file, const std::vector<MidSideNodes>& mid_sides,
                    const std::function<std::int64_t(std::size_t)>& vertex_number) {
  const TetMesh& mesh = file.mesh;
  if (mid_sides.empty() || mid_sides.size() != mesh.C.size()) return;
  enum Role : std::uint8_t { Unused, Corner, MidSide };
  std::vector<Role> role(mesh.V.size(), Unused);
  for (const Tet& t : mesh.C) {
    for (const int v : t) role[v] = Corner;
  }
  for (const MidSideNodes& nodes : mid_sides) {
    for (const int v : nodes) {
      const char* reason = role[v] == Corner        ? "it is a mid-side of one tet and a corner of another"
                           : !mesh.V[v].allFinite() ? "a coordinate is not a finite number"
                                                    : nullptr;
      if (reason) {
        throw MeshFileRefused(path, "node " + std::to_string(vertex_number(static_cast<std::size_t>(v))), reason);
      }
      role[v] = MidSide;
    }
  }
  QuadraticTetMesh& quadratic = file.quadratic.emplace();
  std::vector<int> new_index(mesh.V.size(), -1);
  std::vector<std::size_t> nodes;
  for (const Role wanted : {Corner, MidSide}) {
    for (std::size_t v = 0; v < role.size(); ++v) {
      if (role[v] != wanted) continue;
      new_index[v] = static_cast<int>(nodes.size());
      nodes.push_back(v);
    }
  }
  const auto of_nodes = [&](const auto& values) {
    std::decay_t<decltype(values)> some;
    some.reserve(nodes.size());
    for (const std::size_t v : nodes) some.push_back(values[v]);
    return some;
  };
  quadratic.V = of_nodes(mesh.V);
  for (const auto& [name, any] : file.point_data) {
    file.quadratic_data[name] = std::visit([&](const auto& values) -> FieldValues { return of_nodes(values); }, any);
  }
  quadratic.C.resize(mesh.C.size());
  for (std::size_t t = 0; t < mesh.C.size(); ++t) {
    for (int k = 0; k < 10; ++k) quadratic.C[t][k] = new_index[k < 4 ? mesh.C[t][k] : mid_sides[t][k - 4]];
  }
}

void drop_unused_vertices(MeshFile& file) {
  const UsedVertices used(file.mesh.C, file.mesh.V.size());
  const auto n = static_cast<std::size_t>(used.n());
  if (n == file.mesh.V.size()) return;
  file.n_unused_vertices = file.mesh.V.size() - (file.quadratic ? file.quadratic->V.size() : n);
  used.keep(file.mesh.V);
  for (auto& [name, values] : file.point_data) std::visit([&](auto& of_points) { used.keep(of_points); }, values);
  for (Tet& t : file.mesh.C) used.renumber(t);
}

MeshFile assemble(const std::filesystem::path& path, NumberedMesh&& numbered) {
  const std::vector<std::int64_t>& number = numbered.number;
  if (number.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      numbered.tets.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw MeshFileRefused(path, "", "more than 2^31 nodes or tets");
  }
  std::vector<int> order(number.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) { return number[i] < number[j]; });
  std::vector<std::int64_t> sorted;
  sorted.reserve(number.size());
  MeshFile file;
  file.mesh.V.reserve(number.size());
  for (const int i : order) {
    if (!sorted.empty() && sorted.back() == number[i]) {
      throw MeshFileRefused(path, "", "node " + std::to_string(number[i]) + " is given twice");
    }
    sorted.push_back(number[i]);
    file.mesh.V.push_back(numbered.point[i]);
  }
  // Nearly every file numbers its nodes without a gap: then the place is known without a search.
  const auto index_of = [&](std::int64_t wanted, std::size_t t) {
    const std::uint64_t guess =  // unsigned: numbers may be as far apart as 64 bits allow
        sorted.empty() ? 0 : static_cast<std::uint64_t>(wanted) - static_cast<std::uint64_t>(sorted.front());
    auto found = guess < sorted.size() && sorted[guess] == wanted
                     ? sorted.begin() + static_cast<std::ptrdiff_t>(guess)
                     : std::lower_bound(sorted.begin(), sorted.end(), wanted);
    if (found == sorted.end() || *found != wanted) {
      throw MeshFileRefused(path, "tet " + std::to_string(t + 1),
                            "its node " + std::to_string(wanted) + " does not exist");
    }
    return static_cast<int>(found - sorted.begin());
  };
  file.mesh.C.resize(numbered.tets.size());
  for (std::size_t t = 0; t < numbered.tets.size(); ++t) {
    for (int k = 0; k < 4; ++k) file.mesh.C[t][k] = index_of(numbered.tets[t][k], t);
  }
  std::vector<MidSideNodes> mid_sides;
  if (numbered.mid_sides.size() == numbered.tets.size()) mid_sides.resize(numbered.tets.size());
  for (std::size_t t = 0; t < mid_sides.size(); ++t) {
    for (int k = 0; k < 6; ++k) mid_sides[t][k] = index_of(numbered.mid_sides[t][k], t);
  }
  refuse_broken_tets(
      path, file.mesh, [&](std::size_t v) { return sorted[v]; },
      [](std::size_t t) { return static_cast<std::int64_t>(t) + 1; });
  take_mid_sides(path, file, mid_sides, [&](std::size_t v) { return sorted[v]; });
  const std::vector<std::int64_t>& region = numbered.region;
  if (std::adjacent_find(region.begin(), region.end(), std::not_equal_to<>()) != region.end()) {
    file.cell_data.emplace("region", std::move(numbered.region));
    file.region_names = std::move(numbered.region_names);
  }
  drop_unused_vertices(file);
  return file;
}

}  // namespace detail
}  // namespace umtet
