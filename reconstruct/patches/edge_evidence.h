#pragma once

#include <vector>

#include "reconstruct/patches/patch_cloud.h"

namespace umtet {

/// How well quadrics fit the patches of a cloud. It tells noise from shape, and a part from an organic shape.
struct PatchMisfit {
  double noise = 0;  ///< standard deviation of positions from quadrics through 16 samples, in sample spacings
  double ratio = 1;  ///< the same for 45 samples, relative to 16: 1 where patches are quadrics up to noise
};

/// Measures the misfit by the medians over samples whose neighbours are on their own patch.
PatchMisfit patch_misfit(const PatchCloud& cloud, const std::vector<int>& labels);

/// Evidence of an edge from the samples at a border site, averaged along the border.
///
/// Residuals are those of positions, in units of the noise, and of measured normals, in units of their tilt. Their mean
/// squares are relative to those of the same patches away from their borders.
struct SiteEvidence {
  double angle = 0;  ///< between the sheets of both patches, radians
  double two = 0;    ///< mean square residual of samples beside the edge from the nearer one of two sheets
  double one = 0;    ///< the same from a single sheet through both patches
  double ideal = 0;  ///< the part of `one` that an edge between both sheets would cause
  double count = 0;  ///< samples that were compared; 0: nothing is known
};

/// Evidence of each site, averaged over the sites of the same two patches within three spacings. An edge between both
/// sheets has a `two` of 1, and `one` is `two` + `ideal`. The samples of a fillet are off both sheets and nearer to the
/// single one: (one - two) / ideal is smaller, at any noise.
/// @param sites  border_sites()
std::vector<SiteEvidence> evidence_at(const PatchCloud& cloud, const std::vector<int>& labels,
                                      const std::vector<BorderSite>& sites);

/// Thresholds of the evidence for an edge.
struct EdgeThresholds {
  double angle;   ///< least angle, radians
  double share;   ///< least (one - two) / ideal
  double two;     ///< largest two
  double gain;    ///< least one / two
  double length;  ///< least length of a network of edges, in sample spacings
  double common;  ///< least share of the sites with such an angle that are accepted
};

/// Finds the sites that belong to edges: sites with enough evidence, in networks that are long enough. None do if few
/// of the sites with a large angle do: the creases of organic shapes and rounded parts are sharp by chance at some
/// places.
std::vector<char> accepted_sites(const PatchCloud& cloud, const std::vector<BorderSite>& sites,
                                 const std::vector<SiteEvidence>& evidence, const EdgeThresholds& enough);

}  // namespace umtet
