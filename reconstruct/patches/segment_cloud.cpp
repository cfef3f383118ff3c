#include "reconstruct/patches/segment_cloud.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/patches/edge_acceptance.h"
#include "reconstruct/patches/filtered_normals.h"
#include "reconstruct/patches/measures.h"
#include "reconstruct/patches/patch_growing.h"
#include "reconstruct/patches/patch_merging.h"
#include "reconstruct/patches/patch_reassignment.h"

namespace umtet {
namespace {

/// Spacings, and radians: quadrics leave as much of curved patches without noise, such as a hole with a radius of 4
/// spacings.
constexpr double kLeastNoise = .02, kLeastTilt = 2 * kDegree;
constexpr int kReassignments = 2;  ///< of reassignment and merging
constexpr int kMostMergers = 20;   ///< rounds of merging: a bound on the time, not reached on parts
/// Largest ratio of the misfits of a part: parts of the tests have at most 1.07, fandisk 1.11, organic scans 2 and
/// more.
constexpr double kPart = 1.15;
/// Spacings: beyond it, positions do not distinguish an edge from a fillet with a radius of one spacing, whose middle
/// is .4 spacings from the edge.
constexpr double kMostPositionNoise = .3;

/// Spacings: up to it, positions alone distinguish an edge from such a fillet. Then they overrule normals that turn
/// gradually at an edge, because a scanner's program averaged them.
constexpr double kMostClearNoise = .06;

/// Parts and a chair have .39 and more, a helmet with creases and a scorpion .05 and less.
constexpr double kCommon = .2;

/// Of parts with measured normals. Fillets with a radius of one spacing have a share of .64 and less at any noise,
/// edges of the parts of the tests one of .7 and more. At holes made of facets, normals leave a `two` of 5.
constexpr EdgeThresholds kPartEdges = {0, .67, 3, 1.3, 8, kCommon};
/// Of parts with estimated normals: the same fillets have shares of up to .82, and `two` of 1.6 and more.
constexpr EdgeThresholds kPositionEdges = {0, .55, 1.7, 2, 8, kCommon};
/// Of organic shapes with measured normals.
constexpr EdgeThresholds kOrganicEdges = {0, .8, 1.6, 4, 12, kCommon};

/// Least length of a network of edges over the diagonal of the cloud: where scans with an offset overlap, as in the ten
/// of the Stanford bunny, false edges of 3 % arise. On organic shapes the share is a choice: no cloud at hand has
/// edges there.
constexpr double kLeastOfDiagonal = .05, kLeastOfOrganicDiagonal = .2;

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

/// Diagonal of the bounding box.
double diagonal(const std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = low;
  for (const Vec3& x : points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return (high - low).norm();
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

/// Grown regions, made one per smooth patch.
std::vector<int> smooth_patches(PatchCloud& cloud) {
  std::vector<int> labels = grow_patches(cloud.points, cloud.normals, cloud.near);
  cloud.noise = std::max(kLeastNoise, patch_misfit(cloud, labels).noise);
  for (int round = 0; round < kReassignments; ++round) {
    reassign_at_borders(cloud, labels);
    for (int k = 0; k < kMostMergers && merge_smooth_borders(cloud, labels); ++k) {
    }
  }
  return labels;
}

struct Division {
  SamplePatches patches;
  PatchMisfit misfit;
  bool is_part() const { return misfit.ratio <= kPart; }
};

/// @param points  at least kFewestSegmented
Division divided(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, double spacing, double least_angle,
                 bool measured) {
  PatchCloud cloud = scaled_cloud(points, normals, spacing, measured);
  Division result;
  std::vector<int>& labels = result.patches.patch;
  labels = smooth_patches(cloud);
  result.misfit = patch_misfit(cloud, labels);
  cloud.noise = std::max(kLeastNoise, result.misfit.noise);
  if (!measured && (!result.is_part() || result.misfit.noise > kMostPositionNoise)) {
    std::fill(labels.begin(), labels.end(), 0);
  } else {
    EdgeThresholds enough = !result.is_part() ? kOrganicEdges : measured ? kPartEdges : kPositionEdges;
    enough.angle = least_angle;
    enough.length = std::max(enough.length,
                             (result.is_part() ? kLeastOfDiagonal : kLeastOfOrganicDiagonal) * diagonal(cloud.points));
    result.patches.borders = accept_edges(cloud, labels, enough);
    for (SamplePatches::Border& border : result.patches.borders) border.length *= spacing;
  }
  result.patches.count = renumber(labels);
  result.patches.normals = sheet_normals(cloud, labels);
  result.patches.noise = result.misfit.noise * spacing;
  result.patches.spacing = spacing;
  return result;
}

}  // namespace

std::vector<std::string> problems(const SegmentationParams& params) {
  if (params.least_angle >= 30 && params.least_angle <= 90) return {};
  return {formatted("least_angle = %g: must be in 30..90", params.least_angle)};
}

SamplePatches segment_cloud(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, double spacing,
                            const SegmentationParams& params) {
  check(points, normals, spacing, params);
  if (points.size() < kFewestSegmented) {
    SamplePatches one;
    one.patch.assign(points.size(), 0);
    one.count = points.empty() ? 0 : 1;
    one.normals = normals;
    one.spacing = spacing;
    return one;
  }
  const double least_angle = params.least_angle * kDegree;
  Division division = divided(points, normals, spacing, least_angle, params.measured_normals);
  if (params.measured_normals && division.patches.count == 1 && division.is_part() &&
      division.misfit.noise <= kMostClearNoise) {
    Division by_positions = divided(points, normals, spacing, least_angle, false);
    if (by_positions.patches.count > 1) return std::move(by_positions.patches);
  }
  return std::move(division.patches);
}

}  // namespace umtet
