#include "reconstruct/patches/patch_cloud.h"

#include <array>
#include <tuple>

#include "common/disjoint_sets.h"

namespace umtet {
namespace {

constexpr std::size_t kMembers = 20;     ///< samples of a sheet: three times the coefficients of a quadric
constexpr std::size_t kFewMembers = 11;  ///< where a quadric misfits more of them: surfaces that curve strongly
constexpr double kMisfit = 1.5;          ///< median residual in units of the noise; noise alone leaves .67
constexpr std::size_t kFewestMembers = 5;
constexpr std::size_t kTouching = 12;   ///< neighbours among which a sample touches another patch: two rings
constexpr double kTouchingReach = 2.5;  ///< spacings: beyond the second ring

/// True if two samples are on opposite sides of a thin sheet, and not on both sides of an edge of more than 20 degrees.
bool are_opposite(const PatchCloud& cloud, std::size_t i, std::size_t j) {
  constexpr double kOpposite = -.94, kAcross = .7;  // cosines of 160 and 45 degrees
  if (cloud.normals[i].dot(cloud.normals[j]) > kOpposite) return false;
  const Vec3 d = cloud.points[j] - cloud.points[i];
  return std::abs(cloud.normals[i].dot(d)) > kAcross * d.norm();
}

std::vector<Vec3> places_of(const PatchCloud& cloud, const std::vector<BorderSite>& sites) {
  std::vector<Vec3> places;
  places.reserve(sites.size());
  for (const BorderSite& site : sites) places.push_back(cloud.points[site.i]);
  return places;
}

}  // namespace

std::optional<LocalSheet> sheet_near(const PatchCloud& cloud, const std::vector<int>& labels, int label, std::size_t i,
                                     Itself itself) {
  std::array<std::uint32_t, kMembers> members;
  std::size_t n = 0;
  Vec3 up = Vec3::Zero();
  const auto add = [&](std::uint32_t j) {
    members[n++] = j;
    up += cloud.normals[j];
  };
  if (itself == Itself::Included && labels[i] == label) add(static_cast<std::uint32_t>(i));
  for (const std::uint32_t j : cloud.near.points(i)) {
    if (n == kMembers) break;
    if (labels[j] == label) add(j);
  }
  // The other side of a thin sheet may belong to the same patch.
  const auto end = std::remove_if(members.begin(), members.begin() + static_cast<std::ptrdiff_t>(n),
                                  [&](std::uint32_t j) { return cloud.normals[j].dot(up) < 0; });
  n = static_cast<std::size_t>(end - members.begin());
  if (n < kFewestMembers || !(up.norm() > 1e-9)) return std::nullopt;
  const auto all = std::span<const std::uint32_t>(members).first(n);
  const LocalSheet sheet(cloud.samples(), cloud.points[i], up.normalized(), all);
  if (n <= kFewMembers || sheet.residual() < kMisfit * cloud.noise) return sheet;
  Vec3 nearer = Vec3::Zero();
  for (const std::uint32_t j : all.first(kFewMembers)) nearer += cloud.normals[j];
  return LocalSheet(cloud.samples(), cloud.points[i], nearer.normalized(), all.first(kFewMembers));
}

std::vector<BorderSite> border_sites(const PatchCloud& cloud, const std::vector<int>& labels) {
  std::vector<BorderSite> sites;
  std::vector<int> seen;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    seen.assign(1, labels[i]);
    for (const std::uint32_t j : cloud.nearest(i, kTouching)) {
      if ((cloud.points[j] - cloud.points[i]).norm() > kTouchingReach) break;
      if (std::find(seen.begin(), seen.end(), labels[j]) != seen.end() || are_opposite(cloud, i, j)) continue;
      seen.push_back(labels[j]);
      sites.push_back({i, j, labels[i], labels[j]});
    }
  }
  std::sort(sites.begin(), sites.end(), [](const BorderSite& s, const BorderSite& t) {
    return std::make_tuple(pair_of(s), s.i, s.j) < std::make_tuple(pair_of(t), t.i, t.j);
  });
  return sites;
}

std::vector<std::size_t> pair_starts(const std::vector<BorderSite>& sites) {
  std::vector<std::size_t> starts;
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (k == 0 || pair_of(sites[k - 1]) != pair_of(sites[k])) starts.push_back(k);
  starts.push_back(sites.size());
  return starts;
}

SitesInSpace::SitesInSpace(const PatchCloud& cloud, const std::vector<BorderSite>& sites)
    : places_(places_of(cloud, sites)), tree_(places_) {}

std::vector<std::uint32_t> SitesInSpace::within(std::size_t k, double radius) const {
  std::vector<std::uint32_t> found;
  tree_.within(places_[k], radius * radius, [&](std::uint32_t l, double) { found.push_back(l); });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::size_t> network_sizes(const PatchCloud& cloud, const std::vector<BorderSite>& sites,
                                       const std::vector<char>& member, double together) {
  std::vector<std::size_t> size(sites.size());
  if (sites.empty()) return size;
  const SitesInSpace in_space(cloud, sites);
  DisjointSets sets(sites.size());
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if (!member[k]) continue;
    for (const std::uint32_t l : in_space.within(k, together))
      if (member[l]) sets.unite(static_cast<int>(k), static_cast<int>(l));
  }
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (member[k]) ++size[static_cast<std::size_t>(sets.find(static_cast<int>(k)))];
  for (std::size_t k = sites.size(); k-- > 0;)  // a root is the least member of its network
    if (member[k]) size[k] = size[static_cast<std::size_t>(sets.find(static_cast<int>(k)))];
  return size;
}

}  // namespace umtet
