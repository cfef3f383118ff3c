#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "body/body.h"
#include "mesh/core/piecewise_domain.h"
#include "mesh/features/feature_graph.h"

namespace umtet {

/// A body whose boundary is piecewise smooth: its patches, and the sharp curves where they meet.
struct PiecewiseBody {
  PiecewiseDomain domain;  ///< working coordinates
  /// The curves and corners, working coordinates, if they are known; empty: each mesh traces them.
  std::optional<FeatureGraph> graph = {};
  /// For triangles: TriangleDomain::curvature of the patches; empty for others.
  std::vector<double> curvature = {};
  /// Label of each patch whose triangles have one label of the input in common; 0: they have none or several. Empty: no
  /// labels.
  std::vector<int> labels = {};
  double tolerance = 0;  ///< distance within which the curves and corners lie on their patches, model units
};

/// Makes the body that of `domain`: psi is its psi, with the derivatives of the active patch.
void set_body(Domain& domain, std::shared_ptr<const PiecewiseBody> body);

/// Makes the body {psi < 0} of a formula. The body is piecewise smooth if max, min or abs make several patches of psi.
/// \throw ExpressionError  as domain_of_formula()
void set_formula(Domain& domain, const std::string& text, std::optional<double> t = std::nullopt);

}  // namespace umtet
