#include "pipeline/reports/certificate_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pipeline/reports/region_lines.h"

namespace umtet {
namespace {

/// Returns "-" if there is no number.
std::string show(const std::optional<double>& value, const char* format) {
  if (!value || std::isnan(*value)) return "-";
  return fmt::format(fmt::runtime(format), *value);
}

std::string thousands(std::size_t n) {
  std::string s = std::to_string(n);
  for (int k = static_cast<int>(s.size()) - 3; k > 0; k -= 3) s.insert(s.begin() + k, ',');
  return s;
}

std::string verdict_lines(const Verdict& verdict, const std::string& judgements, const std::optional<Blame>& blame) {
  std::string out = fmt::format("verdict   {} ({})\n", verdict.word(), judgements);
  if (!verdict.accept.empty()) out += fmt::format("          in force: --accept {}\n", verdict.accept);
  for (const std::string& what : verdict.accepted) out += fmt::format("          accepted: {}\n", what);
  for (const std::string& what : verdict.defects) out += fmt::format("          defect: {}\n", what);
  for (const std::string& reason : verdict.reasons) out += fmt::format("          - {}\n", reason);
  if (blame) out += fmt::format("blame     {}: {}; try {}\n", blame->stage, blame->number, blame->remedy);
  return out;
}

/// Returns the three judgements. A formula is its own input, so the last two judgements coincide.
std::string judgements(const Verdict& v, bool has_input) {
  std::string out = v.is_valid ? "valid" : "NOT valid";
  out += v.fits_psi ? ", fits psi" : ", does NOT fit psi";
  if (has_input) out += v.fits_input ? ", fits the input" : ", does NOT fit the input";
  return out;
}

std::string boundary_line(const MeshCertificate::Boundary& b) {
  const int n = b.components;
  std::string line = b.closed_manifold
                         ? fmt::format("closed manifold, {} component{}, genus {}", n, n == 1 ? "" : "s", b.genus)
                         : fmt::format("NOT a closed manifold, {} component{}", n, n == 1 ? "" : "s");
  line += b.n_self_intersections > 0 ? ", NOT free of self-intersections" : ", no self-intersections";
  if (b.max_vertex_distance_over_h) {
    line += fmt::format("; off psi = 0: vertices {} h, face centres {} h, {} of the volume; cos(normals) >= {}",
                        show(b.max_vertex_distance_over_h, "{:.1e}"), show(b.max_centroid_distance_over_h, "{:.3f}"),
                        show(b.gap_over_volume, "{:.1e}"), show(b.min_cos_normal, "{:.3f}"));
  }
  return line;
}

/// Returns the lines with counts, quality and boundary.
std::string mesh_lines(const MeshCertificate& c, const std::string& unit, std::optional<std::int64_t> n_tets_asked) {
  const MeshCertificate::Quality& q = c.quality;
  const std::string asked =
      n_tets_asked ? fmt::format(" (requested: {})", thousands(static_cast<std::size_t>(*n_tets_asked))) : "";
  std::string out = fmt::format("mesh      {} tets{}, {} vertices, {} boundary faces; h = {}{}, volume {}{}\n",
                                thousands(c.n_tets), asked, thousands(c.n_vertices), thousands(c.boundary.n_faces),
                                show(c.h, "{:.5g}"), unit, show(c.volume, "{:.6g}"), unit.empty() ? "" : unit + "^3");
  out += fmt::format("quality   mean ratio min {} | .1 % {} | 1 % {} | mean {}\n", show(q.min, "{:.4f}"),
                     show(q.p001, "{:.4f}"), show(q.p01, "{:.4f}"), show(q.mean, "{:.4f}"));
  out += fmt::format("          dihedral angles {} to {} degrees, {} inverted tets\n",
                     show(q.dihedral_min_deg, "{:.1f}"), show(q.dihedral_max_deg, "{:.1f}"), q.n_inverted);
  return out + "boundary  " + boundary_line(c.boundary) + "\n";
}

/// Compares the edges of a graded mesh with the requested sizes; empty for other meshes.
std::string sizes_line(const std::optional<SizesReport>& s, const std::string& unit) {
  if (!s) return "";
  return fmt::format(
      "sizes     {:.4g} to {:.4g}{} requested; edges relative to that: 1 % {:.2f} | 50 % {:.2f} | 99 % {:.2f}; "
      "boundary edges "
      "{:.4g} to {:.4g}\n",
      s->least_asked, s->greatest_asked, unit, s->p01, s->p50, s->p99, s->shortest_boundary_edge,
      s->longest_boundary_edge);
}

/// Returns the lines on tets of second order; empty for other meshes.
std::string second_order_lines(const std::optional<SecondOrderReport>& report) {
  if (!report) return "";
  const SecondOrderCertificate& s = report->certificate;
  std::string out = fmt::format("order 2   {} nodes, volume {}; least Jacobian {} of its mean, {} not positive\n",
                                thousands(s.n_nodes), show(s.volume, "{:.9g}"),
                                show(s.min_scaled_jacobian_lower, "{:.3f}"), s.n_nonpositive_jacobians);
  if (s.max_mid_side_distance_over_h) {
    out += fmt::format("          off psi = 0: mid-sides {} h, faces {} h (rms {} h)",
                       show(s.max_mid_side_distance_over_h, "{:.1e}"), show(s.max_face_distance_over_h, "{:.1e}"),
                       show(s.rms_face_distance_over_h, "{:.1e}"));
    const std::size_t n = s.n_mid_sides_off_surface;
    out += n > 0 ? fmt::format("; {} mid-sides are NOT on it\n", thousands(n)) : "\n";
  }
  return out;
}

std::string domain_line(const ZeroSetReport& d) {
  const std::size_t n = d.components_of_zero_set;
  std::string out =
      fmt::format("domain    psi = 0 has {} piece{}, {} dropped", n, n == 1 ? "" : "s", d.components_dropped.size());
  if (d.support) {
    out += fmt::format("; {:.2f} % of the surface without samples near it", 100 * d.support->unsupported_area_fraction);
  }
  return out + "\n";
}

/// Returns the line on holes that were closed without samples; empty if there are none.
std::string holes_line(const std::optional<SupportReport>& support, const std::string& unit) {
  if (!support || support->closed_holes.empty()) return "";
  const std::size_t n = support->n_closed_holes;
  double part = 0, deepest = 0;
  for (const ClosedHole& hole : support->closed_holes) {
    part += hole.area_fraction;
    deepest = std::max(deepest, hole.deepest);
  }
  return fmt::format(
      "holes     {} closed where there are no samples: {}{:.3g} % of the boundary, up to {:.3g}{} from a sample\n", n,
      n > support->closed_holes.size() ? "over " : "", 100 * part, deepest, unit);
}

std::string cloud_line(const MeshMeasures& m, const std::string& unit) {
  if (!m.cloud) return "";
  const SampleDistances& d = *m.cloud;
  const double h = m.mesh.h;
  const std::optional<double> noise = d.noise ? std::optional(*d.noise / h) : std::nullopt;
  const std::string merged = d.n_merged ? fmt::format(", means of {}", thousands(*d.n_merged)) : "";
  return fmt::format("cloud     {} samples{}, noise {} h; distance to the mesh rms {} ({} h), 99 % {} h, max {} h\n",
                     thousands(m.n_points.value_or(0)), merged, show(noise, "{:.3f}"), show(d.rms, "{:.3g}") + unit,
                     show(d.rms / h, "{:.4f}"), show(d.p99 / h, "{:.4f}"), show(d.max / h, "{:.4f}"));
}

/// Returns the line on the distances between the mesh and the given triangles; empty without triangles.
std::string triangles_line(const MeshMeasures& m, const std::string& unit) {
  if (!m.triangles) return "";
  const TriangleDistances& d = *m.triangles;
  const double h = m.mesh.h;
  const std::string edges =
      d.edges ? fmt::format(
                    "edges     {} sharp edges between {} patches, {} corners; length {}, of which {} is rounded by up "
                    "to {} h\n",
                    d.edges->n_curves, d.edges->n_patches, d.edges->n_corners, show(d.edges->length, "{:.4g}") + unit,
                    show(d.edges->rounded_length, "{:.4g}") + unit, show(d.edges->max_over_h, "{:.2f}"))
              : "";
  return fmt::format(
             "triangles {} bound the body; distance from the mesh to them rms {} ({} h), max {} h; from them to the "
             "mesh rms "
             "{} ({} h), max {} h\n",
             thousands(d.n_triangles), show(d.rms, "{:.3g}") + unit, show(d.rms / h, "{:.4f}"),
             show(d.max_over_h, "{:.3f}"), show(d.rms_back, "{:.3g}") + unit, show(d.rms_back / h, "{:.4f}"),
             show(d.max_back_over_h, "{:.3f}")) +
         edges;
}

std::string counted(std::size_t n, const char* one, const char* many) {
  return fmt::format("{} {}", thousands(n), n == 1 ? one : many);
}

/// Returns the line on the sharp edges of the body; empty for a smooth body.
std::string features_line(const std::optional<FeatureReport>& f) {
  if (!f) return "";
  std::string out = "edges     " + counted(f->n_curves, "sharp edge", "sharp edges") + ", " +
                    counted(f->n_corners, "corner", "corners") + ", " + counted(f->n_patches, "patch", "patches");
  out += f->has_all() ? ": all in the mesh"
                      : fmt::format(": the mesh lacks {}, {} and {:.3g} % of their length",
                                    counted(f->n_missed_curves, "edge", "edges"),
                                    counted(f->n_missed_corners, "corner", "corners"),
                                    f->length > 0 ? 100 * f->missed_length / f->length : 0);
  if (f->n_curves > f->n_missed_curves) {
    out += fmt::format("; off them: vertices {:.1e} h, faces' angles {:.2g} degrees; best Q of their wedges {:.2f}",
                       f->max_vertex_over_h, f->max_angle_off_deg, f->wedge_quality);
  }
  return out + "\n";
}

std::string pieces_text(const PieceCount& count) {
  return count.by_points == count.by_faces ? fmt::format("{}", count.by_points)
                                           : fmt::format("{} to {}", count.by_points, count.by_faces);
}

/// Compares the mesh with the voxels of a segmentation; empty without voxels.
std::string labels_line(const MeshMeasures& m, const std::string& unit) {
  if (!m.labels) return "";
  const LabelVolumeReport& r = *m.labels;
  return fmt::format(
      "voxels    {} of volume {}, the mesh {:+.2f} %; pieces {}, the mesh {}; {} voxel{} changed sides, {} by more "
      "than "
      "half a voxel, the farthest {:.2g} voxels\n",
      thousands(r.n_voxels), show(r.volume_of_voxels, "{:.6g}") + unit,
      100 * (r.volume_of_mesh / r.volume_of_voxels - 1), pieces_text(r.pieces), r.pieces_of_mesh, r.n_changed,
      r.n_changed == 1 ? "" : "s", r.n_changed_far, r.farthest_changed);
}

/// Returns the line on missed samples; empty if there are none.
std::string missed_line(const MeshMeasures& m, const std::string& unit) {
  if (!m.cloud || m.cloud->missed.empty()) return "";
  const std::size_t n = m.cloud->n_missed_places;
  const MissedPlace& worst = m.cloud->missed.front();
  return fmt::format(
      "missed    {} place{} where samples are farther from the mesh than {:.3g}{}; the worst, {} samples, up to {:.2g} "
      "h "
      "at ({:.4g}, {:.4g}, {:.4g})\n",
      n, n == 1 ? "" : "s", m.cloud->missed_beyond, unit, thousands(worst.n_samples), worst.distance / m.mesh.h,
      worst.farthest.x(), worst.farthest.y(), worst.farthest.z());
}

/// Returns the line on places that are thinner than the mesh can show; empty if there are none.
std::string thin_line(const ResolutionReport& r) {
  if (!r.too_thin || r.too_thin->empty()) return "";
  const std::size_t n = r.too_thin->size();
  const ThinPlace& worst = r.too_thin->front();
  return fmt::format("thin      {} place{} thinner than h can show, the worst ({}, {:.3g}) needs h = {:.3g}\n", n,
                     n == 1 ? " is" : "s are", worst.is_gap ? "gap" : "body", worst.thickness, worst.h_needed);
}

/// Returns the line on defects, where the mesh is not psi = 0; empty if there are none.
std::string defects_line(const DefectReport& defects) {
  if (defects.empty()) return "";
  std::vector<std::string> kinds;
  for (const DefectReport::OfKind& k : defects.kinds) {
    kinds.push_back(fmt::format("{} {} (up to {:.2g} h)", k.n, to_string(k.kind), k.max_off_over_h));
  }
  const std::size_t n = defects.n();
  std::size_t n_small = 0;
  for (const DefectReport::OfKind& k : defects.kinds) n_small += k.n_small;
  return fmt::format("defects   {} where the mesh is not psi = 0, {} of them small: {}\n", n, n_small,
                     fmt::join(kinds, ", "));
}

std::string time_line(const std::optional<CertificateRun>& run) {
  if (!run) return "";
  std::string out = "time     ";
  for (const auto& [section, t] : run->seconds) out += fmt::format(" {} {:.2f} s,", section, t);
  return out + fmt::format(" peak memory {} MB\n", show(run->peak_memory_MB, "{:.0f}"));
}

/// Returns what was meshed: "one closed body of genus 1".
std::string body_text(const MeshCertificate::Boundary& b) {
  if (!b.closed_manifold) return "a boundary that is NOT a closed manifold";
  if (b.components == 1)
    return b.genus == 0 ? "one body without handles" : fmt::format("one body of genus {}", b.genus);
  return fmt::format("{} closed surfaces, genus {}", b.components, b.genus);
}

/// Returns the cause of a failure, else the first doubt, and the number of the others.
std::string doubts_line(const Certificate& c) {
  const Verdict& v = c.verdict;
  const std::size_t n_holes = c.measured.domain.support ? c.measured.domain.support->n_closed_holes : 0;
  std::vector<std::string> doubts = v.reasons;
  for (const std::string& what : v.defects) doubts.push_back(what);
  for (const std::string& what : v.accepted) doubts.push_back("accepted: " + what);
  if (n_holes > 0) doubts.push_back(counted(n_holes, "hole", "holes") + " closed where there are no samples");
  if (c.measured.cloud && c.measured.cloud->n_missed_places > 0)
    doubts.push_back("samples missed at " + counted(c.measured.cloud->n_missed_places, "place", "places"));
  const auto others = [](std::size_t n) {
    return n == 0 ? std::string() : fmt::format(" ({} more: -v)", thousands(n));
  };
  if (c.blame) {
    return fmt::format("blame     {}: {}; try {}{}\n", c.blame->stage, c.blame->number, c.blame->remedy,
                       doubts.empty() ? "" : fmt::format(" ({}: -v)", counted(doubts.size(), "reason", "reasons")));
  }
  if (doubts.empty()) return "doubts    none\n";
  return "doubts    " + doubts.front() + others(doubts.size() - 1) + "\n";
}

std::string suffix(const std::optional<std::string>& units) { return units ? " " + *units : ""; }

}  // namespace

std::string short_summary(const Certificate& c) {
  const std::string unit = suffix(c.units);
  const MeshMeasures& m = c.measured;
  const std::string judged = c.verdict.passes() ? "" : " (" + judgements(c.verdict, has_input(m)) + ")";
  const std::string asked =
      c.n_tets_asked ? fmt::format(" (requested: {})", thousands(static_cast<std::size_t>(*c.n_tets_asked))) : "";
  std::string out =
      fmt::format("verdict   {}{}: {} tets{}, h = {}{}, {}, volume {}{}\n", c.verdict.word(), judged,
                  thousands(m.mesh.n_tets), asked, show(m.mesh.h, "{:.4g}"), unit, body_text(m.mesh.boundary),
                  show(m.mesh.volume, "{:.5g}"), unit.empty() ? "" : unit + "^3");
  if (!c.verdict.accept.empty()) out += fmt::format("          in force: --accept {}\n", c.verdict.accept);
  out += fmt::format("quality   mean ratio at least {}, dihedral angles {} to {} degrees",
                     show(m.mesh.quality.min, "{:.3f}"), show(m.mesh.quality.dihedral_min_deg, "{:.0f}"),
                     show(m.mesh.quality.dihedral_max_deg, "{:.0f}"));
  if (m.cloud) {
    out += fmt::format("; 99 % of the samples within {} h of the mesh", show(m.cloud->p99 / m.mesh.h, "{:.2g}"));
  } else if (m.mesh.boundary.max_centroid_distance_over_h) {
    out += fmt::format("; faces within {} h of psi = 0", show(m.mesh.boundary.max_centroid_distance_over_h, "{:.2g}"));
  }
  return out + "\n" + doubts_line(c);
}

std::string summary(const Certificate& c) {
  const std::string unit = suffix(c.units);
  const MeshMeasures& m = c.measured;
  return verdict_lines(c.verdict, judgements(c.verdict, has_input(m)), c.blame) +
         mesh_lines(m.mesh, unit, c.n_tets_asked) + sizes_line(m.sizes, unit) + second_order_lines(m.second_order) +
         domain_line(m.domain) + holes_line(m.domain.support, unit) + cloud_line(m, unit) + triangles_line(m, unit) +
         features_line(m.features) + labels_line(m, unit) + missed_line(m, unit) + thin_line(m.resolution) +
         defects_line(m.defects) + time_line(c.run);
}

std::string summary(const MeshCheck& c) {
  const std::string judged = c.defects ? judgements(c.verdict, false) : c.is_valid ? "valid" : "NOT valid";
  return verdict_lines(c.verdict, judged, {}) + mesh_lines(c.mesh, suffix(c.units), {}) +
         (c.regions ? region_lines(c.regions->certificate, c.regions->file.names, false) : "") +
         second_order_lines(c.second_order) + holes_line(c.support, suffix(c.units)) +
         (c.defects ? defects_line(*c.defects) : "");
}

}  // namespace umtet
