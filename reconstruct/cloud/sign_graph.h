#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "reconstruct/cloud/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// A pair of neighbouring samples and what it says about their normals: weight > 0, they agree; < 0, one is turned
/// over; near 0, nothing. |weight| <= 1.
struct SignEdge {
  std::uint32_t a, b;  ///< a < b
  float weight;
};

/// On the circle through both points with n_a as normal, the normal at b is n_a - 2 (n_a.e) e, e = (x_b - x_a) / |x_b -
/// x_a|: its cosine with n_b is the weight, times (1 - c^2)^2 with c = max |n.e|, because a pair that runs along its
/// normals may as well be the two sides of a sheet, or noise.
double pair_weight(const Vec3& x_a, const Vec3& n_a, const Vec3& x_b, const Vec3& n_b);

/// The pairs of nearest neighbours, each once, by (a, b).
std::vector<SignEdge> sign_graph(const OrientedPointCloud& cloud, const Neighbourhoods& near);

/// What the pairs say about the signs as they are, without the graph being made.
struct SignAgreement {
  double agrees = 0, all = 0;   ///< sums of |weight|
  std::size_t n_contested = 0;  ///< points whose pairs are against them by more than a quarter, or say nothing
  double share() const { return all > 0 ? agrees / all : 1; }
};

/// The border of a region that is turned over has half of its points' pairs across it, and so has a single point all:
/// without contested points there is none. Sums in a fixed order.
SignAgreement sign_agreement(const OrientedPointCloud& cloud, const Neighbourhoods& near);

/// Components that pairs in agreement join, where kSureBorder says that they may; numbered by first points.
std::vector<std::uint32_t> agreeing_components(const OrientedPointCloud& cloud, const Neighbourhoods& near,
                                               std::uint32_t& n_components);

/// Signs that satisfy the graph, and its components.
struct Signs {
  std::vector<std::int8_t> sign;         ///< +1 or -1, per point
  std::vector<std::uint32_t> component;  ///< of every point, numbered by their first points
  std::uint32_t n_components = 0;
};

/// What is known of each component without the rest: +1 its signs are right, -1 they are to be turned, 0 nothing.
using Settle = std::function<std::vector<std::int8_t>(const Signs&)>;

/// Maximises sum weight s_a s_b, not exactly (that is NP-hard) but so that no single pair decides over many points:
///
/// 1. patches of at most kPatchPoints points grow over the surest pairs (union-find with parity);
/// 2. the two patches with the greatest |sum of weights| between them are joined, and so on;
/// 3. patches, regions of up to 64 smaller ones, then points, whose pairs to the rest disagree in sum are turned over.
///
/// Step 2 goes over sure pairs first. The components that these make go through `settle`; then it goes on down to the
/// weakest pairs, except between two components that are settled: bodies that touch stay bodies.
Signs solve_signs(std::size_t n_points, const std::vector<SignEdge>& edges, const Settle& settle);

}  // namespace umtet
