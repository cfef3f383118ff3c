#include "mesh/submesh/nothing_inside.h"

#include <cmath>

#include "mesh/submesh/assemble_submesh.h"

namespace umtet {
namespace {

/// "Inside" where psi has no finite value: the search for {psi < 0} then finds those vertices.
struct NotFinite {
  ImplicitFunctionRef psi;
  double value(const Vec3& x) const { return std::isfinite(psi.value(x)) ? 1 : -1; }
  Vec3 gradient(const Vec3&) const { return Vec3::Zero(); }
  void values(std::span<const Vec3> x, double* out) const {
    psi.values(x, out);
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = std::isfinite(out[i]) ? 1 : -1;
  }
  const SideBySide* side_by_side() const { return psi.side_by_side(); }
};

}  // namespace

NothingInside nothing_inside(const BackgroundMesh& background, ImplicitFunctionRef psi, const Context& context,
                             const std::string& search) {
  UmEvidence evidence{.what = "no vertex of the background mesh was found inside the domain" + search};
  std::size_t n_asked = 0;
  const NotFinite not_finite{psi};
  inside_vertices(background, not_finite, n_asked, context).for_each([&](std::int64_t v) {
    if (evidence.count++ == 0) evidence.background_vertex = v;
  });
  if (evidence.count == 0) return {UmStatus::EmptyDomain, evidence};
  evidence.where = background.position(evidence.background_vertex);
  if (evidence.count < n_asked) {
    evidence.what += "; psi is no finite number at some of them";
    return {UmStatus::EmptyDomain, evidence};
  }
  evidence.what = "psi is a finite number at no vertex of the background mesh";
  return {UmStatus::PsiNotFinite, evidence};
}

}  // namespace umtet
