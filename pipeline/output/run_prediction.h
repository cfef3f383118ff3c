#pragma once

#include <filesystem>
#include <string>

#include "common/context.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"
#include "reconstruct/cloud/cloud_survey.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {

/// What a run takes to make this many tets.
struct RunCost {
  double n_tets = 0;
  double seconds = 0;    ///< of one thread, on the machine of docs/performance.md
  double memory_MB = 0;  ///< peak of the process
};

/// What `umtet run` of a cloud is likely to take: for a scheduler that has to know before.
struct RunPrediction {
  double h = 0;            ///< mean edge length of the background, of its smallest edges if it is graded; model units
  bool is_graded = false;  ///< edges follow the body
  RunCost expected;        ///< of one mesh
  RunCost most;            ///< if it is made again, as mesh.effort allows
  std::string obstacle{};  ///< why a run is likely to end without a mesh; the costs are then those of the samples alone
};

/// By the choice that a run makes: psi is fitted to the samples, to every m-th of them where there are more than
/// 60,000, and BackgroundChoice chooses h or sizes for it. Tets are those that it expects.
/// @param file  for messages
/// \throw CloudRefused, SolveError, SolveTooLarge, MeshingImpossible, ResourceLimit, UsageError  as the run does;
///        Cancelled
RunPrediction predict_run(CloudFile scan, const std::filesystem::path& file, const Parameters& parameters,
                          const Context& context = {});

/// By the samples alone, where there is no psi: by the rule of choose_edge_length(), with the thickness of the samples
/// in place of that of psi, and by the volume and area behind the samples: as if the surface were closed. Where normals
/// do not say the volume it is that of the ball of this area, or of the box if that is less: no body of the area has
/// more. For mesh.max_deviation, a background in a file and the fluid in a box the number of tets is mesh.max_tets,
/// since nothing is known of these.
/// @param area  of all samples together
RunPrediction predict_run(const CloudSurvey& survey, double area, const Parameters& parameters);

/// What a mesh of about so many tets takes. @param n_points  of a cloud that psi is fitted to, else 0
RunPrediction prediction_of(double h, double n_tets, double n_points, const Parameters& parameters);

Json to_json(const RunPrediction& prediction);
/// The line `a run` of `umtet inspect`.
std::string prediction_text(const RunPrediction& prediction);

}  // namespace umtet
