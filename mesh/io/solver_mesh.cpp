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
constexpr int kSeveral = -2;  // regions

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

Triangle sorted_corners(const SolverMesh& mesh, std::size_t t, int opposite) {
  const std::span<const int> nodes = mesh.tet(t);
  Triangle key = {nodes[kTetFace[opposite][0]], nodes[kTetFace[opposite][1]], nodes[kTetFace[opposite][2]]};
  std::sort(key.begin(), key.end());
  return key;
}

/// A face between two regions, by a tet on either side.
struct FaceBetween {
  int tet, other_tet;
  std::uint8_t opposite, other_opposite;
};

/// The faces between tets of different regions, by their first tet.
std::vector<FaceBetween> faces_between(const SolverMesh& mesh, const std::vector<int>& tet_region) {
  // Both sides of such a face have all of its corners in common.
  std::vector<int> region_at(mesh.nodes.size(), -1);
  for (std::size_t t = 0; t < tet_region.size(); ++t)
    for (const int v : mesh.tet(t).first<4>())
      region_at[v] = region_at[v] == -1 || region_at[v] == tet_region[t] ? tet_region[t] : kSeveral;
  struct Side {
    Triangle key;
    int tet;
    std::uint8_t opposite;
  };
  std::vector<Side> sides;
  for (std::size_t t = 0; t < tet_region.size(); ++t) {
    for (std::uint8_t k = 0; k < 4; ++k) {
      const Triangle key = sorted_corners(mesh, t, k);
      if (std::all_of(key.begin(), key.end(), [&](int v) { return region_at[v] == kSeveral; }))
        sides.push_back({key, static_cast<int>(t), k});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return std::pair(a.key, a.tet) < std::pair(b.key, b.tet); });
  std::vector<FaceBetween> faces;
  for (std::size_t k = 1; k < sides.size(); ++k) {
    const Side &a = sides[k - 1], &b = sides[k];
    if (a.key == b.key && tet_region[a.tet] != tet_region[b.tet])
      faces.push_back({a.tet, b.tet, a.opposite, b.opposite});
  }
  std::sort(faces.begin(), faces.end(), [](const FaceBetween& a, const FaceBetween& b) {
    return std::pair(a.tet, a.opposite) < std::pair(b.tet, b.opposite);
  });
  return faces;
}

/// Whether interface_name() names region a first.
bool is_first(int a, int b) { return b == 0 || (a != 0 && a < b); }

void require_region_names(const std::vector<std::string>& names) {
  std::set<std::string> known;
  for (const std::string& name : names) {
    if (const std::string problem = problem_of_region_name(name); !problem.empty())
      throw std::invalid_argument(fmt::format("the name '{}' {}", name, problem));
    if (!known.insert(lower(name)).second)
      throw std::invalid_argument(fmt::format("two regions are called {} (case aside)", name));
  }
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
  mesh.interfaces.clear();
  mesh.body.number = 1;
  while (numbers.contains(mesh.body.number)) ++mesh.body.number;
  require_consistent(mesh);
}

std::string problem_of_region_name(const std::string& name) {
  if (name.size() > kLongestRegionName) return fmt::format("is longer than {} characters", kLongestRegionName);
  if (lower(name) == kWholeBoundary || lower(name) == kRegionWalls) return "is the name of faces of the boundary";
  return problem_of_name(name);
}

std::string interface_name(const std::vector<std::string>& names, int a, int b) {
  if (!is_first(a, b)) std::swap(a, b);
  return names[static_cast<std::size_t>(a)] + "|" + names[static_cast<std::size_t>(b)];
}

void set_regions(SolverMesh& mesh, const std::vector<int>& tet_region, const std::vector<std::string>& names) {
  if (tet_region.size() != mesh.n_tets()) throw std::invalid_argument("one region for each tet");
  if (std::any_of(tet_region.begin(), tet_region.end(),
                  [&](int r) { return r < 0 || static_cast<std::size_t>(r) >= names.size(); }))
    throw std::invalid_argument("a tet is in a region without a name");
  require_region_names(names);
  const auto n = static_cast<int>(names.size());
  std::vector<int> index(names.size(), -1);  // of regions with tets
  for (const int r : tet_region) index[r] = 0;
  mesh.regions.clear();
  for (int r = 0; r < n; ++r) {
    if (index[r] < 0) continue;
    index[r] = static_cast<int>(mesh.regions.size());
    mesh.regions.push_back({names[r], r == 0 ? n : r});
  }
  mesh.tet_region.resize(tet_region.size());
  std::vector<std::int64_t> numbers(tet_region.size());
  for (std::size_t t = 0; t < tet_region.size(); ++t) {
    mesh.tet_region[t] = index[tet_region[t]];
    numbers[t] = mesh.regions[mesh.tet_region[t]].number;
  }
  mesh.cell_data["region"] = std::move(numbers);

  // Faces of former interfaces are replaced.
  std::size_t n_boundary = mesh.n_faces();
  while (n_boundary > 0 && mesh.is_interface(mesh.face_patch[n_boundary - 1])) --n_boundary;
  mesh.face_tet.resize(n_boundary);
  mesh.face_opposite.resize(n_boundary);
  const bool has_outside = index[0] == 0;
  std::map<int, int> boundary_patch;                   // of a region
  std::map<std::pair<int, int>, int> interface_patch;  // of two, the first one first
  for (const int t : mesh.face_tet) boundary_patch[tet_region[t]] = 0;
  const std::vector<FaceBetween> between = faces_between(mesh, tet_region);
  const auto pair_of = [&](const FaceBetween& f) {
    const int a = tet_region[f.tet], b = tet_region[f.other_tet];
    return is_first(a, b) ? std::pair(a, b) : std::pair(b, a);
  };
  for (const FaceBetween& f : between) interface_patch[pair_of(f)] = 0;
  mesh.patches.clear();
  mesh.interfaces.clear();
  const auto add_patch = [&](std::string name) {
    mesh.patches.push_back({std::move(name), n + 1 + static_cast<int>(mesh.patches.size())});
    return static_cast<int>(mesh.patches.size()) - 1;
  };
  for (auto& [r, patch] : boundary_patch)
    patch = add_patch(!has_outside ? names[r] + "|" + names[0] : r == 0 ? kRegionWalls : names[r] + "|" + kRegionWalls);
  for (auto& [pair, patch] : interface_patch) {
    patch = add_patch(interface_name(names, pair.first, pair.second));
    mesh.interfaces.push_back({index[pair.first], index[pair.second]});
  }
  mesh.face_patch.clear();
  for (const int t : mesh.face_tet) mesh.face_patch.push_back(boundary_patch[tet_region[t]]);
  for (const FaceBetween& f : between) {
    const bool is_ours = is_first(tet_region[f.tet], tet_region[f.other_tet]);
    mesh.face_tet.push_back(is_ours ? f.tet : f.other_tet);
    mesh.face_opposite.push_back(is_ours ? f.opposite : f.other_opposite);
    mesh.face_patch.push_back(interface_patch[pair_of(f)]);
  }
  mesh.curves.clear();
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
  std::vector<int> nodes;
  nodes.reserve(mesh.n_faces() * static_cast<std::size_t>(mesh.nodes_per_face()));
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    if (mesh.is_interface(mesh.face_patch[f])) continue;
    const std::array<int, 6> ids = mesh.face(f);
    nodes.insert(nodes.end(), ids.begin(), ids.begin() + mesh.nodes_per_face());
  }
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
  require(mesh.regions.empty() == mesh.tet_region.empty() || mesh.n_tets() == 0, "regions without tets of them");
  require(
      mesh.regions.empty() || (mesh.tet_region.size() == mesh.n_tets() && below(mesh.tet_region, mesh.regions.size())),
      "one region a tet");
  require(mesh.interfaces.size() <= mesh.patches.size(), "more interfaces than patches");
  for (const std::array<int, 2>& sides : mesh.interfaces)
    require(below(sides, mesh.regions.size()), "a region of an interface does not exist");
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
