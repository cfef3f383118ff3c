#include "reconstruct/level_set/least_hessian.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace umtet {
namespace {

/// Free nodes that follow one another along the first axis.
struct Run {
  std::ptrdiff_t begin, end;
};

/// The runs of the nodes that are marked, slab by slab.
std::vector<std::vector<Run>> runs_of(const std::vector<std::uint8_t>& marked, const Eigen::Vector3i& n) {
  std::vector<std::vector<Run>> runs(static_cast<std::size_t>(n[2]));
  tbb::parallel_for(0, n[2], [&](int k) {
    for (int j = 0; j < n[1]; ++j) {
      const std::ptrdiff_t row = n[0] * (j + static_cast<std::ptrdiff_t>(n[1]) * k);
      for (std::ptrdiff_t i = row; i < row + n[0]; ++i) {
        if (!marked[i]) continue;
        const std::ptrdiff_t begin = i;
        while (i < row + n[0] && marked[i]) ++i;
        runs[k].push_back({begin, i});
      }
    }
  });
  return runs;
}

/// The marked nodes and their neighbours along the axes. \pre none is in the outermost layer
std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& marked, const Eigen::Vector3i& n) {
  std::vector<std::uint8_t> wide = marked;
  const std::ptrdiff_t strides[] = {1, n[0], static_cast<std::ptrdiff_t>(n[0]) * n[1]};
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (!marked[i]) continue;
    for (const std::ptrdiff_t s : strides) wide[i - s] = wide[i + s] = 1;
  }
  return wide;
}

class Search {
 public:
  Search(BoundedValues& u, const Vec3& weights, double pull)
      : u_(u),
        free_(runs_of(u.is_free, u.n)),
        around_(runs_of(dilated(u.is_free, u.n), u.n)),
        start_(u.value),
        y_(u.value),
        laplacian_(u.value.size(), 0),
        wx_(static_cast<float>(weights[0])),
        wy_(static_cast<float>(weights[1])),
        wz_(static_cast<float>(weights[2])),
        // The greatest eigenvalue of L is 4 (wx + wy + wz).
        pull_(static_cast<float>(pull)),
        step_(static_cast<float>(1 / (std::pow(4 * weights.sum(), 2) + pull))) {}

  struct Step {
    double most = 0;     ///< greatest change of a value
    double against = 0;  ///< (y - u_new) . (u_new - u): positive where the momentum leads uphill
  };
  /// @param momentum  of the next iteration
  Step advance(float momentum) {
    for_slabs(around_, [&](int, const Run& r) {
      for (std::ptrdiff_t i = r.begin; i < r.end; ++i) laplacian_[i] = laplacian(y_.data(), i);
    });
    std::vector<Step> of_slab(free_.size());
    for_slabs(free_, [&](int k, const Run& r) {
      float most = 0, against = 0;
      for (std::ptrdiff_t i = r.begin; i < r.end; ++i) {
        const float trial = y_[i] - step_ * (laplacian(laplacian_.data(), i) + pull_ * (y_[i] - start_[i]));
        const float next = std::min(std::max(trial, u_.low[i]), u_.high[i]);
        const float change = next - u_.value[i];
        most = std::max(most, std::abs(change));
        against += (y_[i] - next) * change;
        y_[i] = next + momentum * change;
        u_.value[i] = next;
      }
      of_slab[k].most = std::max<double>(of_slab[k].most, most);
      of_slab[k].against += against;
    });
    Step all;
    for (const Step& s : of_slab) all.most = std::max(all.most, s.most), all.against += s.against;
    return all;
  }
  void forget_momentum() { y_ = u_.value; }

 private:
  float laplacian(const float* v, std::ptrdiff_t i) const {
    const std::ptrdiff_t sy = u_.n[0], sz = sy * u_.n[1];
    const float two = 2 * v[i];
    return wx_ * (v[i - 1] + v[i + 1] - two) + wy_ * (v[i - sy] + v[i + sy] - two) +
           wz_ * (v[i - sz] + v[i + sz] - two);
  }
  template <class F>
  static void for_slabs(const std::vector<std::vector<Run>>& runs, const F& f) {
    tbb::parallel_for(0, static_cast<int>(runs.size()), [&](int k) {
      for (const Run& r : runs[k]) f(k, r);
    });
  }

  BoundedValues& u_;
  std::vector<std::vector<Run>> free_, around_;
  std::vector<float> start_, y_, laplacian_;
  float wx_, wy_, wz_, pull_, step_;
};

}  // namespace

int minimise_hessian(BoundedValues& u, const Vec3& weights, const LeastHessianParams& params) {
  for (std::size_t i = 0; i < u.value.size(); ++i)
    if (u.is_free[i]) u.value[i] = std::min(std::max(u.value[i], u.low[i]), u.high[i]);
  Search search(u, weights, params.pull);
  double t = 1;
  for (int iteration = 1; iteration <= params.max_iterations; ++iteration) {
    const double next_t = .5 * (1 + std::sqrt(1 + 4 * t * t));
    const Search::Step step = search.advance(static_cast<float>((t - 1) / next_t));
    t = next_t;
    if (step.most <= params.tolerance) return iteration;
    if (step.against > 0) {
      search.forget_momentum();
      t = 1;
    }
  }
  return params.max_iterations;
}

}  // namespace umtet
