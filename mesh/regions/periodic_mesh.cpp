#include "mesh/regions/periodic_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "common/disjoint_sets.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/regions/detail/periodic_cells.h"
#include "mesh/regions/detail/region_fit.h"
#include "mesh/regions/detail/region_parts.h"

namespace umtet {
namespace {

using detail::PeriodicCells;
using Periods = std::array<int, 3>;

// Fewer cells, and a tet may meet itself around the torus.
constexpr int kFewestCells = 4;
// Three coordinates of a point are near at most three of so many cuts.
constexpr int kCuts = 4;
// The first cut is this far from the side of the box, in cells: no centroid of a background tet lies on it.
constexpr double kOffLattice = 1. / 37;
// Of moving pinched vertices off the cut: in the bodies of the tests two rounds are enough.
constexpr int kCutRounds = 20;
// Points at which functions are compared with those one period away, along each axis.
constexpr int kProbes = 7;
// Shares of the time at which steps begin.
constexpr double kProject = .3, kRepair = .6, kFinish = .9;

/// A corner of a tet on a torus: a copy of a vertex.
struct Corner {
  int vertex;
  Periods copy;
};

/// A mesh on a torus.
struct TorusMesh {
  Vec3 sides;
  std::vector<Vec3> V;
  std::vector<std::array<Corner, 4>> C;
  std::vector<int> region;
  std::vector<std::int64_t> background_vertex, background_tet;
  double h;

  Vec3 at(const Corner& c) const {
    return V[static_cast<std::size_t>(c.vertex)] + Vec3(c.copy[0], c.copy[1], c.copy[2]).cwiseProduct(sides);
  }
};

/// A torus cut open, with the corner that each vertex is.
struct CutMesh {
  RegionMesh mesh;              ///< background_vertex and background_tet are numbers in `corner` and in the torus
  std::vector<Corner> corner;   ///< per vertex
  std::vector<char> is_on_cut;  ///< per vertex: it has several copies
};

/// Lattice coordinates of a box: x = origin + scale y.
struct TorusLattice {
  BackgroundMesh background;
  BackgroundMesh::Cell n;
  Vec3 origin, scale, sides;  ///< sides: of the box in y
};

TorusLattice lattice_of(const Box& box, double h) {
  if (!(h > 0)) throw std::invalid_argument("h must be > 0");
  if (box.isEmpty()) throw std::invalid_argument("box: must not be empty");
  const double cell = h / a15().mean_edge * a15().period[0];
  BackgroundMesh::Cell n{};
  Vec3 edges;
  for (int a = 0; a < 3; ++a) {
    n[a] = std::llround(box.sizes()[a] / cell);
    if (n[a] < kFewestCells)
      throw std::invalid_argument("h = " + std::to_string(h) + ": fewer than four cells fit along a side; at most " +
                                  std::to_string(h * box.sizes().minCoeff() / (kFewestCells * cell)) + " is possible");
    edges[a] = box.sizes()[a] / static_cast<double>(n[a]);
  }
  const double edge = std::cbrt(edges.prod());
  // The lattice takes whole cells around a box that is a little smaller than they are.
  const Vec3 cells(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]));
  const Vec3 padded = edge * (cells.array() + (2 * PeriodicCells::kLayers - .75)).matrix();
  const Vec3 middle = edge * cells / 2;
  BackgroundMesh background(a15(), Box(middle - padded / 2, middle + padded / 2), edge / cell * h);
  for (int a = 0; a < 3; ++a)
    if (background.n_cells()[a] != n[a] + 2 * PeriodicCells::kLayers)
      throw std::logic_error("a periodic lattice has another number of cells");
  return {std::move(background), n, box.min(), edges / edge, edge * cells};
}

/// \throw std::invalid_argument  a function has other values one period away
void check_periods(const RegionDomain& domain, const Box& box) {
  for (const PatchFunction& f : domain.functions()) {
    double greatest = 0, difference = 0;
    int axis = 0;
    for (int i = 0; i < kProbes * kProbes * kProbes; ++i) {
      const Vec3 at = Vec3(i % kProbes, i / kProbes % kProbes, i / kProbes / kProbes).array() / kProbes;
      const Vec3 x = box.min() + at.cwiseProduct(box.sizes());
      const double value = f(x, nullptr, nullptr);
      greatest = std::max(greatest, std::abs(value));
      for (int a = 0; a < 3; ++a) {
        const double off = std::abs(f(x + box.sizes()[a] * Vec3::Unit(a), nullptr, nullptr) - value);
        if (off > difference) difference = off, axis = a;
      }
    }
    if (difference > kPeriodicTolerance * greatest)
      throw std::invalid_argument(std::string("a function does not repeat in the box: along ") + "xyz"[axis] +
                                  " its values differ by up to " + std::to_string(difference));
  }
}

TorusMesh torus_of(const TorusLattice& lattice, const PeriodicCells& cells, const std::vector<std::uint8_t>& label) {
  const BackgroundMesh& background = lattice.background;
  TorusMesh torus;
  torus.sides = lattice.sides;
  torus.h = background.h();
  std::vector<int> number(label.size(), -1);
  const double cell = lattice.sides[0] / static_cast<double>(lattice.n[0]);
  for (std::int64_t t = 0; t < background.n_tets(); ++t) {
    const auto tet = background.tet(t);
    Vec3 centroid = Vec3::Zero();
    for (const std::int64_t v : tet) centroid += background.position(v) / 4;
    const Eigen::Array3d from_cut = centroid.array() + kOffLattice * cell;
    if ((from_cut < 0).any() || (from_cut >= lattice.sides.array()).any()) continue;
    std::array<Corner, 4> corners{};
    std::uint8_t region = 0;
    for (int k = 0; k < 4; ++k) {
      const std::int64_t v = cells.representative(tet[k]);
      int& local = number[static_cast<std::size_t>(v)];
      if (local < 0) {
        local = static_cast<int>(torus.V.size());
        torus.V.push_back(background.position(v));
        torus.background_vertex.push_back(v);
      }
      corners[k] = {local, cells.copy(tet[k])};
      region = std::max(region, label[static_cast<std::size_t>(v)]);
    }
    torus.C.push_back(corners);
    torus.region.push_back(region);
    torus.background_tet.push_back(t);
  }
  return torus;
}

std::vector<RegionSet> regions_at_vertices(const TorusMesh& torus) {
  std::vector<RegionSet> regions(torus.V.size(), 0);
  for (std::size_t t = 0; t < torus.C.size(); ++t)
    for (const Corner& c : torus.C[t]) regions[c.vertex] |= RegionSet{1} << torus.region[t];
  return regions;
}

/// Where each tet lies: its centroid is in the box whose lowest corner is `first`.
std::vector<Periods> periods_by_centroid(const TorusMesh& torus, const Vec3& first) {
  std::vector<Periods> periods;
  periods.reserve(torus.C.size());
  for (const auto& tet : torus.C) {
    Vec3 centroid = Vec3::Zero();
    for (const Corner& c : tet) centroid += torus.at(c) / 4;
    const Eigen::Array3i n = ((centroid - first).array() / torus.sides.array()).floor().cast<int>();
    periods.push_back({-n[0], -n[1], -n[2]});
  }
  return periods;
}

/// Cuts a torus open.
/// @param periods  added to the copies of the corners of each tet
CutMesh cut_open(const TorusMesh& torus, const std::vector<Periods>& periods) {
  CutMesh cut;
  RegionMesh& made = cut.mesh;
  const std::vector<RegionSet> regions = regions_at_vertices(torus);
  std::vector<int> n_copies(torus.V.size(), 0);
  std::unordered_map<std::uint64_t, int> number;
  number.reserve(torus.V.size());
  made.mesh.C.reserve(torus.C.size());
  for (std::size_t t = 0; t < torus.C.size(); ++t) {
    Tet local{};
    for (int k = 0; k < 4; ++k) {
      Corner c = torus.C[t][k];
      auto key = static_cast<std::uint64_t>(c.vertex);
      for (int a = 0; a < 3; ++a) {
        c.copy[a] += periods[t][a];
        key = key << 8 | static_cast<std::uint8_t>(c.copy[a]);
      }
      const auto [at, is_new] = number.try_emplace(key, static_cast<int>(cut.corner.size()));
      if (is_new) {
        made.background_vertex.push_back(static_cast<std::int64_t>(cut.corner.size()));
        cut.corner.push_back(c);
        made.mesh.V.push_back(torus.at(c));
        made.regions_at.push_back(regions[c.vertex]);
        ++n_copies[c.vertex];
      }
      local[k] = at->second;
    }
    made.mesh.C.push_back(local);
    made.background_tet.push_back(static_cast<std::int64_t>(t));
  }
  made.region = torus.region;
  made.h.assign(made.mesh.V.size(), torus.h);
  for (const Corner& c : cut.corner) cut.is_on_cut.push_back(n_copies[c.vertex] > 1 ? 1 : 0);
  return cut;
}

/// Vertices at which the boundary faces do not form one fan, and one vertex of each edge without exactly two faces.
std::vector<int> pinched_vertices(const TetMesh& mesh) {
  const std::vector<Triangle> faces = boundary_faces(mesh.C, mesh.V.size()).triangles;
  std::map<std::pair<int, int>, std::vector<int>> of_edge;
  std::map<int, std::vector<int>> of_vertex;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      of_edge[std::minmax(faces[f][k], faces[f][(k + 1) % 3])].push_back(static_cast<int>(f));
      of_vertex[faces[f][k]].push_back(static_cast<int>(f));
    }
  DisjointSets sets(3 * faces.size());  // the corners of faces
  const auto corner = [&](int f, int v) {
    const Triangle& t = faces[static_cast<std::size_t>(f)];
    return 3 * f + static_cast<int>(std::find(t.begin(), t.end(), v) - t.begin());
  };
  std::vector<int> pinched;
  for (const auto& [edge, two] : of_edge) {
    if (two.size() != 2) {
      pinched.push_back(edge.first);
      continue;
    }
    for (const int v : {edge.first, edge.second}) sets.unite(corner(two[0], v), corner(two[1], v));
  }
  for (const auto& [v, around] : of_vertex)
    if (std::any_of(around.begin(), around.end(),
                    [&, v = v](int f) { return sets.find(corner(f, v)) != sets.find(corner(around[0], v)); }))
      pinched.push_back(v);
  std::sort(pinched.begin(), pinched.end());
  pinched.erase(std::unique(pinched.begin(), pinched.end()), pinched.end());
  return pinched;
}

/// Cuts a torus open so that the boundary is a manifold: all tets at a pinched vertex become those of one copy of it.
CutMesh cut_along_manifold(const TorusMesh& torus, const Vec3& first) {
  std::vector<Periods> periods = periods_by_centroid(torus, first);
  for (int round = 0;; ++round) {
    CutMesh cut = cut_open(torus, periods);
    const std::vector<int> pinched = pinched_vertices(cut.mesh.mesh);
    if (pinched.empty() || round == kCutRounds) return cut;
    std::vector<int> corner_of(torus.V.size(), -1);
    for (const int v : pinched) corner_of[static_cast<std::size_t>(cut.corner[static_cast<std::size_t>(v)].vertex)] = v;
    for (std::size_t t = 0; t < torus.C.size(); ++t)
      for (const Corner& c : torus.C[t]) {
        const int v = corner_of[static_cast<std::size_t>(c.vertex)];
        if (v < 0) continue;
        for (int a = 0; a < 3; ++a) periods[t][a] = cut.corner[static_cast<std::size_t>(v)].copy[a] - c.copy[a];
        break;
      }
  }
}

/// Takes what has changed off the cut back to the torus.
void close(const CutMesh& cut, TorusMesh& torus) {
  const RegionMesh& made = cut.mesh;
  const auto corner_of = [&](int v) { return cut.corner[static_cast<std::size_t>(made.background_vertex[v])]; };
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v) {
    if (cut.is_on_cut[static_cast<std::size_t>(made.background_vertex[v])] != 0) continue;
    const Corner c = corner_of(static_cast<int>(v));
    torus.V[c.vertex] = made.mesh.V[v] - Vec3(c.copy[0], c.copy[1], c.copy[2]).cwiseProduct(torus.sides);
  }
  torus.C.clear();
  std::vector<std::int64_t> background_tet;
  for (std::size_t t = 0; t < made.mesh.C.size(); ++t) {
    std::array<Corner, 4> corners{};
    for (int k = 0; k < 4; ++k) corners[k] = corner_of(made.mesh.C[t][k]);
    torus.C.push_back(corners);
    const std::int64_t before = made.background_tet[t];
    background_tet.push_back(before < 0 ? -1 : torus.background_tet[static_cast<std::size_t>(before)]);
  }
  torus.background_tet = std::move(background_tet);
  torus.region = made.region;
}

/// The copies of vertices on the cut, placed to the bit, by the first vertex of each.
std::vector<PeriodicPair> pair_copies(const std::vector<Corner>& corner, const Vec3& sides, std::vector<Vec3>& V) {
  std::map<int, int> first;  // vertex of the torus to vertex of the mesh
  std::vector<PeriodicPair> pairs;
  for (std::size_t v = 0; v < corner.size(); ++v) {
    const auto [at, is_new] = first.try_emplace(corner[v].vertex, static_cast<int>(v));
    if (is_new) continue;
    PeriodicPair pair{at->second, static_cast<int>(v), {}};
    Vec3 shift;
    for (int a = 0; a < 3; ++a) {
      pair.periods[a] = corner[v].copy[a] - corner[static_cast<std::size_t>(at->second)].copy[a];
      shift[a] = pair.periods[a] * sides[a];
    }
    V[v] = V[static_cast<std::size_t>(pair.vertex)] + shift;
    pairs.push_back(pair);
  }
  std::sort(pairs.begin(), pairs.end(), [](const PeriodicPair& a, const PeriodicPair& b) {
    return std::pair(a.vertex, a.copy) < std::pair(b.vertex, b.copy);
  });
  return pairs;
}

}  // namespace

PeriodicMesh make_periodic_region_mesh(const RegionDomain& domain, const Box& box, double h,
                                       const RegionMeshParams& params, const Context& context) {
  if (params.layers < 1) throw std::invalid_argument("layers must be >= 1");
  check_periods(domain, box);
  const TorusLattice lattice = lattice_of(box, h);
  const PeriodicCells cells(lattice.background, lattice.n);
  const RegionDomain in_lattice = domain.in_coordinates(lattice.origin, lattice.scale);

  PeriodicMesh made;
  made.sides = box.sizes();
  context.report("search", 0);
  const auto costs = background_costs(lattice.background);
  RegionLabels labels = choose_labels(in_lattice, lattice.background, *costs->links, params.labels, context, &cells);
  if (labels.n_interface == 0) {
    made.mesh.status = UmStatus::EmptyDomain;
    made.mesh.evidence.what = "no surface passes through the box";
    return made;
  }
  TorusMesh torus = torus_of(lattice, cells, labels.of_vertex);
  labels.of_vertex = {};
  const Vec3 first_cut = Vec3::Constant(-kOffLattice * lattice.sides[0] / static_cast<double>(lattice.n[0]));
  const auto on_each_cut = [&](const auto& step) {
    for (int k = 0; k < kCuts; ++k) {
      CutMesh cut = cut_open(torus, periods_by_centroid(torus, first_cut + k * torus.sides / kCuts));
      step(cut);
      close(cut, torus);
    }
  };
  context.report("project", kProject);
  on_each_cut([&](CutMesh& cut) { detail::move_onto_strata(in_lattice, cut.is_on_cut, params, cut.mesh, context); });
  context.report("repair", kRepair);
  LocalFlipReport flips;
  on_each_cut([&](CutMesh& cut) {
    detail::flip_regions(in_lattice, cut.is_on_cut, params.flips, cut.mesh, context);
    flips = cut.mesh.flips;
  });

  context.report("finish", kFinish);
  CutMesh cut = cut_along_manifold(torus, first_cut);
  for (int k = 1; k < kCuts && !pinched_vertices(cut.mesh.mesh).empty(); ++k)
    cut = cut_along_manifold(torus, first_cut + k * torus.sides / kCuts);
  made.mesh = std::move(cut.mesh);
  RegionMesh& mesh = made.mesh;
  mesh.flips = flips;
  mesh.labels = std::move(labels);
  for (Vec3& x : mesh.mesh.V) x = lattice.origin + lattice.scale.cwiseProduct(x);
  for (std::size_t v = 0; v < cut.corner.size(); ++v)
    mesh.background_vertex[v] = torus.background_vertex[static_cast<std::size_t>(cut.corner[v].vertex)];
  for (std::int64_t& t : mesh.background_tet) t = torus.background_tet[static_cast<std::size_t>(t)];
  const std::vector<int> new_vertex = detail::finish(
      domain, params,
      [&](std::int64_t v) -> Vec3 {
        return lattice.origin + lattice.scale.cwiseProduct(lattice.background.position(v));
      },
      mesh);
  std::vector<Corner> corner(mesh.mesh.V.size());
  for (std::size_t v = 0; v < new_vertex.size(); ++v)
    if (new_vertex[v] >= 0) corner[static_cast<std::size_t>(new_vertex[v])] = cut.corner[v];
  made.pairs = pair_copies(corner, made.sides, mesh.mesh.V);
  return made;
}

PeriodicMatch match_sides(const PeriodicMesh& mesh) {
  PeriodicMatch match;
  match.n_pairs = mesh.pairs.size();
  const TetMesh& tets = mesh.mesh.mesh;
  // The vertex and the periods that each vertex is a copy of.
  std::vector<std::pair<int, Periods>> origin(tets.V.size());
  for (std::size_t v = 0; v < origin.size(); ++v) origin[v] = {static_cast<int>(v), {}};
  for (const PeriodicPair& pair : mesh.pairs) {
    origin[static_cast<std::size_t>(pair.copy)] = {pair.vertex, pair.periods};
    Vec3 shift;
    for (int a = 0; a < 3; ++a) shift[a] = pair.periods[a] * mesh.sides[a];
    const Vec3 off =
        tets.V[static_cast<std::size_t>(pair.copy)] - (tets.V[static_cast<std::size_t>(pair.vertex)] + shift);
    match.farthest = std::max(match.farthest, off.norm());
  }
  // A face up to whole periods: its vertices ascending, with their periods relative to the first.
  using Key = std::array<int, 12>;
  const auto key_of = [&](const Triangle& face, int& sign) {
    std::array<std::pair<int, Periods>, 3> c{};
    for (int k = 0; k < 3; ++k) c[k] = origin[static_cast<std::size_t>(face[k])];
    sign = 1;
    for (const auto& [i, j] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)})
      if (c[j] < c[i]) std::swap(c[i], c[j]), sign = -sign;
    Key key{};
    for (int k = 0; k < 3; ++k) {
      key[4 * k] = c[k].first;
      for (int a = 0; a < 3; ++a) key[4 * k + 1 + a] = c[k].second[a] - c[0].second[a];
    }
    return key;
  };
  struct AtPlace {
    int n_positive = 0, n_negative = 0;
    std::vector<Triangle> faces;
  };
  std::map<Key, AtPlace> at_place;  // boundary faces by their place on the torus
  for (Triangle f : boundary_faces(tets.C, tets.V.size()).triangles) {
    int sign = 0;
    AtPlace& at = at_place[key_of(f, sign)];
    ++(sign > 0 ? at.n_positive : at.n_negative);
    std::sort(f.begin(), f.end());
    at.faces.push_back(f);
  }
  for (const auto& [key, at] : at_place) {
    if (at.n_positive == 1 && at.n_negative == 1) {
      match.sides.insert(match.sides.end(), at.faces.begin(), at.faces.end());
    } else {
      match.n_unmatched += at.faces.size();
    }
  }
  std::sort(match.sides.begin(), match.sides.end());
  return match;
}

}  // namespace umtet
