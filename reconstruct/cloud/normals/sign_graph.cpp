#include "reconstruct/cloud/normals/sign_graph.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <queue>
#include <unordered_map>

#include "common/shared_disjoint_sets.h"
#include "reconstruct/cloud/normals/detail/sign_turning.h"

namespace umtet {
namespace {

// Enough points that the sum over a border outweighs a few misled pairs, few enough that a patch stays on one side of
// a fin.
constexpr std::uint32_t kPatchPoints = 64;
// Sizes of the patches that step 3 builds its regions of, coarse to fine. A patch of 64 can hold both a right and a
// wrong part of a thin fin, which only smaller ones tell apart.
constexpr std::array<std::uint32_t, 4> kSmallPatches = {32, 16, 8, 4};
// Pairs with |weight| below kSurePair do not grow patches. Those below kSureBorder do not join bodies: across a narrow
// gap there are many pairs of small weight, which would join two bodies; a bound that is too high takes thin fins
// apart.
constexpr double kSurePair = 0.5, kSurePairs = 2, kAnyPair = 1e-3, kAllPairs = 2, kSureBorder = 0.2;

/// Union-find with the sign of every member relative to its root.
class ParityForest {
 public:
  explicit ParityForest(std::size_t n) : parent_(n), size_(n, 1), sign_(n, 1) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  struct Place {
    std::uint32_t root;
    int sign;
  };
  Place find(std::uint32_t i) {
    int sign = 1;
    std::uint32_t root = i;
    for (; parent_[root] != root; root = parent_[root]) sign *= sign_[root];
    for (int rest = sign; parent_[i] != root && i != root;) {  // compress
      const std::uint32_t next = parent_[i];
      const std::int8_t own = sign_[i];
      parent_[i] = root;
      sign_[i] = static_cast<std::int8_t>(rest);
      rest *= own;
      i = next;
    }
    return {root, sign};
  }
  std::uint32_t size(std::uint32_t root) const { return size_[root]; }
  /// `child` and `root` are roots; sign: of child relative to root.
  void hang(std::uint32_t child, std::uint32_t root, int sign) {
    parent_[child] = root;
    sign_[child] = static_cast<std::int8_t>(sign);
    size_[root] += size_[child];
  }

 private:
  std::vector<std::uint32_t> parent_, size_;
  std::vector<std::int8_t> sign_;
};

/// The pairs that may grow patches, surest first.
std::vector<std::uint32_t> surest_first(const std::vector<SignEdge>& edges) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t e = 0; e < edges.size(); ++e)
    if (std::abs(edges[e].weight) >= kSurePair) order.push_back(e);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t e, std::uint32_t f) {
    const float we = std::abs(edges[e].weight), wf = std::abs(edges[f].weight);
    return we > wf || (we == wf && e < f);
  });
  return order;
}

/// Step 1. Returns the patch of every point, numbered by first points; sign[i] becomes relative within its patch.
std::vector<std::uint32_t> grow_patches(std::size_t n, const std::vector<SignEdge>& edges,
                                        const std::vector<std::uint32_t>& order, std::uint32_t most,
                                        std::vector<std::int8_t>& sign, std::uint32_t& n_patches) {
  ParityForest forest(n);
  for (const std::uint32_t e : order) {
    auto a = forest.find(edges[e].a), b = forest.find(edges[e].b);
    if (a.root == b.root || forest.size(a.root) + forest.size(b.root) > most) continue;
    if (forest.size(a.root) < forest.size(b.root)) std::swap(a, b);
    forest.hang(b.root, a.root, a.sign * b.sign * (edges[e].weight > 0 ? 1 : -1));
  }
  constexpr std::uint32_t kNone = 0xffffffffU;
  std::vector<std::uint32_t> number(n, kNone), patch(n);
  n_patches = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto place = forest.find(i);
    if (number[place.root] == kNone) number[place.root] = n_patches++;
    patch[i] = number[place.root];
    sign[i] = static_cast<std::int8_t>(place.sign);
  }
  return patch;
}

/// Step 2: patches, and the sums over the borders of those that are not joined yet.
class PatchGraph {
 public:
  explicit PatchGraph(std::uint32_t n_patches) : forest_(n_patches), borders_(n_patches), turned_(n_patches, 0) {}

  /// Adds the pairs of least <= |weight| < below to the borders. sign: of points within their patches.
  void add(const std::vector<SignEdge>& edges, double least, double below, const std::vector<std::uint32_t>& patch,
           const std::vector<std::int8_t>& sign) {
    for (const SignEdge& e : edges) {
      const double strength = std::abs(e.weight);
      if (strength < least || strength >= below || patch[e.a] == patch[e.b]) continue;
      const auto a = find(patch[e.a]), b = find(patch[e.b]);
      if (a.root == b.root) continue;
      const double weight = a.sign * b.sign * sign[e.a] * sign[e.b] * static_cast<double>(e.weight);
      borders_[a.root][b.root] += weight;
      borders_[b.root][a.root] += weight;
    }
  }
  ParityForest::Place find(std::uint32_t patch) {
    const ParityForest::Place place = forest_.find(patch);
    return {place.root, turned_[place.root] != 0 ? -place.sign : place.sign};
  }

  /// Joins while there is a border of |sum| >= least between patches of which not both are settled.
  void join(double least, std::vector<std::uint8_t>& settled) {
    std::priority_queue<Border> queue;
    for (std::uint32_t a = 0; a < borders_.size(); ++a)
      for (const auto& [b, weight] : borders_[a])
        if (a < b) queue.push({std::abs(weight), a, b});
    while (!queue.empty() && queue.top().sum >= least) {
      const Border top = queue.top();
      queue.pop();
      std::uint32_t a = top.a, b = top.b;
      const auto border = borders_[a].find(b);
      if (border == borders_[a].end() || std::abs(border->second) != top.sum || (settled[a] && settled[b])) continue;
      const int relative = border->second > 0 ? 1 : -1;
      // The one with fewer borders moves; a settled one must keep its sign, so it is the root.
      if (settled[b] || (!settled[a] && borders_[a].size() < borders_[b].size())) std::swap(a, b);
      // The forest knows the signs before roots were turned.
      forest_.hang(b, a, turned_[a] != turned_[b] ? -relative : relative);
      borders_[a].erase(b);
      borders_[b].erase(a);
      for (const auto& [c, weight] : borders_[b]) {
        borders_[c].erase(b);
        double& sum = borders_[a][c];
        sum += relative * weight;
        borders_[c][a] = sum;
        queue.push({std::abs(sum), std::min(a, c), std::max(a, c)});
      }
      borders_[b].clear();
    }
  }
  /// Turns a root and all that hangs on it over.
  void turn(std::uint32_t root) {
    turned_[root] ^= 1;
    for (auto& [c, weight] : borders_[root]) borders_[c][root] = weight = -weight;
  }

 private:
  struct Border {
    double sum;
    std::uint32_t a, b;  // a < b
    bool operator<(const Border& o) const {
      return sum < o.sum || (sum == o.sum && (a > o.a || (a == o.a && b > o.b)));
    }
  };
  ParityForest forest_;
  std::vector<std::unordered_map<std::uint32_t, double>> borders_;  // between roots as they are turned
  std::vector<std::uint8_t> turned_;
};

/// The same bits for (b, a).
float pair_weight(const OrientedPointCloud& cloud, std::uint32_t a, std::uint32_t b) {
  if (a > b) std::swap(a, b);
  return static_cast<float>(umtet::pair_weight(cloud.points[a], cloud.normals[a], cloud.points[b], cloud.normals[b]));
}

/// A pair that both have is the one's with the smaller number.
bool owns(const Neighbourhoods& near, std::uint32_t i, std::uint32_t j) { return i < j || !near.has(j, i); }

}  // namespace

double pair_weight(const Vec3& x_a, const Vec3& n_a, const Vec3& x_b, const Vec3& n_b) {
  const Vec3 d = x_b - x_a;
  const double d2 = d.squaredNorm(), cosine = n_a.dot(n_b);
  if (!(d2 > 0)) return cosine;
  const double da = n_a.dot(d), db = n_b.dot(d), c2 = std::min(1.0, std::max(da * da, db * db) / d2);
  return (cosine - 2 * da * db / d2) * (1 - c2) * (1 - c2);
}

std::vector<SignEdge> sign_graph(const OrientedPointCloud& cloud, const Neighbourhoods& near) {
  const std::size_t n = near.size();
  std::vector<std::size_t> first(n + 1, 0);
  for (std::uint32_t i = 0; i < n; ++i)
    for (const std::uint32_t j : near.points(i))
      if (owns(near, i, j)) ++first[std::min(i, j) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<SignEdge> edges(first[n]);
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::size_t m = 0; m < near.k(); ++m) {
      const std::uint32_t j = near.points(i)[m];
      if (owns(near, i, j)) edges[next[std::min(i, j)]++] = {std::min(i, j), std::max(i, j), 0};
    }
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t a) {
    const auto begin = edges.begin() + static_cast<std::ptrdiff_t>(first[a]),
               end = edges.begin() + static_cast<std::ptrdiff_t>(first[a + 1]);
    std::sort(begin, end, [](const SignEdge& e, const SignEdge& f) { return e.b < f.b; });
    for (auto e = begin; e != end; ++e) e->weight = pair_weight(cloud, e->a, e->b);
  });
  return edges;
}

SignAgreement sign_agreement(const OrientedPointCloud& cloud, const Neighbourhoods& near) {
  constexpr std::size_t kChunk = 4096;
  constexpr double kContested = 0.25;  // share of a point's weight against its sign from which it counts as contested
  const std::size_t n = near.size();
  std::vector<SignAgreement> sums((n + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t c) {
    SignAgreement& sum = sums[c];
    const std::size_t end = std::min(n, (c + 1) * kChunk);
    for (auto i = static_cast<std::uint32_t>(c * kChunk); i < end; ++i) {
      double against = 0, all = 0;
      for (const std::uint32_t j : near.points(i)) {
        const double weight = pair_weight(cloud, i, j);
        all += std::abs(weight);
        if (weight < 0) against -= weight;
        if (!owns(near, i, j)) continue;
        sum.all += std::abs(weight);
        if (weight > 0) sum.agrees += weight;
      }
      if (!(against <= kContested * all && all > 0)) ++sum.n_contested;
    }
  });
  SignAgreement total;
  for (const SignAgreement& sum : sums) {
    total.agrees += sum.agrees;
    total.all += sum.all;
    total.n_contested += sum.n_contested;
  }
  return total;
}

std::vector<std::uint32_t> agreeing_components(const OrientedPointCloud& cloud, const Neighbourhoods& near,
                                               std::uint32_t& n_components) {
  const std::size_t n = near.size();
  SharedDisjointSets sets(n);
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(n), [&](std::uint32_t i) {
    for (const std::uint32_t j : near.points(i))
      if (sets.find(i) != sets.find(j) && pair_weight(cloud, i, j) >= kSureBorder) sets.unite(i, j);
  });
  std::vector<std::uint32_t> component(n);
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(n),
                    [&](std::uint32_t i) { component[i] = sets.find(i); });
  n_components = 0;
  for (std::uint32_t i = 0; i < n; ++i) component[i] = component[i] == i ? n_components++ : component[component[i]];
  return component;
}

Signs solve_signs(std::size_t n_points, const std::vector<SignEdge>& edges, const Settle& settle) {
  Signs signs;
  signs.sign.resize(n_points);
  std::uint32_t n_patches = 0;
  const std::vector<std::uint32_t> order = surest_first(edges);
  const std::vector<std::uint32_t> patch = grow_patches(n_points, edges, order, kPatchPoints, signs.sign, n_patches);
  const std::vector<std::int8_t> within_patch = signs.sign;
  PatchGraph graph(n_patches);
  graph.add(edges, kSureBorder, kAllPairs, patch, within_patch);

  const auto read_off = [&] {
    constexpr std::uint32_t kNone = 0xffffffffU;
    std::vector<std::uint32_t> number(n_patches, kNone);
    signs.component.resize(n_points);
    signs.n_components = 0;
    std::vector<std::uint32_t> roots;
    for (std::uint32_t i = 0; i < n_points; ++i) {
      const auto place = graph.find(patch[i]);
      if (number[place.root] == kNone) {
        number[place.root] = signs.n_components++;
        roots.push_back(place.root);
      }
      signs.component[i] = number[place.root];
      signs.sign[i] = static_cast<std::int8_t>(within_patch[i] * place.sign);
    }
    return roots;
  };

  std::vector<std::uint8_t> settled(n_patches, 0);
  graph.join(kSurePairs, settled);
  const std::vector<std::uint32_t> roots = read_off();
  const std::vector<std::int8_t> verdict = settle(signs);
  for (std::uint32_t c = 0; c < signs.n_components; ++c) {
    settled[roots[c]] = verdict[c] != 0 ? 1 : 0;
    if (verdict[c] < 0) graph.turn(roots[c]);
  }
  graph.add(edges, 0, kSureBorder, patch, within_patch);
  graph.join(kAnyPair, settled);
  read_off();

  const SignAdjacency adjacency(n_points, edges);
  turn_groups(adjacency, patch, n_patches, signs.sign);
  if (has_disagreement(edges, signs.sign)) {
    for (const std::uint32_t most : kSmallPatches) {
      std::vector<std::int8_t> relative(n_points);  // of no interest here
      std::uint32_t n_small = 0;
      const std::vector<std::uint32_t> small = grow_patches(n_points, edges, order, most, relative, n_small);
      turn_regions(edges, small, n_small, signs.sign);
    }
  }
  std::vector<std::uint32_t> single(n_points);
  std::iota(single.begin(), single.end(), 0U);
  turn_groups(adjacency, single, static_cast<std::uint32_t>(n_points), signs.sign);
  return signs;
}

}  // namespace umtet
