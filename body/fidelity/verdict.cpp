#include "body/fidelity/verdict.h"

#include <algorithm>
#include <vector>

#include "body/fidelity/accepted_defects.h"
#include "body/fidelity/input_judgement.h"
#include "common/formatted.h"

namespace umtet {
namespace {

/// The places of a kind in words; small ones too if they count.
std::string said_of(const DefectReport::OfKind& k, const ZeroSetReport& domain, bool with_small) {
  const MeshDefect& worst = k.worst;
  const std::size_t n = with_small ? k.n : k.n - k.n_small;
  const std::string defects = n == 1 ? "1 place" : formatted("%zu places", n);
  const std::string at = formatted("(%.6g, %.6g, %.6g)", worst.where.x(), worst.where.y(), worst.where.z());
  const double off = worst.off_over_h;
  switch (k.kind) {
    case DefectKind::Folded:
      return formatted("the boundary is folded over at %s, the worst, of %zu faces at %s, %.2g h off psi = 0",
                       defects.c_str(), worst.n, at.c_str(), off);
    case DefectKind::Off:
      return formatted("the boundary is off psi = 0 at %s, the worst at %s by %.2g h", defects.c_str(), at.c_str(),
                       off);
    case DefectKind::Filled:
      return formatted("a gap is filled, for the boundary to be a manifold, at %s, the worst at %s, %.2g h deep",
                       defects.c_str(), at.c_str(), off);
    case DefectKind::Cut:
      return formatted("body is cut away, for the boundary to be a manifold, at %s, the worst at %s, %.2g h deep",
                       defects.c_str(), at.c_str(), off);
    case DefectKind::Thin:
      return formatted("the mesh lacks what is thin at %s: psi = 0 is %.2g h from its boundary at %s", defects.c_str(),
                       off, at.c_str());
    case DefectKind::Topology:
      return formatted(
          "psi = 0 has %zu pieces (and %zu dropped ones) of Euler characteristic %ld on a grid of spacing %.3g, the "
          "boundary of the mesh %d of %ld; they differ most at %s",
          domain.components_kept, domain.components_dropped.size(), domain.euler_characteristic_of_kept_components,
          domain.counting_spacing, domain.components_meshed, domain.euler_characteristic_meshed, at.c_str());
    case DefectKind::Missed:
      return formatted(
          "psi = 0 passes by samples that are farther than h from the mesh at %s, the worst, %zu samples at %s, %.2g "
          "h",
          defects.c_str(), worst.n, at.c_str(), off);
    case DefectKind::Edges:
      return formatted("the mesh lacks sharp edges or corners of the body at %s, the worst at %s, up to %.2g h long",
                       defects.c_str(), at.c_str(), worst.size_over_h);
  }
  return "";
}

}  // namespace

std::vector<std::string> failures(const SecondOrderReport& report) {
  return failures(report.certificate, report.repairs ? report.repairs->n_mid_sides_put_back : 0);
}

bool fits_psi(const MeshMeasures& m) {
  const auto is_settled = [](const DefectReport::OfKind& k) { return k.n == k.n_small; };
  return m.is_valid && m.reasons.empty() && std::all_of(m.defects.kinds.begin(), m.defects.kinds.end(), is_settled);
}

bool has_input(const MeshMeasures& m) { return m.n_points || m.labels || m.triangles; }

std::string Verdict::word() const {
  if (!passes()) return "fail";
  if (n_defects == 0) return "pass";
  return formatted("pass with %zu defect%s named", n_defects, n_defects == 1 ? "" : "s");
}

Verdict judge_shape(const MeshMeasures& measured, bool strict, const std::string& accept) {
  Verdict verdict;
  verdict.reasons = measured.reasons;
  verdict.strict = strict;
  verdict.accept = accept;
  verdict.is_valid = measured.is_valid;
  verdict.fits_psi = fits_psi(measured);
  const std::vector<AcceptedDefects> accepted = parse_accepted_defects(accept);
  for (const DefectReport::OfKind& k : measured.defects.kinds) {
    const bool is_defect = k.n == k.n_small && !strict;
    if (is_defect) verdict.n_defects += k.n;
    const bool passes = !is_defect && is_accepted(accepted, to_string(k.kind), k.max_off_over_h);
    (is_defect ? verdict.defects
     : passes  ? verdict.accepted
               : verdict.reasons)
        .push_back(said_of(k, measured.domain, strict || is_defect));
  }
  return verdict;
}

Verdict judge(const MeshMeasures& measured, const VerdictOptions& options) {
  const bool strict = options.strict;
  Verdict verdict = judge_shape(measured, strict, options.accept);
  const std::vector<AcceptedDefects> accepted = parse_accepted_defects(options.accept);
  for (const InputDefect& defect : input_defects(measured)) {
    const bool is_named = defect.is_small && !strict;
    if (is_named) ++verdict.n_defects;
    if (!defect.is_small) verdict.fits_input = false;
    const bool passes = !is_named && is_accepted(accepted, to_string(defect.kind), defect.amount);
    (is_named ? verdict.defects : passes ? verdict.accepted : verdict.reasons).push_back(defect.what);
  }
  // A formula is its own input.
  if (!has_input(measured)) verdict.fits_input = verdict.fits_input && verdict.fits_psi;
  const double gate = options.min_quality;
  if (!(gate > 0)) return verdict;
  verdict.min_quality_gate = gate;
  const double least = measured.mesh.quality.min;
  if (least < gate) {
    verdict.reasons.push_back(formatted("min quality %.4f is below the gate of %.4f", least, gate));
  }
  return verdict;
}

}  // namespace umtet
