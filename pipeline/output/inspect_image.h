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

/// What is in the file of an image, a level set or a segmentation.
struct ImageInspection {
  struct Part {
    LabelPart voxels;
    PartShape shape;
    double volume = 0;  ///< of the voxels, model units^3
  };
  std::string file;  ///< as the user gave it
  GridKind kind = GridKind::Image;
  Eigen::Vector3i n = Eigen::Vector3i::Zero();
  Vec3 steps = Vec3::Zero();                ///< of a voxel, model units
  double least = 0, greatest = 0;           ///< value
  std::vector<Part> parts;                  ///< of a segmentation, ascending in their numbers
  std::optional<double> suggested_level;    ///< of an image
  double wall_above = 0;                    ///< the share of the wall whose values are above that
  std::optional<RunPrediction> prediction;  ///< of `umtet run` by the same parameters; none where a level is missing
  std::vector<std::string> notices;         ///< of that run
};

/// Nothing is changed and nothing is written.
/// @param parameters  of the run that is predicted: mesh.level, mesh.part and so on
/// \throw GridRefused, UsageError, MeshingImpossible, std::system_error
ImageInspection inspect_image(const std::filesystem::path& file, const Parameters& parameters, Progress& progress);

/// What `umtet inspect --json` answers.
Json to_json(const ImageInspection& inspection);

/// The same in lines for people.
std::string inspection_text(const ImageInspection& inspection);

}  // namespace umtet
