#include "reconstruct/basis/lme_lattice.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace umtet {

namespace {

constexpr int kPackSize = LmeBasis1d::kPackSize;

// Moments of the functions at a trial lambda.
struct Moments {
  double mean, J;  // <d>, <d^2>
};

// Weighted exponentials W_a w_a = p_a over the nodes that have a weight; returns <d> and <d^2>.
Moments weigh(const double* w, const double* d, int count, double lambda, double* W) {
  double largest = -1e300;  // exponents are shifted by their maximum: no overflow near the hull
  for (int a = 0; a < count; ++a) {
    if (w[a] > 0) largest = std::max(largest, lambda * d[a]);
  }
  double Z = 0, m1 = 0, m2 = 0;
  for (int a = 0; a < count; ++a) {
    W[a] = std::exp(lambda * d[a] - largest);
    const double p = w[a] * W[a];
    Z += p;
    m1 += p * d[a];
    m2 += p * d[a] * d[a];
  }
  for (int a = 0; a < count; ++a) W[a] /= Z;
  return {m1 / Z, m2 / Z};
}

// Root of <d>(lambda) = 0, which increases with slope J = <d^2> - <d>^2.
double solve_lambda(const double* w, const double* d, int count, double* W, double& J) {
  double lambda = 0;
  Moments m = weigh(w, d, count, lambda, W);
  for (int it = 0; it < 200; ++it) {
    const double slope = m.J - m.mean * m.mean;
    double step = slope > 0 ? -m.mean / slope : (m.mean > 0 ? -1 : 1);
    step = std::clamp(step, -4.0, 4.0);
    double trial = lambda + step;
    Moments next = weigh(w, d, count, trial, W);
    while (std::abs(next.mean) > std::abs(m.mean) && std::abs(step) > 1e-14 * (1 + std::abs(lambda))) {
      step /= 2;
      trial = lambda + step;
      next = weigh(w, d, count, trial, W);
    }
    const bool done = std::abs(step) <= 1e-15 * (1 + std::abs(lambda)) || next.mean == 0;
    if (std::abs(next.mean) <= std::abs(m.mean)) {
      lambda = trial;
      m = next;
    }
    if (done) break;
  }
  m = weigh(w, d, count, lambda, W);
  J = m.J;
  return lambda;
}

}  // namespace

LmeBasis1d evaluate_lme_1d(const LmePrior& prior, int n, double x) {
  const int R = half_width(prior), width = 2 * R;
  // At the ends lambda is infinite although the functions have limits: they are continued from a little inside, where
  // the sums below still hold 1e-6 of N'' (they lose eps / inset^2).
  constexpr double inset = 1e-5;
  const double wanted = x;
  x = std::clamp(x, inset, n - 1 - inset);
  const int cell = std::min(static_cast<int>(x), n - 2);
  LmeBasis1d out;
  out.first = std::clamp(cell - R + 1, 0, n - width);

  double w[kPackSize] = {}, dw[kPackSize] = {}, ddw[kPackSize] = {}, d[kPackSize] = {}, W[kPackSize] = {};
  for (int a = 0; a < width; ++a) {
    d[a] = x - (out.first + a);
    const PriorJet jet = evaluate(prior, d[a]);
    w[a] = jet.w, dw[a] = jet.dw, ddw[a] = jet.ddw;
  }
  double J = 0;
  solve_lambda(w, d, width, W, J);

  double mean_v = 0, moment_v = 0;  // <w'/w> and <d w'/w>
  for (int a = 0; a < width; ++a) {
    mean_v += W[a] * dw[a];
    moment_v += W[a] * dw[a] * d[a];
  }
  const double dlambda = -(1 + moment_v) / J;
  double T[kPackSize], sum_T = 0, sum_Td = 0;
  for (int a = 0; a < width; ++a) {
    const double p = W[a] * w[a], e = dlambda * d[a] - mean_v;
    T[a] = W[a] * ddw[a] + 2 * W[a] * dw[a] * e + p * e * e;
    sum_T += T[a];
    sum_Td += T[a] * d[a];
  }
  for (int a = 0; a < kPackSize; ++a) {
    const double p = a < width ? W[a] * w[a] : 0;
    out.N[a] = p;
    out.dN[a] = a < width ? W[a] * dw[a] + p * (dlambda * d[a] - mean_v) : 0;
    out.ddN[a] = a < width ? T[a] - p * (sum_T + d[a] * sum_Td / J) : 0;
    const double rest = wanted - x;
    out.N[a] += rest * (out.dN[a] + rest / 2 * out.ddN[a]);
    out.dN[a] += rest * out.ddN[a];
  }
  return out;
}

LmeTables::LmeTables(const LmePrior& prior) : prior_(prior), R_(umtet::half_width(prior)) {
  const std::vector<std::string> wrong = problems(prior);
  if (!wrong.empty()) throw std::invalid_argument(wrong.front());
  if (prior.kind != LmePrior::Kind::CompactC2) return;
  pieces_.resize(first_piece(R_, 0));
  const double step = 1.0 / kPieces;
  for (int left = 0; left < R_; ++left) {
    for (int right = 0; right < R_; ++right) {
      // An axis on which cell `left` has `left` more nodes before it and `right` after it. Where that is fewer than the
      // window the solver wants, far nodes are added on the side that is complete: they have no weight.
      const int extra_left = left == R_ - 1 ? R_ : 0, extra_right = right == R_ - 1 ? R_ : 0;
      const int n = extra_left + left + 2 + right + extra_right, cell = extra_left + left;
      if (n < width()) continue;  // cannot occur on an axis of at least width() nodes
      Lanes N[2], dN[2], ddN[2];
      for (int k = 0; k <= kPieces; ++k) {
        std::swap(N[0], N[1]), std::swap(dN[0], dN[1]), std::swap(ddN[0], ddN[1]);
        // The upper end of a cell belongs to the next one: stay in this one, where a node may lose its weight at the
        // end.
        const double x = cell + (k == kPieces ? std::nextafter(1.0, 0.0) : k * step);
        const LmeBasis1d b = evaluate_lme_1d(prior, n, x);
        N[1].setZero(), dN[1].setZero(), ddN[1].setZero();
        for (int a = 0; a < width(); ++a) {
          const int node = b.first + a, lane = node - (cell - R_ + 1);
          if (lane < 0 || lane >= width()) continue;
          N[1][lane] = b.N[a], dN[1][lane] = b.dN[a] * step, ddN[1][lane] = b.ddN[a] * step * step;
        }
        if (k == 0) continue;
        Piece& p = pieces_[first_piece(left, right) + k - 1];
        const Lanes dv = N[1] - N[0] - dN[0] - ddN[0] / 2, dd = dN[1] - dN[0] - ddN[0], d2 = ddN[1] - ddN[0];
        p.c[0] = N[0], p.c[1] = dN[0], p.c[2] = ddN[0] / 2;
        p.c[3] = 10 * dv - 4 * dd + d2 / 2;
        p.c[4] = -15 * dv + 7 * dd - d2;
        p.c[5] = 6 * dv - 3 * dd + d2 / 2;
      }
    }
  }
}

void LmeTables::evaluate_exactly(const Eigen::Vector3i& n, const Eigen::Vector3d& xi, double scale,
                                 LmeBasis3d& out) const {
  LmeBasis1d* axes[] = {&out.x, &out.y, &out.z};
  for (int d = 0; d < 3; ++d) {
    *axes[d] = evaluate_lme_1d(prior_, n[d], xi[d]);
    for (double& v : axes[d]->dN) v *= scale;
    for (double& v : axes[d]->ddN) v *= scale * scale;
  }
}

// At the hull the window is moved inside the axis, and the lanes with it.
void LmeTables::move_inside(const LmePlace& place, LmeBasis3d& out) const {
  LmeBasis1d* axes[] = {&out.x, &out.y, &out.z};
  for (int d = 0; d < 3; ++d) {
    LmeBasis1d& B = *axes[d];
    const int shift = place.first[d] - place.cell[d] + R_ - 1;
    LmeBasis1d moved{};
    for (int a = std::max(0, -shift); a < width() - std::max(0, shift); ++a) {
      moved.N[a] = B.N[a + shift], moved.dN[a] = B.dN[a + shift], moved.ddN[a] = B.ddN[a + shift];
    }
    moved.first = place.first[d];
    B = moved;
  }
}

}  // namespace umtet
