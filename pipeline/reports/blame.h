#pragma once

#include <optional>
#include <string>

#include "body/input_facts.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// Returns the stage that causes a certificate to fail, the number that shows it, and a remedy with its flag. The first
/// of these causes that applies is chosen: normals that contradict each other, missing parts of the input, normals,
/// noise, --max-tets, h, psi, the mesh itself. A stage comes before the stages that work on its result, because later
/// stages cannot repair it. \pre !certificate.verdict.passes()
Blame blame_for(const Certificate& certificate);

/// Returns the stage that causes a run to end without a mesh: normals that were turned, guessed or contradicted, if the
/// facts show them, else the stage that was at work.
/// @param message  why the run ended; its first line is the number. @param facts  none if there is no cloud
Blame blame_for_failure(Stage at_work, const std::string& message, const std::optional<InputFacts>& facts);

}  // namespace umtet
