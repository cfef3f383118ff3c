#pragma once

#include "mesh/core/far_from_zero.h"

namespace umtet {

/// Treatment of a domain that reaches the background boundary.
enum class BackgroundBoundary {
  Refuse,  ///< fails with UmStatus::DomainLeavesBackground
  /// The background boundary is a wall: it bounds the mesh where Omega reaches it, and its vertices do not move.
  /// Classification and repair are restricted to a domain off the background boundary, so vertices are inside or
  /// outside by the sign of psi, except for those flipped to make the boundary a manifold (manifold_boundary.h).
  Wall,
};
/// Search for the inside vertices.
enum class SubmeshSearch { FullLoop, Crawl };  ///< Alg. 1, steps 1-22, or Section 3.8(c) from given seeds

/// Search for the background tets of omega_h.
struct SubmeshParams {
  SubmeshSearch search = SubmeshSearch::FullLoop;
  BackgroundBoundary background_boundary = BackgroundBoundary::Refuse;
  KnownSigns known = {};  ///< signs of psi known in advance, for FullLoop: they only save evaluations
};

}  // namespace umtet
