#include "reconstruct/patches/edge_acceptance.h"

#include <algorithm>
#include <set>
#include <utility>

#include "reconstruct/patches/patch_growing.h"
#include "reconstruct/patches/patch_mergers.h"

namespace umtet {
namespace {

using Border = SamplePatches::Border;

constexpr double kCorner = 3;   ///< spacings: patches that touch along less meet at a corner
constexpr double kEnough = .5;  ///< share of the sites of a sharp border that are accepted
constexpr double kHardly = .1;  ///< share of a border that is certainly not sharp
constexpr int kRounds = 20;     ///< a bound on the time

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

/// The borders across which patches merge, those that speak least for an edge first. A patch that has no sharp border
/// and touches others at corners only merges across its longest border.
std::vector<JudgedBorder> weak_borders(const std::vector<JudgedBorder>& borders, std::size_t n_patches) {
  std::vector<JudgedBorder> weak;
  std::vector<char> is_settled(n_patches);
  for (const JudgedBorder& judged : borders) {
    const auto& [border, accepted] = judged;
    if (border.sharp || border.length >= kCorner)
      is_settled[static_cast<std::size_t>(border.a)] = is_settled[static_cast<std::size_t>(border.b)] = 1;
    if (!border.sharp && border.length >= kCorner) weak.push_back(judged);
  }
  for (const JudgedBorder& judged : borders) {
    const auto a = static_cast<std::size_t>(judged.border.a), b = static_cast<std::size_t>(judged.border.b);
    if (!is_settled[a] || !is_settled[b]) weak.push_back(judged);
  }
  std::stable_sort(weak.begin(), weak.end(), [](const JudgedBorder& s, const JudgedBorder& t) {
    return s.accepted != t.accepted ? s.accepted < t.accepted : s.border.length > t.border.length;
  });
  return weak;
}

/// Patches with a sharp border between them before anything merged. They stay apart: otherwise all that is near a badly
/// sampled detail would become one patch, step by step.
class SharpPairs {
 public:
  SharpPairs(const std::vector<JudgedBorder>& borders, const std::vector<int>& labels) {
    std::vector<std::size_t> first;  // sample of each patch
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (static_cast<std::size_t>(labels[i]) == first.size()) first.push_back(i);
    for (const JudgedBorder& judged : borders)
      if (judged.border.sharp)
        pairs_.emplace_back(first[static_cast<std::size_t>(judged.border.a)],
                            first[static_cast<std::size_t>(judged.border.b)]);
  }
  /// The pairs by their present labels.
  std::set<std::pair<int, int>> now(const std::vector<int>& labels) const {
    std::set<std::pair<int, int>> result;
    for (const auto& [i, j] : pairs_) result.insert(std::minmax(labels[i], labels[j]));
    return result;
  }

 private:
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
};

/// Merges patches across borders, the weakest first. Across borders that may be edges no patch merges twice, because
/// the evidence at its other borders changes. @return true if any patches merged
bool merge_across(const std::vector<JudgedBorder>& borders, const SharpPairs& sharp, std::vector<int>& labels) {
  const auto count = static_cast<std::size_t>(renumber(labels));
  PatchMergers mergers(count);
  for (const auto& [a, b] : sharp.now(labels)) mergers.keep_apart(a, b);
  for (const JudgedBorder& judged : borders)
    if (judged.border.sharp) mergers.keep_apart(judged.border.a, judged.border.b);
  std::vector<char> has_merged(count);
  for (const auto& [border, accepted] : weak_borders(borders, count)) {
    const auto a = static_cast<std::size_t>(border.a), b = static_cast<std::size_t>(border.b);
    if (accepted >= kHardly && (has_merged[a] || has_merged[b])) continue;
    if (mergers.unite(border.a, border.b)) has_merged[a] = has_merged[b] = 1;
  }
  for (int& label : labels) label = mergers.find(label);
  return static_cast<std::size_t>(renumber(labels)) < count;
}

}  // namespace

std::vector<Border> accept_edges(const PatchCloud& cloud, std::vector<int>& labels, const EdgeThresholds& enough) {
  renumber(labels);
  std::vector<JudgedBorder> judged = judged_borders(cloud, labels, enough);
  const SharpPairs sharp(judged, labels);
  for (int round = 0; round < kRounds && merge_across(judged, sharp, labels); ++round)
    judged = judged_borders(cloud, labels, enough);
  std::vector<Border> borders;
  borders.reserve(judged.size());
  for (const JudgedBorder& border : judged) borders.push_back(border.border);
  if (std::none_of(borders.begin(), borders.end(), [](const Border& border) { return border.sharp; })) {
    std::fill(labels.begin(), labels.end(), 0);
    borders.clear();
  }
  return borders;
}

}  // namespace umtet
