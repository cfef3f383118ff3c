#include "body/fidelity/input_judgement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/formatted.h"

namespace umtet {
namespace {

constexpr std::array<const char*, 11> kWords = {"missed", "guessed", "handles", "pieces", "distance", "volume",
                                                "genus",  "voxels",  "edges",   "noise",  "sides"};

std::string at(const Vec3& x) { return formatted("(%.6g, %.6g, %.6g)", x.x(), x.y(), x.z()); }

std::string counted(std::size_t n, const char* thing) { return formatted("%zu %s%s", n, thing, n == 1 ? "" : "s"); }

void add_missed(const MeshMeasures& m, std::vector<InputDefect>& defects) {
  const SampleDistances& cloud = *m.cloud;
  if (cloud.n_beyond_h < kFewestBeyondH) return;
  const std::size_t n_samples = cloud.n_merged.value_or(m.n_points.value_or(1));
  const double deep = cloud.most_over_h;
  const double share = static_cast<double>(cloud.n_beyond_h) / static_cast<double>(n_samples);
  defects.push_back(
      {InputDefectKind::Missed, deep, deep <= kDeeplyMissed || share <= kFewMissed,
       formatted("%s (%.2g %% of all) are farther than h from the mesh, up to %.2g h at %s",
                 counted(cloud.n_beyond_h, "sample").c_str(), 100 * share, deep, at(cloud.most_at).c_str())});
}

/// Samples cannot tell what is finer than their noise, so nothing else shows whether psi has lost it.
void add_noise(const MeshMeasures& m, std::vector<InputDefect>& defects) {
  const double noise = m.cloud->noise.value_or(0) / m.mesh.h;
  if (!(noise >= kMuchNoise)) return;
  defects.push_back(
      {InputDefectKind::Noise, noise, true,
       formatted("the noise of the samples is %.2g h: walls, gaps and handles thinner than a few h may be "
                 "lost or invented",
                 noise)});
}

/// Given normals decide on a scan with large holes, although nothing else does. Where many normals were turned, they
/// contradict something.
void add_sides(const InputFacts& facts, std::vector<InputDefect>& defects) {
  const double guessed = std::min(1., facts.doubtful);
  const bool were_turned = facts.turned > kMuchGuessed;
  if (guessed <= kMuchGuessed || (facts.normals_given && !were_turned)) return;
  defects.push_back({InputDefectKind::Sides, guessed, guessed <= kMostlyGuessed || !were_turned,
                     formatted("the outward side of %.0f %% of the samples is a guess", 100 * guessed)});
}

void add_guesses(const SupportReport& support, std::vector<InputDefect>& defects) {
  const double guessed = support.unsupported_area_fraction;
  const bool is_much = guessed > kMuchGuessed;
  if (is_much) {
    const std::string where =
        support.closed_holes.empty() ? "" : ", the largest part at " + at(support.closed_holes.front().centre);
    defects.push_back({InputDefectKind::Guessed, guessed, guessed <= kMostlyGuessed,
                       formatted("%.0f %% of the boundary is a guess: no sample is within %.3g of it%s", 100 * guessed,
                                 support.radius, where.c_str())});
  }
  // Where little is guessed, a gap across a limb can be the reason, and the guess is right.
  if (const int n = support.n_guessed_handles; n > 0) {
    defects.push_back({InputDefectKind::Handles, static_cast<double>(n), !is_much,
                       formatted("no sample supports %s", counted(static_cast<std::size_t>(n), "handle").c_str())});
  }
  if (const std::size_t n = support.n_guessed_pieces; n > 0) {
    defects.push_back({InputDefectKind::Pieces, static_cast<double>(n), !is_much,
                       formatted("no sample is near %s of the boundary", counted(n, "piece").c_str())});
  }
}

/// Where the triangles are open, the mesh goes on without them: only the way back counts.
void add_distances(const TriangleDistances& d, bool is_closed, std::vector<InputDefect>& defects) {
  const bool is_back = !is_closed || d.max_back_over_h > d.max_over_h;
  const double deep = is_back ? d.max_back_over_h : d.max_over_h;
  if (deep <= 1) return;
  defects.push_back({InputDefectKind::Distance, deep, deep <= kDeeplyMissed,
                     is_back ? formatted("the triangles are up to %.2g h from the mesh, most of all at %s", deep,
                                         at(d.farthest_back).c_str())
                             : formatted("the mesh is up to %.2g h from the triangles, most of all at %s", deep,
                                         at(d.farthest).c_str())});
}

/// Flat faces between vertices on a curved psi = 0 explain gap_over_volume.
void add_volume(double given, double made, double explained, std::vector<InputDefect>& defects) {
  const double off = std::abs(made - given) / std::abs(given), unexplained = off - explained;
  if (unexplained <= kVolumeNamed) return;
  defects.push_back({InputDefectKind::Volume, unexplained, unexplained <= kVolumeFails,
                     formatted("the volume is %.6g, and %.6g is given (%+.2g %%)", made, given,
                               100 * (made - given) / std::abs(given))});
}

void add_topology(std::size_t given_pieces, long given_genus, const TriangleBody& made,
                  std::vector<InputDefect>& defects) {
  if (made.n_pieces != given_pieces) {
    defects.push_back(
        {InputDefectKind::Pieces, std::abs(static_cast<double>(made.n_pieces) - static_cast<double>(given_pieces)),
         false,
         formatted("the boundary has %s, and %zu are given", counted(made.n_pieces, "piece").c_str(), given_pieces)});
  }
  if (made.genus() != given_genus) {
    defects.push_back({InputDefectKind::Genus, std::abs(static_cast<double>(made.genus() - given_genus)), false,
                       formatted("the boundary has genus %ld, and %ld is given", made.genus(), given_genus)});
  }
}

void add_edges(const SharpEdgeReport& edges, std::vector<InputDefect>& defects) {
  if (edges.rounded_length <= kFewRounded * edges.length) return;
  defects.push_back({InputDefectKind::Edges, edges.max_over_h, true,
                     formatted("sharp edges are rounded over a length of %.3g of %.3g, by up to %.2g h at %s",
                               edges.rounded_length, edges.length, edges.max_over_h, at(edges.farthest).c_str())});
}

void add_triangles(const MeshMeasures& m, std::vector<InputDefect>& defects) {
  const TriangleDistances& d = *m.triangles;
  const bool is_closed = d.body && d.body->is_closed;
  if (!is_closed && m.domain.support) add_guesses(*m.domain.support, defects);
  add_distances(d, is_closed, defects);
  if (is_closed) {
    add_volume(d.body->volume, std::abs(d.mesh.volume), m.mesh.boundary.gap_over_volume.value_or(0), defects);
  }
  if (is_closed && d.body->is_manifold) add_topology(d.body->n_pieces, d.body->genus(), d.mesh, defects);
  if (d.edges) add_edges(*d.edges, defects);
}

std::string text_of(const PieceCount& count) {
  return count.by_points == count.by_faces ? formatted("%zu", count.by_points)
                                           : formatted("%zu to %zu", count.by_points, count.by_faces);
}

/// @param explained  share of the volume between flat faces and a curved psi = 0: what h takes is no fault of psi
void add_labels(const LabelVolumeReport& r, double explained, std::vector<InputDefect>& defects) {
  const auto add_count = [&](const PieceCount& given, std::size_t made, const char* thing) {
    if (given.allows(made)) return;
    const double off = made < given.by_points ? static_cast<double>(given.by_points - made)
                                              : static_cast<double>(made - given.by_faces);
    defects.push_back(
        {InputDefectKind::Pieces, off, false,
         formatted("the mesh has %s, and the voxels have %s", counted(made, thing).c_str(), text_of(given).c_str())});
  };
  add_count(r.pieces, r.pieces_of_mesh, "piece");
  add_count(r.cavities, r.cavities_of_mesh, "inner wall");
  const double off = r.volume_of_mesh / r.volume_of_voxels - 1;
  if (std::abs(off) > kVoxelsNamed + std::min(explained, kVoxelsNamed)) {
    defects.push_back({InputDefectKind::Volume, std::abs(off), std::abs(off) <= kVoxelsFail,
                       formatted("the volume is %.6g, and the voxels have %.6g (%+.2g %%)", r.volume_of_mesh,
                                 r.volume_of_voxels, 100 * off)});
  }
  if (r.n_changed_far == 0) return;
  const double share = static_cast<double>(r.n_changed_far) / static_cast<double>(r.n_voxels);
  defects.push_back(
      {InputDefectKind::Voxels, share, share <= kFewChanged,
       formatted("%s changed sides by more than half a voxel%s", counted(r.n_changed_far, "voxel").c_str(),
                 (r.farthest_at ? ", most of all at " + at(*r.farthest_at) : std::string()).c_str())});
}

}  // namespace

const char* to_string(InputDefectKind kind) { return kWords.at(static_cast<std::size_t>(kind)); }

std::vector<InputDefect> input_defects(const MeshMeasures& m) {
  std::vector<InputDefect> defects;
  if (m.triangles) {
    add_triangles(m, defects);
    return defects;
  }
  if (m.labels) add_labels(*m.labels, m.mesh.boundary.gap_over_volume.value_or(0), defects);
  if (m.cloud) add_missed(m, defects);
  if (m.domain.support) add_guesses(*m.domain.support, defects);
  if (m.cloud) add_noise(m, defects);
  if (m.cloud && m.input) add_sides(*m.input, defects);
  return defects;
}

}  // namespace umtet
