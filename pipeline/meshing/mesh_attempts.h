#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mesh/certify/quadratic_tets.h"
#include "mesh/universal_mesh.h"
#include "pipeline/domain/edge_length.h"
#include "pipeline/domain/too_thin.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// One run of the algorithm and, if it made a mesh, what is true of it.
struct MeshAttempt {
  double h = 0;  ///< edge length of the background mesh, model units
  UmResult result;
  std::optional<SecondOrder> second;  ///< the mesh with curved edges, if mesh.order = 2
  MeshMeasures measured;              ///< when there is a mesh
  ThinPlaces thin;                    ///< what h is too large for

  bool made() const { return result.status == UmStatus::Success; }
  std::size_t n_reasons() const { return made() ? measured.reasons.size() : 0; }
  bool is_right() const { return made() && n_reasons() == 0; }
  /// There is no mesh, and what is too thin for h says why.
  bool fell_through() const { return !made() && !thin.empty(); }
  /// What is wrong with it first of all; empty if nothing is.
  std::string complaint() const;
};

/// Runs `attempt` at choice.h and, while something is wrong that a smaller h may mend, at .985 of it (if there was a
/// mesh at all: a few folded faces come and go with h), then at .8, .64 and .51 of it; never below choice.least, which
/// is tried instead where it is nearer. Where noise decided h, all of these are shares of what thin parts ask for,
/// which itself comes first.
///
/// @param say  called with why another h is tried, and with which mesh is kept if it is not the last
/// @return the best of them: a mesh before none, then the one with the fewest reasons against it, then the last
MeshAttempt best_attempt(const EdgeLength& choice, const std::function<MeshAttempt(double h)>& attempt,
                         const std::function<void(const std::string&)>& say);

}  // namespace umtet
