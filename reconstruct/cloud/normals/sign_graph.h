#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// A pair of neighbouring samples, with its evidence about their normals. weight > 0: they agree; < 0: one is turned
/// over; near 0: undecided. |weight| <= 1.
struct SignEdge {
  std::uint32_t a, b;  ///< a < b
  float weight;
};

/// Weight of a pair. On the circle through both points with normal n_a, the normal at b is n_a - 2 (n_a.e) e, e = (x_b
/// - x_a) / |x_b - x_a|. The weight is the cosine between this normal and n_b, times (1 - c^2)^2 with c = max |n.e|,
/// because a pair in the direction of its normals may be noise, or the two sides of a sheet.
double pair_weight(const Vec3& x_a, const Vec3& n_a, const Vec3& x_b, const Vec3& n_b);

/// The graph of pairs of nearest neighbours, each once, ordered by (a, b).
std::vector<SignEdge> sign_graph(const OrientedPointCloud& cloud, const Neighbourhoods& near);

/// Agreement of the pairs with the present signs, computed without building the graph.
struct SignAgreement {
  double agrees = 0, all = 0;  ///< sums of |weight|
  /// Points whose disagreeing pairs have more than a quarter of the weight of all their pairs, or whose pairs are
  /// undecided.
  std::size_t n_contested = 0;
  double share() const { return all > 0 ? agrees / all : 1; }
};

/// Measures the agreement. At the border of a region of reversed normals, half of the pairs of each point cross the
/// border; for a single reversed point, all pairs do. So there is no such region if no point is contested. Sums have a
/// fixed order.
SignAgreement sign_agreement(const OrientedPointCloud& cloud, const Neighbourhoods& near);

/// Components joined by agreeing pairs, subject to kSureBorder; numbered by first points.
std::vector<std::uint32_t> agreeing_components(const OrientedPointCloud& cloud, const Neighbourhoods& near,
                                               std::uint32_t& n_components);

/// Signs that satisfy the graph, with its components.
struct Signs {
  std::vector<std::int8_t> sign;         ///< +1 or -1, per point
  std::vector<std::uint32_t> component;  ///< per point, numbered by first points
  std::uint32_t n_components = 0;
};

/// Absolute orientation of each component: +1 its signs are right, -1 they are to be turned, 0 unknown.
using Settle = std::function<std::vector<std::int8_t>(const Signs&)>;

/// Maximises sum weight s_a s_b. The solution is approximate (the problem is NP-hard), but no single pair decides over
/// many points:
///
/// 1. patches of at most kPatchPoints points grow over the most certain pairs (union-find with parity);
/// 2. the two patches with the greatest |sum of weights| between them are joined, repeatedly;
/// 3. the signs of patches, then of regions of up to 64 smaller patches, then of points are reversed if the sum over
///    their pairs to all other points disagrees with them.
///
/// Step 2 first uses certain pairs. The resulting components are given to `settle`. It then continues down to the
/// weakest pairs, except between two settled components, so that touching bodies stay separate.
Signs solve_signs(std::size_t n_points, const std::vector<SignEdge>& edges, const Settle& settle);

}  // namespace umtet
