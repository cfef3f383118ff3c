#pragma once

#include <span>
#include <vector>

namespace umtet {

/// Maximum degree of the crossing polynomials of the mean ratio, which is 8     [Rangarajan2018, Section 3.8(b)]
inline constexpr int kMaxDegree = 8;

/// The root of c_0 + c_1 s + ... + c_n s^n in [lo, hi], by Brent's method, to a few ulps of the larger end. If the
/// values at the ends do not differ in sign, or a coefficient is not finite, returns the end with the smaller |value|.
/// Does not allocate after the first call in a thread. Thread-safe.
/// \pre  at most kMaxDegree + 1 coefficients, lo <= hi
double bracketed_root(std::span<const double> coefficients, double lo, double hi);

/// All real roots of c_0 + c_1 s + ... + c_n s^n, ascending, from the eigenvalues of the companion matrix. Multiple
/// roots are repeated. A complex pair counts as real if its imaginary part is below imaginary_tol times max(1, |root|):
/// a double root splits by about the square root of the rounding error.
/// \throw std::runtime_error if the eigenvalue iteration fails, std::invalid_argument for non-finite coefficients
std::vector<double> real_roots(std::span<const double> coefficients, double imaginary_tol = 1e-6);

}  // namespace umtet
