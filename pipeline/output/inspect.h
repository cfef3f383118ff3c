#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/output/run_prediction.h"
#include "pipeline/stages/scan_source.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/resolution.h"

namespace umtet {

/// The contents of a cloud file.
struct CloudInspection {
  std::string file;  ///< path as given by the user
  CloudFileReport read;
  std::vector<std::string> fields;            ///< names of the data of the points: field_names()
  std::optional<SampledTriangles> triangles;  ///< none for a cloud; if set, the survey covers its samples
  CloudSurvey survey;
  Resolution lattice;                 ///< lattice that a fit would choose
  RunPrediction prediction;           ///< prediction for `umtet run` with the same parameters
  std::vector<std::string> troubles;  ///< likely problems, each with its remedy

  std::size_t n_not_finite() const { return read.n_points_dropped + survey.dropped.n_not_finite; }
};

/// Inspects a cloud. Changes and writes nothing.
/// @param parameters  parameters of the predicted run, also used to read the file
/// \throw CloudRefused, UsageError, std::system_error
CloudInspection inspect_cloud(const InputFile& input, const Parameters& parameters, Progress& progress);

/// Returns the answer of `umtet inspect --json`.
Json to_json(const CloudInspection& inspection);

/// Returns the inspection as text.
std::string inspection_text(const CloudInspection& inspection);

}  // namespace umtet
