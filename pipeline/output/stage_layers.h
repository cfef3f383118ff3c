#pragma once

#include <string>
#include <utility>
#include <vector>

#include "body/body.h"
#include "body/scan/cloud_preparation.h"
#include "pipeline/output/report_scene.h"

namespace umtet {

/// Points that the viewer of a report draws over any stage.
struct SampleLayer {
  std::string id;    ///< "samples", "outliers", "small_components", "no_normal", "turned", "doubtful"
  std::string name;  ///< legend
  Vec3 box_min = Vec3::Zero(), box_size = Vec3::Zero();  ///< model coordinates
  std::size_t n = 0, n_shown = 0;
  bool has_normals = false;
  std::vector<SceneHead::Field> values;
};

Json to_json(const SampleLayer& layer);

/// The layers, and their arrays in base64, by name:
///   layer_ID            3 x uint16 per point, in 65535ths of the box
///   layer_ID_normals    3 bytes per point: components from -1 to 1 in 254ths
///   layer_ID_value_N    one byte each of values[N], in 254ths of the range; 255: no value
struct SampleLayers {
  std::vector<SampleLayer> layers;
  std::vector<std::pair<std::string, std::string>> blocks;
};

/// Returns the samples and, for each kind of mark that occurs, a layer of the marked samples.
/// @param cloud   the prepared samples. @param shift  added to their coordinates
/// @param domain  if given: its psi gives the value `residual`, the distance of a sample from psi = 0 by one step of
///   Newton's method. Working coordinates of the domain are those of the cloud
/// @param most    number of points that a layer shows at most
/// \throw Cancelled
SampleLayers sample_layers(const OrientedPointCloud& cloud, const Vec3& shift, const std::vector<MarkedSample>& marked,
                           const Domain* domain, std::size_t most = ReportCaps().points);

/// Returns |psi| / |grad psi| at points, NaN where it is not a number. \throw Cancelled
std::vector<double> residuals(const Domain& domain, const std::vector<Vec3>& points);

}  // namespace umtet
