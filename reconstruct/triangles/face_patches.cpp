#include "reconstruct/triangles/face_patches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "reconstruct/triangles/edge_uses.h"

namespace umtet {
namespace {

// Of the diagonal. Files in single precision round to 1e-7 of it, exporters of CAD programs tessellate faces apart to
// some 1e-5.
constexpr std::array<double, 5> kTolerances = {1e-6, 1e-5, 1e-4, 4e-4, 1e-3};
// Shorter edges would vanish.
constexpr double kLeastEdge = .25;
// Share of open edges of a mesh that is as good as whole.
constexpr double kFewOpen = .02;
// A larger tolerance has to leave fewer than this share of the open edges.
constexpr double kFewer = .8;
// Of the squared diagonal: less area is rounding.
constexpr double kNoArea = 1e-15;

std::size_t count_open(const std::vector<EdgeUse>& uses) {
  std::size_t n = 0;
  for_each_edge(uses, [&](std::size_t first, std::size_t last) { n += last - first == 1 ? 1 : 0; });
  return n;
}

/// Union-find where every member knows whether it looks to the other side than its root.
class SidedSets {
 public:
  explicit SidedSets(std::size_t n) : parent_(n), differs_(n, 0) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::pair<std::uint32_t, bool> find(std::uint32_t i) {
    std::uint32_t root = i;
    bool differs = false;
    while (parent_[root] != root) {
      differs ^= differs_[root] != 0;
      root = parent_[root];
    }
    for (bool left = differs; parent_[i] != root && i != root;) {
      const std::uint32_t next = parent_[i];
      const bool step = differs_[i] != 0;
      parent_[i] = root;
      differs_[i] = left ? 1 : 0;
      left ^= step;
      i = next;
    }
    return {root, differs};
  }
  /// False if they were one already, and their sides say otherwise.
  bool unite(std::uint32_t i, std::uint32_t j, bool differ) {
    const auto [a, from_a] = find(i);
    const auto [b, from_b] = find(j);
    const bool d = from_a ^ from_b ^ differ;
    if (a == b) return !d;
    parent_[std::max(a, b)] = std::min(a, b);
    differs_[std::max(a, b)] = d ? 1 : 0;
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> differs_;
};

double median_edge(const TriangleMesh& mesh) {
  std::vector<double> lengths;
  lengths.reserve(3 * mesh.F.size());
  for (std::size_t f = 0; f < mesh.F.size(); ++f)
    for (int k = 0; k < 3; ++k) lengths.push_back((mesh.corner(f, k) - mesh.corner(f, (k + 1) % 3)).norm());
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

struct Welding {
  double distance = 0;
  std::vector<EdgeUse> uses;
};

Welding best_welding(const TriangleMesh& mesh) {
  Welding best{0, edge_uses(mesh, welded(mesh.V, 0))};
  std::size_t n_open = count_open(best.uses);
  if (static_cast<double>(n_open) <= kFewOpen * 3 * static_cast<double>(mesh.F.size())) return best;
  const double diagonal = diagonal_of(mesh), most = kLeastEdge * median_edge(mesh);
  for (const double tolerance : kTolerances) {
    const double distance = tolerance * diagonal;
    if (distance > most) break;
    std::vector<EdgeUse> uses = edge_uses(mesh, welded(mesh.V, distance));
    const std::size_t n = count_open(uses);
    // Triangles that vanish would take open edges with them.
    if (static_cast<double>(n) >= kFewer * static_cast<double>(n_open) || 2 * uses.size() < 3 * mesh.F.size()) continue;
    n_open = n;
    best = {distance, std::move(uses)};
  }
  return best;
}

}  // namespace

std::vector<int> welded(const std::vector<Vec3>& V, double tolerance) {
  std::vector<int> first(V.size());
  if (!(tolerance > 0)) {
    std::vector<int> order(V.size());
    std::iota(order.begin(), order.end(), 0);
    const auto place = [&](int i) { return std::make_tuple(V[i].x(), V[i].y(), V[i].z()); };
    std::sort(order.begin(), order.end(), [&](int i, int j) {
      return std::tuple_cat(place(i), std::make_tuple(i)) < std::tuple_cat(place(j), std::make_tuple(j));
    });
    for (std::size_t k = 0; k < order.size(); ++k) {
      const bool is_same = k > 0 && V[order[k]] == V[order[k - 1]];
      first[order[k]] = is_same ? first[order[k - 1]] : order[k];
    }
    return first;
  }
  // Those that stay are farther than the tolerance from each other, so a cell holds few.
  std::unordered_multimap<std::uint64_t, int> stayed;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  for (const Vec3& x : V) low = low.cwiseMin(x);
  const auto cell = [&](const Vec3& x) {
    return Eigen::Array<std::int64_t, 3, 1>(((x - low) / tolerance).array().floor().cast<std::int64_t>());
  };
  const auto key = [](const Eigen::Array<std::int64_t, 3, 1>& c) {
    return (static_cast<std::uint64_t>(c[0]) << 42) ^ (static_cast<std::uint64_t>(c[1]) << 21) ^
           static_cast<std::uint64_t>(c[2]);
  };
  for (int i = 0; i < static_cast<int>(V.size()); ++i) {
    const auto at = cell(V[i]);
    int nearest = -1;
    double least = tolerance * tolerance;
    for (int k = 0; k < 27; ++k) {
      const auto [begin, end] =
          stayed.equal_range(key(at + Eigen::Array<std::int64_t, 3, 1>(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      for (auto it = begin; it != end; ++it) {
        const double d2 = (V[it->second] - V[i]).squaredNorm();
        if (d2 > least || (d2 == least && nearest >= 0 && it->second > nearest)) continue;
        least = d2;
        nearest = it->second;
      }
    }
    first[i] = nearest < 0 ? i : nearest;
    if (nearest < 0) stayed.emplace(key(at), i);
  }
  return first;
}

FacePatches find_patches(const TriangleMesh& mesh) {
  FacePatches made;
  const std::size_t n = mesh.F.size();
  const Welding welding = best_welding(mesh);
  made.weld_distance = welding.distance;
  const std::vector<EdgeUse>& uses = welding.uses;
  SidedSets sets(n);
  std::vector<std::uint8_t> at_open_edge(n, 0);
  for_each_edge(uses, [&](std::size_t first, std::size_t last) {
    if ((last - first) % 2 == 1)
      for (std::size_t i = first; i < last; ++i) at_open_edge[uses[i].face] = 1;
    if (last - first == 1) ++made.n_open_edges;
    if (last - first > 2) ++made.n_branching_edges;
    if (last - first != 2) return;
    const EdgeUse &a = uses[first], &b = uses[first + 1];
    if (!sets.unite(a.face, b.face, a.forward == b.forward)) ++made.n_one_sided_edges;
  });

  std::vector<double> for_root(n, 0);  // area that looks to its side, less that which does not
  for (std::uint32_t f = 0; f < n; ++f) {
    const auto [root, differs] = sets.find(f);
    for_root[root] += (differs ? -1 : 1) * mesh.area_vector(f).norm();
  }
  std::vector<std::uint32_t> number(n, 0);
  made.patch.resize(n);
  made.is_turned.resize(n);
  for (std::uint32_t f = 0; f < n; ++f) {
    const auto [root, differs] = sets.find(f);
    if (root == f) {
      number[f] = static_cast<std::uint32_t>(made.is_closed.size());
      made.is_closed.push_back(1);
    }
    made.patch[f] = number[root];
    made.is_turned[f] = differs == (for_root[root] >= 0) ? 1 : 0;
    if (at_open_edge[f]) made.is_closed[made.patch[f]] = 0;
  }
  // Triangles that welding made edges of.
  std::vector<std::uint8_t> has_edges(n, 0);
  for (const EdgeUse& use : uses) has_edges[use.face] = 1;
  for (std::uint32_t f = 0; f < n; ++f)
    if (!has_edges[f]) made.is_closed[made.patch[f]] = 0;
  return made;
}

DroppedFaces drop_useless_faces(TriangleMesh& mesh) {
  DroppedFaces dropped;
  const double least = kNoArea * std::pow(diagonal_of(mesh), 2);
  const std::vector<int> corner = welded(mesh.V, 0);
  std::vector<std::pair<Triangle, std::uint32_t>> by_corners;
  for (std::uint32_t f = 0; f < mesh.F.size(); ++f) {
    Triangle v = {corner[mesh.F[f][0]], corner[mesh.F[f][1]], corner[mesh.F[f][2]]};
    std::sort(v.begin(), v.end());
    if (v[0] == v[1] || v[1] == v[2] || !(mesh.area_vector(f).norm() > least)) {
      ++dropped.n_degenerate;
      continue;
    }
    by_corners.emplace_back(v, f);
  }
  std::sort(by_corners.begin(), by_corners.end());
  std::vector<std::uint8_t> stays(mesh.F.size(), 0);
  for (std::size_t i = 0; i < by_corners.size(); ++i) {
    const bool is_again = i > 0 && by_corners[i].first == by_corners[i - 1].first;
    dropped.n_duplicates += is_again ? 1 : 0;
    stays[by_corners[i].second] = is_again ? 0 : 1;
  }
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    if (!stays[f]) continue;
    if (!mesh.labels.empty()) mesh.labels[kept] = mesh.labels[f];
    mesh.F[kept++] = mesh.F[f];
  }
  mesh.F.resize(kept);
  if (!mesh.labels.empty()) mesh.labels.resize(kept);
  return dropped;
}

void turn_face(TriangleMesh& mesh, std::size_t f) { std::swap(mesh.F[f][1], mesh.F[f][2]); }

double diagonal_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Triangle& f : mesh.F)
    for (const int v : f) box.extend(mesh.V[v]);
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

}  // namespace umtet
