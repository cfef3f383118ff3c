#pragma once

#include <string>
#include <vector>

namespace umtet {

/// Prior w of the local max-ent functions p_a(x) = w(x - x_a) exp(lambda . (x - x_a)) / Z, as a function of t = (x -
/// x_a) / h on one axis. In three dimensions w is the product over the axes.
///
/// CompactC2: w = exp(-(gamma - s / R^2) t^2) (1 - t^2 / R^2)^s for |t| < R, s = 4. It has support R and the curvature
/// of the Gaussian at t = 0. It is C3, although its name says C2; max-ent functions inherit this, and their tables
/// (LmeTables) are C2.
/// Gaussian: exp(-gamma t^2), cut where it falls below epsilon. This is the paper's prior, which jumps at the cut.
///                                                                     [ArroyoOrtiz2006; Rangarajan2018, Section 3.7]
struct LmePrior {
  enum class Kind { CompactC2, Gaussian };
  Kind kind = Kind::CompactC2;
  double gamma = 1.2;     ///< beta h^2, dimensionless; the paper's "beta = 1.6" is read as this; in (0, 4]
  int support = 3;        ///< R in lattice spacings, CompactC2 only; 2, 3 or 4
  double epsilon = 1e-4;  ///< Gaussian only; in (0, 1) and with a cut within 4 spacings

  static LmePrior paper() { return {Kind::Gaussian, 1.6, 3, 1e-4}; }
  bool operator==(const LmePrior&) const = default;
};

/// All broken constraints; empty if the prior is valid.
std::vector<std::string> problems(const LmePrior&);

/// Radius of w's support in spacings: R, or sqrt(ln(1/epsilon) / gamma).
double radius(const LmePrior&);
/// radius() rounded up: 2 half_width() nodes per axis can be nonzero in a lattice cell. At most 4.
int half_width(const LmePrior&);

/// w and its first two derivatives with respect to t; zero beyond the radius.
struct PriorJet {
  double w = 0, dw = 0, ddw = 0;
};
PriorJet evaluate(const LmePrior&, double t);

}  // namespace umtet
