#include "mesh/core/piecewise_domain.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace umtet {
namespace {

constexpr std::size_t kOnStack = 64;  // values of patches; more are allocated

/// Values of the patches at one point.
class Values {
 public:
  explicit Values(std::size_t n) : n_(n) {
    if (n > kOnStack) many_.resize(n);
  }
  double* data() { return many_.empty() ? few_.data() : many_.data(); }
  std::span<const double> all() { return {data(), n_}; }

 private:
  std::size_t n_;
  std::array<double, kOnStack> few_;
  std::vector<double> many_;
};

}  // namespace

PiecewiseDomain::PiecewiseDomain(PatchFunction f)
    : patches_{std::make_shared<const PatchFunction>(std::move(f))}, side_{1}, nodes_{{true, false, 0, -1, -1}} {}

PiecewiseDomain PiecewiseDomain::joined(const PiecewiseDomain& a, const PiecewiseDomain& b, bool is_max) {
  PiecewiseDomain both = a;
  std::vector<int> number;
  for (std::size_t p = 0; p < b.patches_.size(); ++p) {
    const auto same = std::find(both.patches_.begin(), both.patches_.end(), b.patches_[p]);
    number.push_back(static_cast<int>(same - both.patches_.begin()));
    if (same == both.patches_.end()) {
      both.patches_.push_back(b.patches_[p]);
      both.side_.push_back(b.side_[p]);
    } else if (both.side_[number.back()] != b.side_[p]) {
      throw std::invalid_argument("a patch bounds the domain from both of its sides");
    }
  }
  const auto offset = static_cast<int>(both.nodes_.size());
  for (Node node : b.nodes_) {
    if (node.is_leaf) {
      node.patch = number[node.patch];
    } else {
      node.left += offset;
      node.right += offset;
    }
    both.nodes_.push_back(node);
  }
  both.nodes_.push_back({false, is_max, -1, offset - 1, static_cast<int>(both.nodes_.size()) - 1});
  return both;
}

PiecewiseDomain intersection(const PiecewiseDomain& a, const PiecewiseDomain& b) {
  return PiecewiseDomain::joined(a, b, true);
}

PiecewiseDomain united(const PiecewiseDomain& a, const PiecewiseDomain& b) {
  return PiecewiseDomain::joined(a, b, false);
}

PiecewiseDomain complement(const PiecewiseDomain& a) {
  PiecewiseDomain outside = a;
  for (int& side : outside.side_) side = -side;
  for (PiecewiseDomain::Node& node : outside.nodes_) node.is_max = !node.is_max;
  return outside;
}

PiecewiseDomain PiecewiseDomain::of_patches(std::vector<PatchFunction> patches, ActivePatchFunction psi) {
  PiecewiseDomain domain;
  for (PatchFunction& f : patches) domain.patches_.push_back(std::make_shared<const PatchFunction>(std::move(f)));
  domain.side_.assign(domain.patches_.size(), 1);
  domain.active_ = std::move(psi);
  return domain;
}

ActivePatch PiecewiseDomain::psi_of(std::span<const double> values) const {
  std::array<ActivePatch, kOnStack> few;
  std::vector<ActivePatch> many;
  if (nodes_.size() > kOnStack) many.resize(nodes_.size());
  ActivePatch* at = many.empty() ? few.data() : many.data();
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Node& node = nodes_[k];
    if (node.is_leaf) {
      at[k] = {side_[node.patch] * values[node.patch], node.patch};
      continue;
    }
    const ActivePatch &left = at[node.left], &right = at[node.right];
    at[k] = (left.value < right.value) == node.is_max ? right : left;
  }
  return at[nodes_.size() - 1];
}

ActivePatch PiecewiseDomain::psi_at(const Vec3& x) const {
  if (active_) return active_(x);
  Values values(patches_.size());
  for (std::size_t p = 0; p < patches_.size(); ++p) values.data()[p] = (*patches_[p])(x, nullptr, nullptr);
  return psi_of(values.all());
}

int PiecewiseDomain::active(const Vec3& x) const { return psi_at(x).patch; }

double PiecewiseDomain::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const ActivePatch psi = psi_at(x);
  if (gradient || hessian) {
    patch(psi.patch, x, gradient, hessian);
    if (gradient) *gradient *= side_[psi.patch];
    if (hessian) *hessian *= side_[psi.patch];
  }
  return psi.value;
}

Vec3 PiecewiseDomain::gradient(const Vec3& x) const {
  Vec3 g;
  evaluate(x, &g, nullptr);
  return g;
}

}  // namespace umtet
