#include "mesh/io/solver_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/first_touch.h"
#include "mesh/certify/boundary_surface.h"

namespace umtet {
namespace {

constexpr std::size_t kLongestName = 64;

/// The place of the middle of edge (a, b) among the ten nodes.
constexpr int middle_of(int a, int b) {
  constexpr int kMiddle[4][4] = {{-1, 4, 6, 7}, {4, -1, 5, 8}, {6, 5, -1, 9}, {7, 8, 9, -1}};
  return kMiddle[a][b];
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

template <std::size_t N>
std::vector<int> flat(const std::vector<std::array<int, N>>& C) {
  static_assert(sizeof(std::array<int, N>) == N * sizeof(int));
  return C.empty() ? std::vector<int>() : copied(std::span<const int>(C.front().data(), N * C.size()));
}

/// @param corners  of the tets
SolverMesh divided(std::vector<Vec3> nodes, int nodes_per_tet, std::vector<int> tets, const std::vector<Tet>& corners) {
  BoundaryFaces boundary = boundary_faces(corners, nodes.size());
  SolverMesh mesh;
  mesh.nodes = std::move(nodes);
  mesh.nodes_per_tet = nodes_per_tet;
  mesh.tets = std::move(tets);
  mesh.face_tet = std::move(boundary.tets);
  mesh.face_opposite.reserve(mesh.n_faces());
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const Triangle& triangle = boundary.triangles[f];
    const Tet& tet = corners[static_cast<std::size_t>(mesh.face_tet[f])];
    const auto off = std::find_if(tet.begin(), tet.end(), [&](int v) {
      return std::find(triangle.begin(), triangle.end(), v) == triangle.end();
    });
    mesh.face_opposite.push_back(static_cast<std::uint8_t>(off - tet.begin()));
  }
  mesh.face_patch.assign(mesh.n_faces(), 0);
  mesh.patches = {{"boundary", 2}};
  return mesh;
}

}  // namespace

std::array<int, 6> SolverMesh::face(std::size_t f) const {
  const std::span<const int> nodes_of = tet(static_cast<std::size_t>(face_tet[f]));
  const auto& [a, b, c] = kTetFace[face_opposite[f]];
  std::array<int, 6> ids = {nodes_of[a], nodes_of[b], nodes_of[c], -1, -1, -1};
  if (nodes_per_tet == 10) {
    ids[3] = nodes_of[middle_of(a, b)];
    ids[4] = nodes_of[middle_of(b, c)];
    ids[5] = nodes_of[middle_of(c, a)];
  }
  return ids;
}

std::vector<int> SolverMesh::faces() const {
  std::vector<int> ids;
  ids.reserve(n_faces() * static_cast<std::size_t>(nodes_per_face()));
  for (std::size_t f = 0; f < n_faces(); ++f) {
    const std::array<int, 6> of_face = face(f);
    ids.insert(ids.end(), of_face.begin(), of_face.begin() + nodes_per_face());
  }
  return ids;
}

std::vector<Triangle> SolverMesh::triangles() const {
  std::vector<Triangle> corners;
  corners.reserve(n_faces());
  for (std::size_t f = 0; f < n_faces(); ++f) {
    const std::array<int, 6> of_face = face(f);
    corners.push_back({of_face[0], of_face[1], of_face[2]});
  }
  return corners;
}

SolverMesh solver_mesh(std::vector<Vec3> nodes, int nodes_per_tet, std::vector<int> tets) {
  if (nodes_per_tet != 4 && nodes_per_tet != 10) {
    throw std::invalid_argument(fmt::format("nodes_per_tet = {}: must be 4 or 10", nodes_per_tet));
  }
  const auto stride = static_cast<std::size_t>(nodes_per_tet);
  if (tets.size() % stride != 0) throw std::invalid_argument("the ids of the last tet are not complete");
  for (const int v : tets) {
    if (v < 0 || static_cast<std::size_t>(v) >= nodes.size()) {
      throw std::invalid_argument(fmt::format("node {} of a tet: there are {} nodes", v, nodes.size()));
    }
  }
  std::vector<Tet> corners(tets.size() / stride);
  for (std::size_t t = 0; t < corners.size(); ++t) std::copy_n(tets.begin() + t * stride, 4, corners[t].begin());
  return divided(std::move(nodes), nodes_per_tet, std::move(tets), corners);
}

SolverMesh solver_mesh(const TetMesh& mesh) {
  return divided(copied(std::span<const Vec3>(mesh.V)), 4, flat(mesh.C), mesh.C);
}
SolverMesh solver_mesh(const QuadraticTetMesh& mesh) { return solver_mesh(mesh.V, 10, flat(mesh.C)); }

std::string problem_of_name(const std::string& name) {
  if (name.empty() || !is_letter(name[0])) return "must begin with a letter";
  if (name.size() > kLongestName) return fmt::format("is longer than {} characters", kLongestName);
  const bool fits = std::all_of(name.begin(), name.end(), [](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
  });
  return fits ? "" : "may have letters, digits, '_', '-' and '.' only";
}

void set_patches(SolverMesh& mesh, std::vector<int> face_patch, std::vector<MeshPart> patches) {
  std::set<std::string> names = {lower(mesh.body.name)};
  if (patches.size() > 1) names.insert(kWholeBoundary);
  std::set<int> numbers;
  for (const MeshPart& patch : patches) {
    if (const std::string problem = problem_of_name(patch.name); !problem.empty()) {
      throw std::invalid_argument(fmt::format("the name '{}' {}", patch.name, problem));
    }
    if (patch.number < 1) {
      throw std::invalid_argument(fmt::format("patch {}: number {} must be >= 1", patch.name, patch.number));
    }
    if (!names.insert(lower(patch.name)).second) {
      throw std::invalid_argument(fmt::format("two parts are called {} (case aside)", patch.name));
    }
    if (!numbers.insert(patch.number).second) {
      throw std::invalid_argument(fmt::format("two patches have the number {}", patch.number));
    }
  }
  mesh.face_patch = std::move(face_patch);
  mesh.patches = std::move(patches);
  mesh.body.number = 1;
  while (numbers.contains(mesh.body.number)) ++mesh.body.number;
  require_consistent(mesh);
}

std::vector<std::vector<int>> patch_nodes(const SolverMesh& mesh) {
  std::vector<std::vector<int>> nodes(mesh.patches.size());
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> ids = mesh.face(f);
    std::vector<int>& of_patch = nodes[static_cast<std::size_t>(mesh.face_patch[f])];
    of_patch.insert(of_patch.end(), ids.begin(), ids.begin() + mesh.nodes_per_face());
  }
  for (std::vector<int>& ids : nodes) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  }
  return nodes;
}

std::vector<int> curve_nodes(const MeshCurve& curve) {
  std::vector<int> nodes;
  for (const auto& [a, b] : curve.edges) nodes.insert(nodes.end(), {a, b});
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void set_curves(SolverMesh& mesh, std::vector<MeshCurve> curves) {
  std::set<std::string> names = {lower(mesh.body.name), kWholeBoundary};
  for (const MeshPart& patch : mesh.patches) names.insert(lower(patch.name));
  for (const MeshCurve& curve : curves) {
    const std::string& name = curve.part.name;
    if (const std::string problem = problem_of_name(name); !problem.empty())
      throw std::invalid_argument(fmt::format("the name '{}' {}", name, problem));
    if (!names.insert(lower(name)).second)
      throw std::invalid_argument(fmt::format("two parts are called {} (case aside)", name));
    for (const int v : curve_nodes(curve)) {
      if (v < 0 || static_cast<std::size_t>(v) >= mesh.nodes.size())
        throw std::invalid_argument(fmt::format("curve {}: there is no node {}", name, v));
    }
  }
  mesh.curves = std::move(curves);
}

std::vector<int> boundary_nodes(const SolverMesh& mesh) {
  std::vector<int> nodes = mesh.faces();
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void require_consistent(const SolverMesh& mesh) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("solver mesh: ") + what);
  };
  const auto below = [](const auto& ids, std::size_t n) {
    return std::all_of(ids.begin(), ids.end(), [n](auto i) { return i >= 0 && static_cast<std::size_t>(i) < n; });
  };
  require(mesh.nodes_per_tet == 4 || mesh.nodes_per_tet == 10, "tets have 4 or 10 nodes");
  require(mesh.tets.size() % static_cast<std::size_t>(mesh.nodes_per_tet) == 0, "the last tet is not complete");
  require(below(mesh.tets, mesh.nodes.size()), "a node of a tet does not exist");
  require(below(mesh.face_tet, mesh.n_tets()), "the tet of a face does not exist");
  require(mesh.face_opposite.size() == mesh.n_faces() && below(mesh.face_opposite, 4), "one corner 0..3 a face");
  require(mesh.face_patch.size() == mesh.n_faces() && below(mesh.face_patch, mesh.patches.size()), "one patch a face");
  const auto sized = [](const auto& data, std::size_t n) {
    return std::all_of(data.begin(), data.end(), [n](const auto& named) {
      return std::visit([n](const auto& values) { return values.size() == n; }, named.second);
    });
  };
  require(sized(mesh.point_data, mesh.nodes.size()), "point data: one value a node");
  require(sized(mesh.boundary_data, mesh.nodes.size()), "boundary data: one value a node");
  require(sized(mesh.cell_data, mesh.n_tets()), "cell data: one value a tet");
}

}  // namespace umtet
