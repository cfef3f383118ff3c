#include "reconstruct/patches/edge_acceptance.h"

#include <algorithm>

#include "common/disjoint_sets.h"
#include "reconstruct/patches/patch_growing.h"

namespace umtet {
namespace {

using Border = SamplePatches::Border;

constexpr double kCorner = 3;   ///< spacings: patches that touch along less meet at a corner
constexpr double kEnough = .5;  ///< share of the sites of a sharp border that are accepted
constexpr double kHardly = .1;  ///< share of a border that is certainly not sharp
constexpr int kRounds = 20;     ///< on all clouds of the tests merging ends after five

/// A border and the share of its sites that are accepted.
struct JudgedBorder {
  Border border;
  double accepted = 0;
};

JudgedBorder judged(std::span<const BorderSite> sites, std::span<const SiteEvidence> evidence,
                    std::span<const char> accepted) {
  double angles = 0, known = 0, yes = 0;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    yes += accepted[k] ? 1 : 0;
    if (evidence[k].count == 0) continue;
    angles += evidence[k].angle;
    ++known;
  }
  const auto n = static_cast<double>(sites.size());
  const auto [a, b] = pair_of(sites.front());
  return {{a, b, n * kLengthPerSite, angles / std::max(1., known), yes >= kEnough * n}, yes / n};
}

/// Borders of patches that touch. Samples of two sheets that pass each other closely are neighbours, but none of them
/// is beside both sheets.
std::vector<JudgedBorder> judged_borders(const PatchCloud& cloud, const std::vector<int>& labels,
                                         const EdgeThresholds& enough) {
  const std::vector<BorderSite> sites = border_sites(cloud, labels);
  const std::vector<SiteEvidence> evidence = evidence_at(cloud, labels, sites);
  const std::vector<char> accepted = accepted_sites(cloud, sites, evidence, enough);
  const std::vector<std::size_t> starts = pair_starts(sites);
  std::vector<JudgedBorder> borders;
  for (std::size_t p = 0; p + 1 < starts.size(); ++p) {
    const std::size_t first = starts[p], count = starts[p + 1] - first;
    const auto here = std::span<const SiteEvidence>(evidence).subspan(first, count);
    const auto known = static_cast<std::size_t>(
        std::count_if(here.begin(), here.end(), [](const SiteEvidence& e) { return e.count > 0; }));
    if (2 * known < count) continue;
    borders.push_back(judged(std::span<const BorderSite>(sites).subspan(first, count), here,
                             std::span<const char>(accepted).subspan(first, count)));
  }
  return borders;
}

/// The border of a patch that speaks least for an edge, and its longest border; -1: none.
struct PatchBorders {
  int weakest = -1, longest = -1;
  bool has_edge = false;
};

std::vector<PatchBorders> borders_of_patches(const std::vector<JudgedBorder>& borders, std::size_t n_patches) {
  std::vector<PatchBorders> patches(n_patches);
  for (int k = 0; k < static_cast<int>(borders.size()); ++k) {
    const auto& [border, accepted] = borders[static_cast<std::size_t>(k)];
    for (const int p : {border.a, border.b}) {
      PatchBorders& patch = patches[static_cast<std::size_t>(p)];
      patch.has_edge |= border.sharp;
      if (patch.longest < 0 || border.length > borders[static_cast<std::size_t>(patch.longest)].border.length)
        patch.longest = k;
      if (border.length < kCorner) continue;
      if (patch.weakest < 0 || accepted < borders[static_cast<std::size_t>(patch.weakest)].accepted) patch.weakest = k;
    }
  }
  return patches;
}

/// Merges across borders that are certainly not sharp, and across others that are the weakest of both patches: the
/// evidence at the other borders of these patches improves when they are one. A patch that has no sharp border and
/// touches others at corners only merges across its longest border.
/// @return true if any patches merged
bool merge_across(const std::vector<JudgedBorder>& borders, std::vector<int>& labels) {
  const auto count = static_cast<std::size_t>(renumber(labels));
  const std::vector<PatchBorders> patches = borders_of_patches(borders, count);
  DisjointSets sets(count);
  for (int k = 0; k < static_cast<int>(borders.size()); ++k) {
    const auto& [border, accepted] = borders[static_cast<std::size_t>(k)];
    if (border.sharp || border.length < kCorner) continue;
    const bool is_weakest = patches[static_cast<std::size_t>(border.a)].weakest == k &&
                            patches[static_cast<std::size_t>(border.b)].weakest == k;
    if (accepted < kHardly || is_weakest) sets.unite(border.a, border.b);
  }
  for (const PatchBorders& patch : patches) {
    if (patch.has_edge || patch.weakest >= 0 || patch.longest < 0) continue;
    const Border& border = borders[static_cast<std::size_t>(patch.longest)].border;
    sets.unite(border.a, border.b);
  }
  for (int& label : labels) label = sets.find(label);
  return static_cast<std::size_t>(renumber(labels)) < count;
}

}  // namespace

std::vector<Border> accept_edges(const PatchCloud& cloud, std::vector<int>& labels, const EdgeThresholds& enough) {
  renumber(labels);
  std::vector<JudgedBorder> judged = judged_borders(cloud, labels, enough);
  for (int round = 0; round < kRounds && merge_across(judged, labels); ++round)
    judged = judged_borders(cloud, labels, enough);
  std::vector<Border> borders;
  for (const JudgedBorder& border : judged) borders.push_back(border.border);
  if (std::none_of(borders.begin(), borders.end(), [](const Border& border) { return border.sharp; })) {
    std::fill(labels.begin(), labels.end(), 0);
    borders.clear();
  }
  return borders;
}

}  // namespace umtet
