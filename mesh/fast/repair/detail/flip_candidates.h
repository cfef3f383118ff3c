#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/background/vertex_links.h"
#include "mesh/classification/classification.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/repair/repair.h"

namespace umtet::detail {

/// The vertices that repair() may flip, by the rules of classify_vertices().
class FlipCandidates {
 public:
  struct Candidate {
    std::int64_t vertex;
    float cost;  ///< change of the star costs around the vertex by the flip
  };

  /// Keeps references to its arguments: `inside` is read at every call.
  FlipCandidates(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                 const ClassificationParams& classification, const RepairParams& params, const IdSet& inside)
      : background_(background),
        links_(links),
        psi_(psi),
        classification_(classification),
        params_(params),
        costs_(classification.costs ? *classification.costs : a15_star_costs()),
        inside_(inside) {}

  /// Candidates among a tet's vertices and their neighbours, the most promising first, at most max_tries.
  /// @param n_evaluations  receives the number of evaluations of psi
  std::vector<Candidate> operator()(const std::array<std::int64_t, 4>& tet, std::size_t& n_evaluations) const;

 private:
  bool in_reach(std::int64_t v, std::size_t& n_evaluations) const;

  const BackgroundMesh& background_;
  const VertexLinks& links_;
  ImplicitFunctionRef psi_;
  const ClassificationParams& classification_;
  const RepairParams& params_;
  const StarCostTable& costs_;
  const IdSet& inside_;
};

}  // namespace umtet::detail
