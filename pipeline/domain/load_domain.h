#pragma once

#include <optional>

#include "body/body.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"

namespace umtet {

struct Handover;

/// mesh.implicit in mesh.box. @param t  what t stands for in the text; without it there is no such name
/// \throw UsageError (a formula without a box), ExpressionError
Domain formula_domain(const Parameters&, std::optional<double> t = std::nullopt);

/// The grid of mesh.level_set, in mesh.box or where it has values; of a segmentation around the body.
/// \throw GridRefused, UsageError, ResourceLimit, std::system_error
Domain grid_domain(const Parameters&);

/// The formula of mesh.implicit or the grid of mesh.level_set, or the level set and the cloud of the case.
/// @param handover  what there is of them in memory is taken from there, and not read
/// \throw UsageError (a formula without a box), ExpressionError, GridRefused, ResourceLimit, ArtefactDamaged,
///        std::system_error
Domain load_domain(const CasePaths&, const Parameters&, Handover* handover = nullptr);

}  // namespace umtet
