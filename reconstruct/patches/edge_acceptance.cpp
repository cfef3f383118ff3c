#include "reconstruct/patches/edge_acceptance.h"

#include <algorithm>

#include "common/disjoint_sets.h"
#include "reconstruct/patches/patch_growing.h"

namespace umtet {
namespace {

using Border = SamplePatches::Border;

constexpr double kCorner = 3;  ///< spacings: patches that touch along less meet at a corner
constexpr int kRounds = 8;     ///< merging ends after two or three on all clouds of the tests

Border border_of(std::span<const BorderSite> sites, std::span<const SiteEvidence> evidence,
                 std::span<const char> accepted) {
  double angles = 0, known = 0;
  std::size_t yes = 0;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    yes += accepted[k] ? 1 : 0;
    if (evidence[k].count == 0) continue;
    angles += evidence[k].angle;
    ++known;
  }
  const auto [a, b] = pair_of(sites.front());
  return {a, b, static_cast<double>(sites.size()) * kLengthPerSite, known > 0 ? angles / known : 0,
          yes > 0 && 2 * yes >= sites.size()};
}

/// Borders of patches that touch. Samples of two sheets that pass each other closely are neighbours, but none of them
/// is beside both sheets.
std::vector<Border> borders_of(const PatchCloud& cloud, const std::vector<int>& labels, const EdgeThresholds& enough) {
  const std::vector<BorderSite> sites = border_sites(cloud, labels);
  const std::vector<SiteEvidence> evidence = evidence_at(cloud, labels, sites);
  const std::vector<char> accepted = accepted_sites(cloud, sites, evidence, enough);
  const std::vector<std::size_t> starts = pair_starts(sites);
  std::vector<Border> borders;
  for (std::size_t p = 0; p + 1 < starts.size(); ++p) {
    const std::size_t first = starts[p], count = starts[p + 1] - first;
    const auto here = std::span<const SiteEvidence>(evidence).subspan(first, count);
    const auto known = static_cast<std::size_t>(
        std::count_if(here.begin(), here.end(), [](const SiteEvidence& e) { return e.count > 0; }));
    if (2 * known < count) continue;
    borders.push_back(
        border_of(std::span(sites).subspan(first, count), here, std::span(accepted).subspan(first, count)));
  }
  return borders;
}

/// Merges across borders that are not sharp. @return true if any patches merged
bool merge_across(const std::vector<Border>& borders, std::vector<int>& labels) {
  const auto count = static_cast<std::size_t>(renumber(labels));
  struct Longest {
    double length = 0;
    int other = -1;
  };
  std::vector<Longest> longest(count);
  std::vector<char> has_edge(count);
  DisjointSets sets(count);
  for (const Border& border : borders) {
    const auto a = static_cast<std::size_t>(border.a), b = static_cast<std::size_t>(border.b);
    if (border.length > longest[a].length) longest[a] = {border.length, border.b};
    if (border.length > longest[b].length) longest[b] = {border.length, border.a};
    if (border.sharp) {
      has_edge[a] = has_edge[b] = 1;
    } else if (border.length >= kCorner) {
      sets.unite(border.a, border.b);
    }
  }
  for (std::size_t a = 0; a < count; ++a)
    if (!has_edge[a] && longest[a].other >= 0) sets.unite(static_cast<int>(a), longest[a].other);
  for (int& label : labels) label = sets.find(label);
  return static_cast<std::size_t>(renumber(labels)) < count;
}

}  // namespace

std::vector<Border> accept_edges(const PatchCloud& cloud, std::vector<int>& labels, const EdgeThresholds& enough) {
  renumber(labels);
  std::vector<Border> borders = borders_of(cloud, labels, enough);
  for (int round = 0; round < kRounds && merge_across(borders, labels); ++round)
    borders = borders_of(cloud, labels, enough);
  if (std::none_of(borders.begin(), borders.end(), [](const Border& border) { return border.sharp; })) {
    std::fill(labels.begin(), labels.end(), 0);
    borders.clear();
  }
  return borders;
}

}  // namespace umtet
