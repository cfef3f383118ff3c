#include "reconstruct/patches/segment_cloud.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/patches/edge_acceptance.h"
#include "reconstruct/patches/filtered_normals.h"
#include "reconstruct/patches/patch_growing.h"
#include "reconstruct/patches/patch_merging.h"
#include "reconstruct/patches/patch_reassignment.h"

namespace umtet {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
/// Spacings, and radians: quadrics leave as much of curved patches without noise, such as a hole with a radius of 4
/// spacings.
constexpr double kLeastNoise = .02, kLeastTilt = 2 * kDegree;
constexpr int kRounds = 2;        ///< of reassignment and merging
constexpr int kMostMergers = 20;  ///< rounds of merging; on all clouds of the tests it ends after four
/// Largest ratio of the misfits of a part: parts of the tests have at most 1.08, organic shapes without noise 1.4 and
/// more.
constexpr double kPart = 1.15;
/// Spacings: beyond it, positions do not distinguish an edge from a fillet with a radius of one spacing, whose middle
/// is .4 spacings from the edge.
constexpr double kMostPositionNoise = .3;

/// Of parts with measured normals. Fillets with a radius of one spacing have a share of .64 and less at any noise,
/// edges of the parts of the tests one of .7 and more.
constexpr EdgeThresholds kPartEdges = {0, .67, 3, 1.3, 8};
/// Of parts with estimated normals: the same fillets have shares of up to .82, and `two` of 1.6 and more.
constexpr EdgeThresholds kPositionEdges = {0, .55, 1.7, 2, 8};
/// Of organic shapes with measured normals.
constexpr EdgeThresholds kOrganicEdges = {0, .7, 1.6, 3, 12};

PatchCloud scaled_cloud(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, double spacing,
                        bool measured) {
  PatchCloud cloud;
  cloud.points.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) cloud.points[i] = (points[i] - points[0]) / spacing;
  cloud.measured = normals;
  cloud.near = Neighbourhoods(cloud.points, kPatchNeighbours);
  FilteredNormals filtered = measured ? filter_normals(cloud.points, normals, cloud.near)
                                      : estimate_edged_normals(cloud.points, normals, cloud.near);
  cloud.normals = std::move(filtered.normals);
  cloud.tilt = std::max(kLeastTilt, filtered.tilt);
  return cloud;
}

/// Normals of the sheets of the patches at their samples.
std::vector<Vec3> sheet_normals(const PatchCloud& cloud, const std::vector<int>& labels) {
  std::vector<Vec3> normals = cloud.normals;
  tbb::parallel_for(std::size_t{0}, cloud.size(), [&](std::size_t i) {
    if (const auto sheet = sheet_near(cloud, labels, labels[i], i)) normals[i] = sheet->normal(cloud.points[i]);
  });
  return normals;
}

void check(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, double spacing,
           const SegmentationParams& params) {
  if (const auto found = problems(params); !found.empty()) throw std::invalid_argument(joined(found, "; "));
  if (points.size() != normals.size())
    throw std::invalid_argument(formatted("%zu points have %zu normals", points.size(), normals.size()));
  if (!(spacing > 0)) throw std::invalid_argument(formatted("spacing = %g: must be > 0", spacing));
}

}  // namespace

std::vector<std::string> problems(const SegmentationParams& params) {
  if (params.least_angle >= 30 && params.least_angle <= 90) return {};
  return {formatted("least_angle = %g: must be in 30..90", params.least_angle)};
}

SamplePatches segment_cloud(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, double spacing,
                            const SegmentationParams& params) {
  check(points, normals, spacing, params);
  SamplePatches result;
  result.patch.assign(points.size(), 0);
  result.count = points.empty() ? 0 : 1;
  result.normals = normals;
  result.spacing = spacing;
  if (points.size() < kFewestSegmented) return result;

  PatchCloud cloud = scaled_cloud(points, normals, spacing, params.measured_normals);
  std::vector<int>& labels = result.patch;
  labels = grow_patches(cloud.points, cloud.normals, cloud.near);
  cloud.noise = std::max(kLeastNoise, patch_misfit(cloud, labels).noise);
  for (int round = 0; round < kRounds; ++round) {
    reassign_at_borders(cloud, labels);
    for (int k = 0; k < kMostMergers && merge_smooth_borders(cloud, labels); ++k) {
    }
  }
  const PatchMisfit misfit = patch_misfit(cloud, labels);
  cloud.noise = std::max(kLeastNoise, misfit.noise);
  const bool is_part = misfit.ratio <= kPart;
  if (!params.measured_normals && (!is_part || misfit.noise > kMostPositionNoise)) {
    std::fill(labels.begin(), labels.end(), 0);
  } else {
    EdgeThresholds enough = !is_part ? kOrganicEdges : params.measured_normals ? kPartEdges : kPositionEdges;
    enough.angle = params.least_angle * kDegree;
    result.borders = accept_edges(cloud, labels, enough);
    for (SamplePatches::Border& border : result.borders) border.length *= spacing;
  }
  result.count = renumber(labels);
  result.normals = sheet_normals(cloud, labels);
  result.noise = misfit.noise * spacing;
  return result;
}

}  // namespace umtet
