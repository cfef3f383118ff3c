#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/record.h"

namespace umtet {

/// Judges any .vtu, .msh or .mesh: counts, quality, boundary; with a case also distances and normals against its psi.
/// @param against      a case whose level set or formula the mesh should fit
/// @param min_quality  gate on the least mean ratio, 0: none
/// @return a document like the certificate, without the parts that a mesh alone does not have
/// \throw MeshFileRefused, UsageError, ArtefactDamaged, std::system_error
Json check_mesh(const std::filesystem::path& mesh, const std::optional<std::filesystem::path>& against,
                double min_quality);

}  // namespace umtet
