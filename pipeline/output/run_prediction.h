#pragma once

#include <filesystem>
#include <string>

#include "common/context.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"
#include "pipeline/domain/edged_case.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {

/// The cost of a run that makes this many tets.
struct RunCost {
  double n_tets = 0;
  double seconds = 0;    ///< seconds with one thread, on the machine of docs/performance.md
  double memory_MB = 0;  ///< peak memory of the process
};

/// The likely cost of `umtet run` for a cloud, for schedulers that need it in advance.
struct RunPrediction {
  double h = 0;  ///< mean edge length of the background, or of its smallest edges if it is graded; model units
  bool is_graded = false;  ///< edge lengths follow the body
  RunCost expected;        ///< cost of one mesh
  RunCost most;            ///< cost if the mesh is made again as often as mesh.effort allows
  std::string obstacle{};  ///< reason why a run is likely to end without a mesh; the costs are then estimated from the
                           ///< samples alone
};

/// Predicts a run by its own choice of resolution: psi is fitted to the samples, or to every m-th sample of more than
/// 60,000, and BackgroundChoice chooses h or sizes and gives the expected number of tets.
/// @param file  name of the file in messages
/// \throw CloudRefused, SolveError, SolveTooLarge, MeshingImpossible, ResourceLimit, UsageError  as in the run;
///   Cancelled
RunPrediction predict_run(CloudFile scan, const std::filesystem::path& file, const Parameters& parameters,
                          const Context& context = {});

/// Predicts a run that keeps the sharp edges of triangles. \pre edged.body
/// \throw MeshingImpossible, ResourceLimit, UsageError  as in the run; Cancelled
RunPrediction predict_run(const EdgedTriangles& edged, const Parameters& parameters, const Context& context = {});

/// Predicts a run from the samples alone, if there is no psi: by the rule of choose_edge_length(), with the thickness
/// of the samples in place of the thickness of psi, and with the volume and area of the samples as if the surface were
/// closed. If the normals do not determine the volume, it is the volume of a ball of this area, or of the box if that
/// is smaller: no body of this area has more. For mesh.max_deviation, a background in a file and the fluid in a box,
/// the number of tets is mesh.max_tets, because nothing is known about them.
/// @param area  total area of all samples
RunPrediction predict_run(const CloudSurvey& survey, double area, const Parameters& parameters);

/// Returns the cost of a mesh of about n_tets tets. @param n_points  number of points to which psi is fitted, or 0
RunPrediction prediction_of(double h, double n_tets, double n_points, const Parameters& parameters);

Json to_json(const RunPrediction& prediction);
/// Returns the line `a run` of `umtet inspect`.
std::string prediction_text(const RunPrediction& prediction);

}  // namespace umtet
