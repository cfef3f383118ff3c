#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/output/run_prediction.h"
#include "reconstruct/level_set/grid.h"
#include "reconstruct/level_set/label_parts.h"

namespace umtet {

/// The contents of a file with an image, a level set or a segmentation.
struct ImageInspection {
  struct Part {
    LabelPart voxels;
    PartShape shape;
    double volume = 0;  ///< volume of the voxels, model units^3
  };
  std::string file;  ///< path as given by the user
  GridKind kind = GridKind::Image;
  Eigen::Vector3i n = Eigen::Vector3i::Zero();
  Vec3 steps = Vec3::Zero();                ///< size of a voxel, model units
  double least = 0, greatest = 0;           ///< range of values
  std::vector<Part> parts;                  ///< parts of a segmentation, ascending by number
  std::optional<double> suggested_level;    ///< suggested level of an image
  double wall_above = 0;                    ///< share of the wall with values above the suggested level
  std::optional<RunPrediction> prediction;  ///< for `umtet run` with the same parameters; none if a level is missing
  std::vector<std::string> notices;         ///< notices of that run
};

/// Inspects an image. Changes and writes nothing.
/// @param parameters  parameters of the predicted run: mesh.level, mesh.part and so on
/// \throw GridRefused, UsageError, MeshingImpossible, std::system_error
ImageInspection inspect_image(const std::filesystem::path& file, const Parameters& parameters, Progress& progress);

/// Returns the answer of `umtet inspect --json`.
Json to_json(const ImageInspection& inspection);

/// Returns the inspection as text.
std::string inspection_text(const ImageInspection& inspection);

}  // namespace umtet
