#pragma once

#include "mesh/core/far_from_zero.h"

namespace umtet {

/// What becomes of a domain that reaches the background boundary.
enum class BackgroundBoundary {
  Refuse,  ///< UmStatus::DomainLeavesBackground
  /// The background boundary is a wall: it bounds the mesh where Omega reaches it, and stays where it is. The inside
  /// and outside vertices, which are chosen and repaired off the background boundary only, stay those of psi but for
  /// those that part double positive faces (double_faces.h).
  Wall,
};
enum class SubmeshSearch { FullLoop, Crawl };  ///< Alg. 1, steps 1-22, or Section 3.8(c) from given seeds

/// Which background tets omega_h is looked for in.
struct SubmeshParams {
  SubmeshSearch search = SubmeshSearch::FullLoop;
  BackgroundBoundary background_boundary = BackgroundBoundary::Refuse;
  KnownSigns known = {};  ///< of psi: of SubmeshSearch::FullLoop, spares values and changes nothing
};

}  // namespace umtet
