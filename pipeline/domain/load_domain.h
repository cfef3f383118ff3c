#pragma once

#include <optional>

#include "body/body.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"

namespace umtet {

struct Handover;

/// Returns mesh.implicit in mesh.box. @param t  value of t in the formula; without it, the name t is unknown
/// \throw UsageError (a formula without a box), ExpressionError
Domain formula_domain(const Parameters&, std::optional<double> t = std::nullopt);

/// Returns the grid of mesh.level_set, in mesh.box or where the grid has values; a segmentation is restricted to the
/// surroundings of the body.
/// \throw GridRefused, UsageError, ResourceLimit, std::system_error
Domain grid_domain(const Parameters&);

/// Returns the formula of mesh.implicit, or the grid of mesh.level_set, or the level set and the cloud of the case.
/// @param handover  results in memory are taken from here instead of being read
/// \throw UsageError (a formula without a box), ExpressionError, GridRefused, ResourceLimit, ArtefactDamaged,
///   std::system_error
Domain load_domain(const CasePaths&, const Parameters&, Handover* handover = nullptr);

}  // namespace umtet
