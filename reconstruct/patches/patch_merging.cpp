#include "reconstruct/patches/patch_merging.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reconstruct/patches/measures.h"
#include "reconstruct/patches/patch_growing.h"
#include "reconstruct/patches/patch_mergers.h"

namespace umtet {
namespace {

constexpr double kSmooth = 25 * kDegree;  ///< mean turn of a border that is no edge
constexpr double kSharp = 30 * kDegree;   ///< turn of a stretch that is one
constexpr std::size_t kStretch = 6;       ///< sites of such a stretch
constexpr double kSheetStep = .5;         ///< spacings between sheets that do not continue each other, ...
constexpr double kStepDeviations = 3;     ///< ... or deviations of positions: two sheets are off by less than one
constexpr double kStretchGap = 2.5;       ///< spacings between two sites of a stretch: beyond the second ring

/// The angle between the sheets of both patches at a site, pi if they pass each other like the sides of a step, and -1
/// if one of them is too small to have a sheet.
double turn_at(const PatchCloud& cloud, const std::vector<int>& labels, const BorderSite& site) {
  const auto a = sheet_near(cloud, labels, site.a, site.i), b = sheet_near(cloud, labels, site.b, site.i);
  if (!a || !b) return -1;
  const Vec3 x = cloud.middle(site);
  if (std::abs(a->distance(x) - b->distance(x)) > std::max(kSheetStep, kStepDeviations * cloud.noise))
    return std::numbers::pi;
  return angle_between(a->normal(x), b->normal(x));
}

struct PairTurn {
  int a, b;
  double mean;
};

double mean_of_known(std::span<const double> turns) {
  double sum = 0, count = 0;
  for (const double turn : turns) {
    if (turn < 0) continue;
    sum += turn;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

/// True if the sites with a sharp turn include a stretch that is long enough.
bool has_sharp_stretch(const PatchCloud& cloud, std::span<const BorderSite> sites, std::span<const double> turns) {
  std::vector<BorderSite> sharp;
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (turns[k] > kSharp) sharp.push_back(sites[k]);
  if (sharp.size() < kStretch) return false;
  const std::vector<std::size_t> size = network_sizes(cloud, sharp, std::vector<char>(sharp.size(), 1), kStretchGap);
  return *std::max_element(size.begin(), size.end()) >= kStretch;
}

}  // namespace

bool merge_smooth_borders(const PatchCloud& cloud, std::vector<int>& labels) {
  PatchMergers mergers(static_cast<std::size_t>(renumber(labels)));
  const std::vector<BorderSite> sites = border_sites(cloud, labels);
  std::vector<double> turns(sites.size());
  tbb::parallel_for(std::size_t{0}, sites.size(), [&](std::size_t k) { turns[k] = turn_at(cloud, labels, sites[k]); });
  std::vector<PairTurn> smooth;
  const std::vector<std::size_t> starts = pair_starts(sites);
  for (std::size_t p = 0; p + 1 < starts.size(); ++p) {
    const std::size_t first = starts[p], count = starts[p + 1] - first;
    const auto some_turns = std::span<const double>(turns).subspan(first, count);
    const auto [a, b] = pair_of(sites[first]);
    const double mean = mean_of_known(some_turns);
    if (mean < kSmooth && !has_sharp_stretch(cloud, std::span(sites).subspan(first, count), some_turns)) {
      smooth.push_back({a, b, mean});
    } else {
      mergers.keep_apart(a, b);
    }
  }
  std::stable_sort(smooth.begin(), smooth.end(), [](const PairTurn& s, const PairTurn& t) { return s.mean < t.mean; });
  bool merged = false;
  for (const PairTurn& pair : smooth) merged |= mergers.unite(pair.a, pair.b);
  for (int& label : labels) label = mergers.find(label);
  renumber(labels);
  return merged;
}

}  // namespace umtet
