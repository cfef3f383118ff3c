#include "body/fidelity/mesh_defect.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace umtet {
namespace {

// In the order of DefectKind.
constexpr std::array<const char*, 8> kDefectWords = {"folded", "off",      "filled", "cut",
                                                     "thin",   "topology", "missed", "edges"};

bool is_worse(const MeshDefect& a, const MeshDefect& b) {
  return std::tuple(is_small(b), a.off_over_h) > std::tuple(is_small(a), b.off_over_h);
}

}  // namespace

const char* to_string(DefectKind kind) { return kDefectWords.at(static_cast<std::size_t>(kind)); }

std::optional<DefectKind> defect_kind_of(const std::string& word) {
  const auto* at = std::find(kDefectWords.begin(), kDefectWords.end(), word);
  if (at == kDefectWords.end()) return std::nullopt;
  return static_cast<DefectKind>(at - kDefectWords.begin());
}

bool is_small(const MeshDefect& defect) {
  if (defect.off_over_h > kSmallLoss) return false;
  const bool is_finer_than_h = defect.feature_over_h && *defect.feature_over_h < kLeastEdgesAcross;
  if (is_finer_than_h && (defect.kind == DefectKind::Thin || defect.off_over_h <= kSmallOff)) return true;
  return defect.kind != DefectKind::Topology && defect.size_over_h <= kSmallSize;
}

std::size_t DefectReport::n() const {
  std::size_t sum = 0;
  for (const OfKind& k : kinds) sum += k.n;
  return sum;
}

DefectReport report_on(std::vector<MeshDefect>& defects) {
  std::stable_sort(defects.begin(), defects.end(), is_worse);
  DefectReport report;
  for (std::size_t k = 0; k < kDefectWords.size(); ++k) {
    DefectReport::OfKind of_kind{static_cast<DefectKind>(k), 0, 0, {}, 0};
    for (const MeshDefect& defect : defects) {
      if (defect.kind != of_kind.kind) continue;
      if (of_kind.n == 0) of_kind.worst = defect;
      ++of_kind.n;
      of_kind.n_small += is_small(defect) ? 1 : 0;
      of_kind.max_off_over_h = std::max(of_kind.max_off_over_h, defect.off_over_h);
    }
    if (of_kind.n > 0) report.kinds.push_back(of_kind);
  }
  const auto n_listed = static_cast<std::ptrdiff_t>(std::min(defects.size(), kListedDefects));
  report.listed.assign(defects.begin(), defects.begin() + n_listed);
  return report;
}

}  // namespace umtet
