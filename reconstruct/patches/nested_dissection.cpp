#include "reconstruct/patches/nested_dissection.h"

#include <oneapi/tbb/parallel_invoke.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <numeric>

namespace umtet {
namespace {

// Elements of a leaf: 2^3 cells of cubic splines have 125 unknowns, a front that fits into the second-level cache.
constexpr std::size_t kLeaf = 8;

/// The unknowns of a set of elements that are not eliminated, ascending, and their part of the system.
struct Front {
  std::vector<int> unknowns;
  std::vector<int> uses;  ///< per unknown: how many of the elements have it
  Eigen::MatrixXd A;      ///< lower triangle
  Eigen::VectorXd b;
};

/// What is kept of the elimination of a front: L x_i = z - Y x_b, with the factor L of A_ii.
struct Eliminated {
  std::vector<int> interior, border;
  Eigen::MatrixXd L, Y;
  Eigen::VectorXd z;
  std::unique_ptr<Eliminated> halves[2];
};

class Dissection {
 public:
  explicit Dissection(const ElementSystem& system) : system_(system), uses_(system.n_unknowns, 0) {
    for (const auto& some : system.unknowns)
      for (const int u : some) ++uses_[u];
  }

  Eigen::VectorXd operator()() {
    std::vector<int> elements(system_.unknowns.size());
    std::iota(elements.begin(), elements.end(), 0);
    Eliminated root;
    factor(elements, root);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(system_.n_unknowns);
    if (!is_definite(root)) return {};
    substitute(root, x);
    return x;
  }

 private:
  /// Divides elements in two halves at the median along the longest side of their box.
  std::span<int>::iterator halve(std::span<int> elements) const {
    Eigen::AlignedBox3d box;
    for (const int e : elements) box.extend(system_.centres[e]);
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    const auto middle = elements.begin() + static_cast<std::ptrdiff_t>(elements.size() / 2);
    std::nth_element(elements.begin(), middle, elements.end(), [&](int a, int b) {
      const double p = system_.centres[a][axis], q = system_.centres[b][axis];
      return p != q ? p < q : a < b;
    });
    return middle;
  }

  Front factor(std::span<int> elements, Eliminated& kept) const {
    if (elements.size() <= kLeaf) return eliminate(leaf(elements), kept);
    const auto middle = halve(elements);
    Front a, b;
    for (auto& half : kept.halves) half = std::make_unique<Eliminated>();
    oneapi::tbb::parallel_invoke(
        [&] {
          a = factor({elements.begin(), middle}, *kept.halves[0]);
        },
        [&] {
          b = factor({middle, elements.end()}, *kept.halves[1]);
        });
    return eliminate(sum(a, b), kept);
  }

  Front leaf(std::span<const int> elements) const {
    Front front;
    for (const int e : elements)
      front.unknowns.insert(front.unknowns.end(), system_.unknowns[e].begin(), system_.unknowns[e].end());
    std::sort(front.unknowns.begin(), front.unknowns.end());
    front.unknowns.erase(std::unique(front.unknowns.begin(), front.unknowns.end()), front.unknowns.end());
    make_room(front);
    for (const int e : elements) {
      const auto n = static_cast<Eigen::Index>(system_.unknowns[e].size());
      Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
      Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
      system_.add(e, A, b);
      add(system_.unknowns[e], std::vector<int>(n, 1), A, b, front);
    }
    return front;
  }

  static void make_room(Front& front) {
    const auto n = static_cast<Eigen::Index>(front.unknowns.size());
    front.A = Eigen::MatrixXd::Zero(n, n);
    front.b = Eigen::VectorXd::Zero(n);
    front.uses.assign(n, 0);
  }

  static Front sum(const Front& a, const Front& b) {
    Front both;
    std::set_union(a.unknowns.begin(), a.unknowns.end(), b.unknowns.begin(), b.unknowns.end(),
                   std::back_inserter(both.unknowns));
    make_room(both);
    add(a.unknowns, a.uses, a.A, a.b, both);
    add(b.unknowns, b.uses, b.A, b.b, both);
    return both;
  }

  static void add(const std::vector<int>& unknowns, const std::vector<int>& uses, const Eigen::MatrixXd& A,
                  const Eigen::VectorXd& b, Front& front) {
    std::vector<Eigen::Index> at;
    at.reserve(unknowns.size());
    for (const int u : unknowns)
      at.push_back(std::lower_bound(front.unknowns.begin(), front.unknowns.end(), u) - front.unknowns.begin());
    for (std::size_t j = 0; j < at.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      for (std::size_t i = j; i < at.size(); ++i)
        front.A(std::max(at[i], at[j]), std::min(at[i], at[j])) += A(static_cast<Eigen::Index>(i), column);
      front.b[at[j]] += b[column];
      front.uses[at[j]] += uses[j];
    }
  }

  /// Eliminates the unknowns whose elements are all in the front. \return the front of the others
  Front eliminate(const Front& front, Eliminated& kept) const {
    std::vector<Eigen::Index> order, border;
    for (std::size_t k = 0; k < front.unknowns.size(); ++k) {
      const int u = front.unknowns[k];
      const bool is_interior = front.uses[k] == uses_[u];
      (is_interior ? order : border).push_back(static_cast<Eigen::Index>(k));
      (is_interior ? kept.interior : kept.border).push_back(u);
    }
    const auto n = static_cast<Eigen::Index>(order.size()), m = static_cast<Eigen::Index>(border.size());
    const auto entry = [&](Eigen::Index i, Eigen::Index j) { return front.A(std::max(i, j), std::min(i, j)); };
    Front rest;
    rest.unknowns = kept.border;
    make_room(rest);
    for (Eigen::Index j = 0; j < m; ++j) {
      rest.uses[j] = front.uses[border[j]];
      rest.b[j] = front.b[border[j]];
      for (Eigen::Index i = j; i < m; ++i) rest.A(i, j) = entry(border[i], border[j]);
    }
    if (n == 0) return rest;
    Eigen::MatrixXd A(n, n);
    kept.Y.resize(n, m);
    kept.z.resize(n);
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = j; i < n; ++i) A(i, j) = entry(order[i], order[j]);
      kept.z[j] = front.b[order[j]];
    }
    for (Eigen::Index j = 0; j < m; ++j)
      for (Eigen::Index i = 0; i < n; ++i) kept.Y(i, j) = entry(order[i], border[j]);
    Eigen::LLT<Eigen::MatrixXd> llt(A);
    if (llt.info() != Eigen::Success) return rest;  // L stays empty
    kept.L = llt.matrixLLT();
    const auto L = kept.L.triangularView<Eigen::Lower>();
    L.solveInPlace(kept.z);
    if (m == 0) return rest;
    L.solveInPlace(kept.Y);
    rest.A.selfadjointView<Eigen::Lower>().rankUpdate(kept.Y.transpose(), -1);
    rest.b -= kept.Y.transpose() * kept.z;
    return rest;
  }

  static bool is_definite(const Eliminated& front) {
    if (front.L.rows() != static_cast<Eigen::Index>(front.interior.size())) return false;
    return !front.halves[0] || (is_definite(*front.halves[0]) && is_definite(*front.halves[1]));
  }

  static void substitute(const Eliminated& front, Eigen::VectorXd& x) {
    if (!front.interior.empty()) {
      Eigen::VectorXd of_border(front.border.size()), own = front.z;
      for (std::size_t k = 0; k < front.border.size(); ++k)
        of_border[static_cast<Eigen::Index>(k)] = x[front.border[k]];
      if (!front.border.empty()) own -= front.Y * of_border;
      front.L.triangularView<Eigen::Lower>().transpose().solveInPlace(own);
      for (std::size_t k = 0; k < front.interior.size(); ++k) x[front.interior[k]] = own[static_cast<Eigen::Index>(k)];
    }
    if (!front.halves[0]) return;
    for (const auto& half : front.halves) substitute(*half, x);
  }

  const ElementSystem& system_;
  std::vector<int> uses_;  ///< per unknown: elements that have it
};

}  // namespace

Eigen::VectorXd solve_by_nested_dissection(const ElementSystem& system) { return Dissection(system)(); }

}  // namespace umtet
