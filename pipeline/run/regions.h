#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "body/regions/region_bodies.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"

namespace umtet {

/// A body of `umtet regions`, from NAME=FORMULA or NAME=FILE.
struct NamedSource {
  std::string name, source;
};

/// Whether a source is the path of a file that exists; otherwise it is a formula.
bool is_file(const std::string& source);

/// Splits NAME=SOURCE. \throw UsageError for a missing or unusable name, or a missing source
NamedSource named_source(const std::string& text);

/// Bodies that become one mesh.
struct RegionsRequest {
  std::vector<NamedSource> bodies;  ///< region k + 1
  std::filesystem::path image;      ///< an image of labels, instead of bodies
  Overlap overlap = Overlap::Later;
  bool has_outside = true;   ///< whether the mesh fills the box
  bool is_periodic = false;  ///< the box is one period
  std::filesystem::path folder;
  Parameters parameters;  ///< parameters of stage one for files; mesh.box, mesh.h, mesh.tets, output.label_names
  int threads = 1;
};

struct RegionsOutcome {
  Json document;  ///< contents of regions.json
  std::vector<std::filesystem::path> files;
  std::string text;
  ExitCode code = ExitCode::Success;  ///< GateFailed if the certificate fails
};

/// Makes one mesh of several bodies that share their interfaces, and writes FOLDER/regions.vtu, with the region of
/// each tet, and its certificate FOLDER/regions.json. The pairs of vertices of a periodic mesh are in
/// FOLDER/periodic.csv.
///
/// The regions of an image are its labels; output.label_names are their names.
///
/// The level set of a file is FOLDER/bodies/NAME, a case that later calls reuse; a source that is no file is a formula.
/// h is mesh.h, or follows from mesh.tets and the volume of the box, or of the bodies if the mesh has no outside.
/// \throw UsageError for a formula without a box, or for names that repeat; ExpressionError; MeshingImpossible if a
///   body reaches the box or none is in it; the exceptions of run_case() for files, of read_grid() for an image;
///   std::system_error, Cancelled
RegionsOutcome mesh_regions(const RegionsRequest& request, Progress& progress);

}  // namespace umtet
