#include "body/fidelity/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "body/fidelity/accepted_defects.h"
#include "body/fidelity/input_judgement.h"

namespace umtet {
namespace {

/// The places of a kind in words; small ones too if they count.
std::string said_of(const PlaceReport::OfKind& k, const ZeroSetReport& domain, bool with_small) {
  const MeshPlace& worst = k.worst;
  const std::size_t n = with_small ? k.n : k.n - k.n_small;
  const std::string places = n == 1 ? "1 place" : fmt::format("{} places", n);
  const std::string at = fmt::format("({:.6g}, {:.6g}, {:.6g})", worst.where.x(), worst.where.y(), worst.where.z());
  const double off = worst.off_over_h;
  switch (k.kind) {
    case PlaceKind::Folded:
      return fmt::format("the boundary is folded over at {}, the worst, of {} faces at {}, {:.2g} h off psi = 0",
                         places, worst.n, at, off);
    case PlaceKind::Off:
      return fmt::format("the boundary is off psi = 0 at {}, the worst at {} by {:.2g} h", places, at, off);
    case PlaceKind::Filled:
      return fmt::format("a gap is filled, for the boundary to be a manifold, at {}, the worst at {}, {:.2g} h deep",
                         places, at, off);
    case PlaceKind::Cut:
      return fmt::format("body is cut away, for the boundary to be a manifold, at {}, the worst at {}, {:.2g} h deep",
                         places, at, off);
    case PlaceKind::Thin:
      return fmt::format("the mesh lacks what is thin at {}: psi = 0 is {:.2g} h from its boundary at {}", places, off,
                         at);
    case PlaceKind::Topology:
      return fmt::format(
          "psi = 0 has {} pieces (and {} dropped ones) of Euler characteristic {} on a grid of spacing {:.3g}, the "
          "boundary of the mesh {} of {}; they differ most at {}",
          domain.components_kept, domain.components_dropped.size(), domain.euler_characteristic_of_kept_components,
          domain.counting_spacing, domain.components_meshed, domain.euler_characteristic_meshed, at);
    case PlaceKind::Missed:
      return fmt::format(
          "psi = 0 passes by samples that are farther than h from the mesh at {}, the worst, {} samples at {}, {:.2g} "
          "h",
          places, worst.n, at, off);
  }
  return "";
}

}  // namespace

std::vector<std::string> failures(const SecondOrderReport& report) {
  return failures(report.certificate, report.repairs ? report.repairs->n_mid_sides_put_back : 0);
}

bool fits_psi(const MeshMeasures& m) {
  const auto is_settled = [](const PlaceReport::OfKind& k) { return k.n == k.n_small; };
  return m.is_valid && m.reasons.empty() && std::all_of(m.places.kinds.begin(), m.places.kinds.end(), is_settled);
}

bool has_input(const MeshMeasures& m) { return m.n_points || m.labels; }

std::string Verdict::word() const {
  if (!passes()) return "fail";
  if (n_defects == 0) return "pass";
  return fmt::format("pass with {} defect{} named", n_defects, n_defects == 1 ? "" : "s");
}

Verdict judge_shape(const MeshMeasures& measured, bool strict, const std::string& accept) {
  Verdict verdict;
  verdict.reasons = measured.reasons;
  verdict.strict = strict;
  verdict.accept = accept;
  verdict.is_valid = measured.is_valid;
  verdict.fits_psi = fits_psi(measured);
  const std::vector<AcceptedDefects> accepted = parse_accepted_defects(accept);
  for (const PlaceReport::OfKind& k : measured.places.kinds) {
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
    verdict.reasons.push_back(fmt::format("min quality {:.4f} is below the gate of {:.4f}", least, gate));
  }
  return verdict;
}

}  // namespace umtet
