#include "pipeline/reports/input_judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace umtet {
namespace {

constexpr std::array<const char*, 7> kWords = {"missed", "guessed", "handles", "pieces", "distance", "volume", "genus"};

std::string at(const Vec3& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", x.x(), x.y(), x.z()); }

std::string counted(std::size_t n, const char* thing) { return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s"); }

void add_missed(const MeshMeasures& m, std::vector<InputDefect>& defects) {
  const SampleDistances& cloud = *m.cloud;
  if (cloud.n_beyond_h < kFewestBeyondH) return;
  const std::size_t n_samples = cloud.n_merged.value_or(m.n_points.value_or(1));
  const double deep = cloud.most_over_h;
  const double share = static_cast<double>(cloud.n_beyond_h) / static_cast<double>(n_samples);
  defects.push_back({InputDefectKind::Missed, deep, deep <= kDeeplyMissed || share <= kFewMissed,
                     fmt::format("{} ({:.2g} % of all) are farther than h from the mesh, up to {:.2g} h at {}",
                                 counted(cloud.n_beyond_h, "sample"), 100 * share, deep, at(cloud.most_at))});
}

void add_guesses(const SupportReport& support, std::vector<InputDefect>& defects) {
  const double guessed = support.unsupported_area_fraction;
  const bool is_much = guessed > kMuchGuessed;
  if (is_much) {
    const std::string where =
        support.closed_holes.empty() ? "" : ", the largest part at " + at(support.closed_holes.front().centre);
    defects.push_back({InputDefectKind::Guessed, guessed, guessed <= kMostlyGuessed,
                       fmt::format("{:.0f} % of the boundary is a guess: no sample is within {:.3g} of it{}",
                                   100 * guessed, support.radius, where)});
  }
  // Where little is guessed, a gap across a limb can be the reason, and the guess is right.
  if (const int n = support.n_guessed_handles; n > 0) {
    defects.push_back({InputDefectKind::Handles, static_cast<double>(n), !is_much,
                       fmt::format("no sample supports {}", counted(static_cast<std::size_t>(n), "handle"))});
  }
  if (const std::size_t n = support.n_guessed_pieces; n > 0) {
    defects.push_back({InputDefectKind::Pieces, static_cast<double>(n), !is_much,
                       fmt::format("no sample is near {} of the boundary", counted(n, "piece"))});
  }
}

void add_distances(const TriangleDistances& d, double h, std::vector<InputDefect>& defects) {
  const bool is_back = d.max_back > d.max;
  const double deep = std::max(d.max, d.max_back) / h;
  if (deep <= 1) return;
  defects.push_back({InputDefectKind::Distance, deep, deep <= kDeeplyMissed,
                     is_back ? fmt::format("the triangles are up to {:.2g} h from the mesh, most of all at {}", deep,
                                           at(d.farthest_back))
                             : fmt::format("the mesh is up to {:.2g} h from the triangles, most of all at {}", deep,
                                           at(d.farthest))});
}

}  // namespace

const char* to_string(InputDefectKind kind) { return kWords.at(static_cast<std::size_t>(kind)); }

std::optional<InputDefectKind> input_defect_kind_of(const std::string& word) {
  const auto* found = std::find(kWords.begin(), kWords.end(), word);
  if (found == kWords.end()) return std::nullopt;
  return static_cast<InputDefectKind>(found - kWords.begin());
}

std::vector<InputDefect> input_defects(const MeshMeasures& m) {
  std::vector<InputDefect> defects;
  if (m.cloud && !m.triangles) add_missed(m, defects);
  if (m.domain.support && !m.triangles) add_guesses(*m.domain.support, defects);
  if (m.triangles) add_distances(*m.triangles, m.mesh.h, defects);
  return defects;
}

}  // namespace umtet
