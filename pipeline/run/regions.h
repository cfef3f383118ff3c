#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"

namespace umtet {

/// A body of `umtet regions`, from NAME=FORMULA.
struct NamedFormula {
  std::string name, formula;
};

/// Splits NAME=FORMULA. \throw UsageError for a missing or unusable name, or a missing formula
NamedFormula named_formula(const std::string& text);

/// Bodies that become one mesh.
struct RegionsRequest {
  std::vector<NamedFormula> bodies;  ///< region k + 1; later ones cover earlier ones
  bool has_outside = true;           ///< whether the mesh fills the box
  std::filesystem::path folder;
  Parameters parameters;  ///< mesh.box, mesh.h and mesh.tets
};

struct RegionsOutcome {
  Json document;  ///< contents of regions.json
  std::vector<std::filesystem::path> files;
  std::string text;
  ExitCode code = ExitCode::Success;  ///< GateFailed if the certificate fails
};

/// Makes one mesh of several bodies that share their interfaces, and writes FOLDER/regions.vtu, with the region of
/// each tet, and its certificate FOLDER/regions.json.
///
/// h is mesh.h, or follows from mesh.tets and the volume of the box, or of the bodies if the mesh has no outside.
/// \throw UsageError without a box, or for names that repeat; ExpressionError; MeshingImpossible if a body reaches the
///   box or none is in it; std::system_error, Cancelled
RegionsOutcome mesh_regions(const RegionsRequest& request, Progress& progress);

}  // namespace umtet
