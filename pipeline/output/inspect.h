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
#include "reconstruct/cloud/cloud_survey.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/resolution.h"

namespace umtet {

/// What is in a cloud file.
struct CloudInspection {
  std::string file;  ///< as the user gave it
  CloudFileReport read;
  std::vector<std::string> fields;            ///< what the points carry: field_names()
  std::optional<SampledTriangles> triangles;  ///< none of a cloud; then the survey is of its samples
  CloudSurvey survey;
  Resolution lattice;                 ///< that a fit would choose
  RunPrediction prediction;           ///< of `umtet run` by the same parameters
  std::vector<std::string> troubles;  ///< what is likely to go wrong, each with its remedy

  std::size_t n_not_finite() const { return read.n_points_dropped + survey.dropped.n_not_finite; }
};

/// Nothing is changed and nothing is written.
/// @param parameters  of the run that is predicted, and by which the file is read
/// \throw CloudRefused, UsageError, std::system_error
CloudInspection inspect_cloud(const std::filesystem::path& file, const Parameters& parameters, Progress& progress);

/// What `umtet inspect --json` answers.
Json to_json(const CloudInspection& inspection);

/// The same in lines for people.
std::string inspection_text(const CloudInspection& inspection);

}  // namespace umtet
