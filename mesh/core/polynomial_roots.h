#pragma once

#include <span>

namespace umtet {

/// Maximum degree of the crossing polynomials of the mean ratio, which is 8     [Rangarajan2018, Section 3.8(b)]
inline constexpr int kMaxDegree = 8;

/// The root of c_0 + c_1 s + ... + c_n s^n in [lo, hi], by Brent's method, to a few ulps of the larger end. If the
/// values at the ends do not differ in sign, or a coefficient is not finite, returns the end with the smaller |value|.
/// Does not allocate after the first call in a thread. Thread-safe.
/// \pre  at most kMaxDegree + 1 coefficients, lo <= hi
double bracketed_root(std::span<const double> coefficients, double lo, double hi);

}  // namespace umtet
