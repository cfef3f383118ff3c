#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/patches/local_sheet.h"

namespace umtet {

/// Two samples that are neighbours on different patches: sample i of patch a, and sample j of patch b.
struct BorderSite {
  std::uint32_t i, j;
  int a, b;
};

/// Both patches of a site, the lesser first.
inline std::pair<int, int> pair_of(const BorderSite& site) { return std::minmax(site.a, site.b); }

/// Number of neighbours of every sample. Next to a border, half of them on each side are enough for a quadric.
inline constexpr std::size_t kPatchNeighbours = 48;

/// A cloud in units of its sample spacing, with what all steps of the segmentation need.
struct PatchCloud {
  std::vector<Vec3> points;    ///< in sample spacings
  std::vector<Vec3> measured;  ///< unit normals as given
  std::vector<Vec3> normals;   ///< unit normals, filtered
  Neighbourhoods near;         ///< kPatchNeighbours, or all others if there are fewer
  double noise = 0;            ///< standard deviation of positions along the normal, in sample spacings; > 0
  double tilt = 0;  ///< standard deviation of measured normals about each tangent, radians; infinite: not measured

  std::size_t size() const { return points.size(); }
  bool has_measured_normals() const { return std::isfinite(tilt); }
  SheetSamples samples() const { return {points, measured, noise, tilt}; }
  std::span<const std::uint32_t> nearest(std::size_t i, std::size_t count) const {
    return near.points(i).first(std::min(count, near.k()));
  }
  Vec3 middle(const BorderSite& site) const { return .5 * (points[site.i] + points[site.j]); }
};

/// Does a sample belong to the samples to which a sheet near it is fitted?
enum class Itself { Included, LeftOut };

/// The sheet of a patch near a sample, through the nearest 20 samples on the patch, or fewer if the patch curves too
/// strongly for a quadric through them.
/// @return none if fewer than five of the neighbours are on the patch
std::optional<LocalSheet> sheet_near(const PatchCloud& cloud, const std::vector<int>& labels, int label, std::size_t i,
                                     Itself itself = Itself::Included);

/// All border sites: for each sample and each other patch around it, the nearest sample on this patch. Samples on
/// opposite sides of a thin sheet do not touch. Sorted by pair_of(), then by i and j.
std::vector<BorderSite> border_sites(const PatchCloud& cloud, const std::vector<int>& labels);

/// Length of a border per site, in sample spacings: the length of the edges of a cube over their number of sites.
inline constexpr double kLengthPerSite = .28;

/// The first site of each pair of patches in sorted sites, and the number of sites.
std::vector<std::size_t> pair_starts(const std::vector<BorderSite>& sites);

/// A search for sites near each other.
class SitesInSpace {
 public:
  /// \pre there is a site
  SitesInSpace(const PatchCloud& cloud, const std::vector<BorderSite>& sites);
  /// The sites within a radius (sample spacings) of site k, itself included, in ascending order.
  std::vector<std::uint32_t> within(std::size_t k, double radius) const;

 private:
  std::vector<Vec3> places_;
  NeighbourTree tree_;
};

/// For each site that is a member, the number of members in its network; 0 for others. Members within `together`
/// spacings of each other belong to one network.
std::vector<std::size_t> network_sizes(const PatchCloud& cloud, const std::vector<BorderSite>& sites,
                                       const std::vector<char>& member, double together);

}  // namespace umtet
