#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/meshing/certificate_report.h"

namespace umtet {

/// What is true of a mesh from a file: a Certificate without the parts that a mesh alone does not have.
struct MeshCheck {
  std::string file;                  ///< as the user gave it
  std::optional<std::string> units;  ///< of lengths, for the reader
  MeshCertificate mesh;
  std::optional<SecondOrderReport> second_order;  ///< of tets with 10 nodes
  Verdict verdict;
};

/// Judges any .vtu, .msh or .mesh: counts, quality, boundary; with a case also distances and normals against its psi.
/// @param against     a case whose level set or formula the mesh should fit
/// @param parameters  output.min_quality is the gate on the least mean ratio (0: none), output.units goes into the
///                    document
/// \throw MeshFileRefused, UsageError, ArtefactDamaged, Interrupted, std::system_error
MeshCheck check_mesh(const std::filesystem::path& mesh, const std::optional<std::filesystem::path>& against,
                     const Parameters& parameters, Progress& progress);

}  // namespace umtet
