#include "reconstruct/cloud/normals/detail/sign_turning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace umtet {
namespace {

// Every turn raises the sum of weight s_a s_b, so this ends by itself after a few sweeps; a bound for all the same.
constexpr int kMostSweeps = 50;
constexpr std::size_t kMostTogether = 64;  // patches in a region
constexpr double kRounding = 1e-6;         // a sum nearer to 0 than this is rounding, and would turn a group to and fro
// A border whose sum is above -kSeed starts no region: half a pair in full disagreement. In noise there are many such
// borders, which cost time and turn next to nothing.
constexpr double kSeed = 0.5;

/// A patch and the sum over the pairs to it: < 0, the two disagree.
using Border = std::pair<std::uint32_t, double>;

/// Borders of every patch as the signs are now, by number.
std::vector<std::vector<Border>> patch_borders(const std::vector<SignEdge>& edges,
                                               const std::vector<std::uint32_t>& patch, std::uint32_t n_patches,
                                               const std::vector<std::int8_t>& sign) {
  std::vector<std::vector<Border>> borders(n_patches);
  for (const SignEdge& e : edges) {
    const std::uint32_t p = patch[e.a], q = patch[e.b];
    if (p == q) continue;
    const double weight = sign[e.a] * sign[e.b] * static_cast<double>(e.weight);
    borders[p].emplace_back(q, weight);
    borders[q].emplace_back(p, weight);
  }
  for (std::vector<Border>& of_one : borders) {
    const auto before = [](const Border& a, const Border& b) { return a.first < b.first; };
    std::stable_sort(of_one.begin(), of_one.end(), before);  // sums in the order of pairs, the same from both sides
    std::size_t n = 0;
    for (const Border& border : of_one) {
      if (n > 0 && of_one[n - 1].first == border.first)
        of_one[n - 1].second += border.second;
      else
        of_one[n++] = border;
    }
    of_one.resize(n);
  }
  return borders;
}

double sum_of(const std::vector<Border>& borders) {
  double sum = 0;
  for (const Border& border : borders) sum += border.second;
  return sum;
}

/// The region around seed whose border has the least sum below zero, on the way of greedy growth; or none.
/// @param total  sum_of every patch
std::vector<std::uint32_t> region_in_disagreement(const std::vector<std::vector<Border>>& borders,
                                                  const std::vector<double>& total, std::uint32_t seed) {
  std::vector<std::uint32_t> region;
  std::map<std::uint32_t, double> along = {{seed, 0}};  // patches beside the region: the sums to it
  double sum = 0, least = -kRounding;
  std::size_t n_best = 0;
  while (region.size() < kMostTogether && !along.empty()) {
    std::uint32_t next = 0;
    double change = std::numeric_limits<double>::infinity();
    for (const auto& [q, to_region] : along) {
      if (total[q] - 2 * to_region < change) {
        change = total[q] - 2 * to_region;
        next = q;
      }
    }
    along.erase(next);
    region.push_back(next);
    sum += change;
    for (const auto& [r, weight] : borders[next])
      if (std::find(region.begin(), region.end(), r) == region.end()) along[r] += weight;
    if (sum < least) {
      least = sum;
      n_best = region.size();
    }
  }
  region.resize(n_best);
  return region;
}

}  // namespace

SignAdjacency::SignAdjacency(std::size_t n, const std::vector<SignEdge>& edges)
    : first(n + 1, 0), entries(2 * edges.size()) {
  for (const SignEdge& e : edges) {
    ++first[e.a + 1];
    ++first[e.b + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (const SignEdge& e : edges) {
    entries[next[e.a]++] = {e.b, e.weight};
    entries[next[e.b]++] = {e.a, e.weight};
  }
}

bool has_disagreement(const std::vector<SignEdge>& edges, const std::vector<std::int8_t>& sign) {
  return std::any_of(edges.begin(), edges.end(), [&](const SignEdge& e) {
    return sign[e.a] * sign[e.b] * static_cast<double>(e.weight) < -kRounding;
  });
}

void turn_groups(const SignAdjacency& adjacency, const std::vector<std::uint32_t>& group, std::uint32_t n_groups,
                 std::vector<std::int8_t>& sign) {
  std::vector<std::uint32_t> first(n_groups + 1, 0), members(group.size());
  for (const std::uint32_t g : group) ++first[g + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::uint32_t i = 0; i < group.size(); ++i) members[next[group[i]]++] = i;

  bool turned = true;
  for (int sweep = 0; sweep < kMostSweeps && turned; ++sweep) {
    turned = false;
    for (std::uint32_t g = 0; g < n_groups; ++g) {
      double sum = 0;
      for (std::uint32_t m = first[g]; m < first[g + 1]; ++m) {
        const std::uint32_t i = members[m];
        for (std::uint32_t e = adjacency.first[i]; e < adjacency.first[i + 1]; ++e) {
          const auto [j, weight] = adjacency.entries[e];
          if (group[j] != g) sum += sign[i] * sign[j] * static_cast<double>(weight);
        }
      }
      if (!(sum < -kRounding)) continue;
      for (std::uint32_t m = first[g]; m < first[g + 1]; ++m)
        sign[members[m]] = static_cast<std::int8_t>(-sign[members[m]]);
      turned = true;
    }
  }
}

void turn_regions(const std::vector<SignEdge>& edges, const std::vector<std::uint32_t>& patch, std::uint32_t n_patches,
                  std::vector<std::int8_t>& sign) {
  std::vector<std::vector<Border>> borders = patch_borders(edges, patch, n_patches, sign);
  std::vector<double> total;
  total.reserve(borders.size());
  for (const std::vector<Border>& of_one : borders) total.push_back(sum_of(of_one));
  std::vector<std::int8_t> turned(n_patches, 1);
  for (std::uint32_t seed = 0; seed < n_patches; ++seed) {
    const auto disagrees = [](const Border& border) { return border.second < -kSeed; };
    if (std::none_of(borders[seed].begin(), borders[seed].end(), disagrees)) continue;
    for (const std::uint32_t p : region_in_disagreement(borders, total, seed)) {
      turned[p] = static_cast<std::int8_t>(-turned[p]);
      for (auto& [q, weight] : borders[p]) {
        weight = -weight;
        for (auto& [r, same] : borders[q])
          if (r == p) same = -same;
        total[q] = sum_of(borders[q]);
      }
      total[p] = sum_of(borders[p]);
    }
  }
  for (std::size_t i = 0; i < sign.size(); ++i) sign[i] = static_cast<std::int8_t>(sign[i] * turned[patch[i]]);
}

}  // namespace umtet
