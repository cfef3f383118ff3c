#include "tests/support/lme_scattered.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>

namespace umtet {

struct LmeScattered::Tree {
  // nanoflann's view of the node array.
  struct Points {
    const std::vector<Vec3>& p;
    std::size_t kdtree_get_point_count() const { return p.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t d) const { return p[i][static_cast<Eigen::Index>(d)]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  } points;
  using Index = std::uint32_t;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3, Index> index;

  explicit Tree(const std::vector<Vec3>& nodes) : points{nodes}, index(3, points) { index.buildIndex(); }
};

LmeScattered::LmeScattered(std::vector<Vec3> nodes, const LmePrior& prior, double spacing)
    : nodes_(std::move(nodes)), prior_(prior), spacing_(spacing), tree_(std::make_unique<Tree>(nodes_)) {}
LmeScattered::~LmeScattered() = default;
LmeScattered::LmeScattered(LmeScattered&& o) noexcept
    : nodes_(std::move(o.nodes_)), prior_(o.prior_), spacing_(o.spacing_), tree_(std::make_unique<Tree>(nodes_)) {}
LmeScattered& LmeScattered::operator=(LmeScattered&& o) noexcept {
  nodes_ = std::move(o.nodes_), prior_ = o.prior_, spacing_ = o.spacing_;
  tree_ = std::make_unique<Tree>(nodes_);
  return *this;
}

namespace {

struct Neighbours {
  std::vector<Vec3> d, dw;   // x - x_a in spacings; gradient of w
  std::vector<double> w, W;  // prior; p / w
  std::vector<Mat3> ddw;
};

// Product prior over the axes and its derivatives, in spacings.
void weigh(const LmePrior& prior, const Vec3& t, double& w, Vec3& dw, Mat3& ddw) {
  const PriorJet a = evaluate(prior, t[0]), b = evaluate(prior, t[1]), c = evaluate(prior, t[2]);
  w = a.w * b.w * c.w;
  dw = Vec3(a.dw * b.w * c.w, a.w * b.dw * c.w, a.w * b.w * c.dw);
  ddw << a.ddw * b.w * c.w, a.dw * b.dw * c.w, a.dw * b.w * c.dw,  //
      0, a.w * b.ddw * c.w, a.w * b.dw * c.dw,                     //
      0, 0, a.w * b.w * c.ddw;
  ddw(1, 0) = ddw(0, 1), ddw(2, 0) = ddw(0, 2), ddw(2, 1) = ddw(1, 2);
}

// log Z(lambda) with its gradient <d> and <d d^T>; W normalised so that sum W w = 1.
double log_partition(Neighbours& nb, const Vec3& lambda, Vec3& mean, Mat3& J) {
  double largest = -1e300, Z = 0;
  for (const Vec3& d : nb.d) largest = std::max(largest, lambda.dot(d));
  mean.setZero(), J.setZero();
  for (std::size_t a = 0; a < nb.d.size(); ++a) {
    nb.W[a] = std::exp(lambda.dot(nb.d[a]) - largest);
    const double p = nb.w[a] * nb.W[a];
    Z += p;
    mean += p * nb.d[a];
    J += p * nb.d[a] * nb.d[a].transpose();
  }
  for (double& W : nb.W) W /= Z;
  mean /= Z, J /= Z;
  return std::log(Z) + largest;
}

// Minimises the convex log Z; false when the minimum is not attained (x outside the hull) or the nodes are flat.
bool solve_lambda(Neighbours& nb, Mat3& J) {
  Vec3 lambda = Vec3::Zero(), mean;
  double value = log_partition(nb, lambda, mean, J);
  for (int it = 0; it < 100; ++it) {
    if (mean.norm() < 1e-15) return true;
    const Eigen::LDLT<Mat3> ldlt(J - mean * mean.transpose());
    if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() < 1e-12) return false;
    const Vec3 step = -ldlt.solve(mean);
    const double decrement = -step.dot(mean);
    double t = 1;
    Vec3 next_mean;
    Mat3 next_J;
    double next = log_partition(nb, lambda + step, next_mean, next_J);
    while (next > value - 1e-4 * t * decrement && t > 1e-6 && decrement > 1e-16) {
      t /= 2;
      next = log_partition(nb, lambda + t * step, next_mean, next_J);
    }
    lambda += t * step;
    value = next, mean = next_mean, J = next_J;
    if (decrement < 1e-28 || (decrement < 1e-16 && it > 50)) return true;
    if (lambda.norm() > 200) return false;
  }
  return mean.norm() < 1e-10;
}

}  // namespace

// The product support is a box; a Gaussian is cut on the sphere, as in the paper.
double LmeScattered::reach() const {
  return radius(prior_) * (prior_.kind == LmePrior::Kind::Gaussian ? 1.0 : std::sqrt(3.0)) * spacing_;
}

std::vector<int> LmeScattered::overlapping(int a) const {
  std::vector<std::pair<Tree::Index, double>> found;
  tree_->index.radiusSearch(nodes_[a].data(), 4 * reach() * reach(), found, nanoflann::SearchParams());
  std::vector<int> nodes;
  nodes.reserve(found.size());
  for (const auto& [b, distance2] : found) nodes.push_back(static_cast<int>(b));
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

LmeValues LmeScattered::evaluate(const Vec3& x) const {
  LmeValues out;
  std::vector<std::pair<Tree::Index, double>> found;
  tree_->index.radiusSearch(x.data(), reach() * reach(), found, nanoflann::SearchParams());
  std::sort(found.begin(), found.end());

  Neighbours nb;
  for (const auto& [a, distance2] : found) {
    const Vec3 t = (x - nodes_[a]) / spacing_;
    double w;
    Vec3 dw;
    Mat3 ddw;
    weigh(prior_, t, w, dw, ddw);
    if (w <= 0) continue;
    out.node.push_back(static_cast<int>(a));
    nb.d.push_back(t), nb.w.push_back(w), nb.dw.push_back(dw), nb.ddw.push_back(ddw);
  }
  const std::size_t n = nb.d.size();
  nb.W.resize(n);
  Mat3 J;
  if (n < 4 || !solve_lambda(nb, J)) return out;
  out.converged = true;

  const Mat3 J_inv = J.inverse();
  Vec3 mean_v = Vec3::Zero();      // sum W dw
  Mat3 moment = Mat3::Identity();  // column j: unit_j + sum W d_j w d
  for (std::size_t a = 0; a < n; ++a) {
    mean_v += nb.W[a] * nb.dw[a];
    moment += nb.W[a] * nb.d[a] * nb.dw[a].transpose();
  }
  const Mat3 L = -J_inv * moment;  // column j is L_j
  std::vector<Vec3> e(n);
  std::vector<Mat3> T(n);
  Mat3 sum_T = Mat3::Zero(), sum_Td[3] = {Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
  for (std::size_t a = 0; a < n; ++a) {
    e[a] = L.transpose() * nb.d[a] - mean_v;
    const Mat3 cross = nb.dw[a] * e[a].transpose();
    T[a] = nb.W[a] * (nb.ddw[a] + cross + cross.transpose()) + nb.W[a] * nb.w[a] * e[a] * e[a].transpose();
    sum_T += T[a];
    for (int i = 0; i < 3; ++i) sum_Td[i] += T[a] * nb.d[a][i];
  }
  out.N.resize(n), out.grad.resize(n), out.hess.resize(n);
  for (std::size_t a = 0; a < n; ++a) {
    const double p = nb.W[a] * nb.w[a];
    const Vec3 g = J_inv * nb.d[a];
    out.N[a] = p;
    out.grad[a] = (nb.W[a] * nb.dw[a] + p * e[a]) / spacing_;
    out.hess[a] = (T[a] - p * (sum_T + g[0] * sum_Td[0] + g[1] * sum_Td[1] + g[2] * sum_Td[2])) / (spacing_ * spacing_);
  }
  return out;
}

}  // namespace umtet
