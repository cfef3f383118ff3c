#include "mesh/regions/periodic_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/classification/configuration_costs.h"
#include "mesh/regions/detail/periodic_cells.h"
#include "mesh/regions/detail/region_fit.h"
#include "mesh/regions/detail/region_parts.h"
#include "mesh/regions/detail/torus_mesh.h"

namespace umtet {
namespace {

using detail::Corner;
using detail::CutMesh;
using detail::PeriodicCells;
using detail::TorusMesh;

// Fewer cells, and a tet may meet itself around the torus.
constexpr int kFewestCells = 4;
// Three coordinates of a point are near at most three of so many cuts.
constexpr int kCuts = 4;
// The first cut is this far from the side of the box, in cells: no centroid of a background tet lies on it.
constexpr double kOffLattice = 1. / 37;
// Points at which functions are compared with those one period away, along each axis.
constexpr int kProbes = 7;
// Shares of the time at which steps begin.
constexpr double kProject = .3, kRepair = .6, kFinish = .9;

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
      const int row = i / kProbes, layer = row / kProbes;
      const Vec3 at = Vec3(i % kProbes, row % kProbes, layer) / kProbes;
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
      CutMesh cut = detail::cut_open(torus, first_cut + k * torus.sides / kCuts);
      step(cut);
      detail::close(cut, torus);
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
  bool is_manifold = false;
  CutMesh cut = detail::cut_along_manifold(torus, first_cut, is_manifold);
  for (int k = 1; k < kCuts && !is_manifold; ++k)
    cut = detail::cut_along_manifold(torus, first_cut + k * torus.sides / kCuts, is_manifold);
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

}  // namespace umtet
