#pragma once

#include <Eigen/Core>

namespace umtet::detail {

/// Search direction of the limited-memory BFGS method: -H g, with H the inverse Hessian estimated from the last steps.
///                                                     [LiuNocedal1989; NocedalWright2006, Algorithm 7.4]
class LbfgsDirection {
 public:
  explicit LbfgsDirection(Eigen::Index n) : s_(n, kPairs), y_(n, kPairs) {}

  /// True if no step is known: the direction is -g.
  bool is_steepest() const { return n_ == 0; }

  /// Adds a step. A step along which the function is not convex is left out, so that H stays positive definite.
  /// @param s, y  the step, and the change of the gradient over it
  void add(const Eigen::VectorXd& s, const Eigen::VectorXd& y) {
    const double curvature = s.dot(y);
    if (!(curvature > kLeastCosine * s.norm() * y.norm())) return;
    const int k = next_ % kPairs;
    s_.col(k) = s;
    y_.col(k) = y;
    by_curvature_[k] = 1 / curvature;
    ++next_;
    n_ = n_ < kPairs ? n_ + 1 : kPairs;
  }

  /// @param direction  receives the direction, of the size of g
  void find(const Eigen::VectorXd& g, Eigen::VectorXd& direction) const {
    direction = -g;
    Eigen::Matrix<double, kPairs, 1> a;
    for (int j = 1; j <= n_; ++j) {
      const int k = (next_ - j) % kPairs;
      a[k] = by_curvature_[k] * s_.col(k).dot(direction);
      direction -= a[k] * y_.col(k);
    }
    if (n_ > 0) {
      const int last = (next_ - 1) % kPairs;
      direction /= by_curvature_[last] * y_.col(last).squaredNorm();
    }
    for (int j = n_; j >= 1; --j) {
      const int k = (next_ - j) % kPairs;
      direction += (a[k] - by_curvature_[k] * y_.col(k).dot(direction)) * s_.col(k);
    }
  }

 private:
  static constexpr int kPairs = 8;  // 3 to 20 work; [LiuNocedal1989] reports no gain from more
  // Bound on the cosine between s and y: below it the lengths of the next steps would be determined by rounding.
  static constexpr double kLeastCosine = 1e-9;

  Eigen::Matrix<double, Eigen::Dynamic, kPairs> s_, y_;
  Eigen::Matrix<double, kPairs, 1> by_curvature_;
  int next_ = 0, n_ = 0;
};

}  // namespace umtet::detail
