#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// Measures and judges any .vtu, .msh, .mesh or .inp: counts, quality, boundary; with a case also distances and normals
/// relative to its psi, and without one also each region, where the tets have several (file_regions()).
/// @param against     a case whose level set or formula the mesh should fit
/// @param parameters  output.min_quality is the gate on the minimum mean ratio (0: none), output.units goes into the
///   document
/// \throw MeshFileRefused, UsageError, ArtefactDamaged, Interrupted, std::system_error
MeshCheck check_mesh(const std::filesystem::path& mesh, const std::optional<std::filesystem::path>& against,
                     const Parameters& parameters, Progress& progress);

}  // namespace umtet
