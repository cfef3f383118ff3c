#pragma once

#include <array>
#include <span>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Solution method for eq. (5), the max-min problem of a vertex on a line.
enum class MaxMin {
  Exact,         ///< the exact argmax, from maxima and crossings of the quality curves             [Rangarajan2017]
  GoldenSection  ///< ten golden-section steps: faster, suboptimal                   [Rangarajan2018, Section 3.8(d)]
};

/// The default method: Exact if the build has GSL, else GoldenSection.
#ifdef UMTET_WITH_GSL
inline constexpr MaxMin kBestMaxMin = MaxMin::Exact;
#else
inline constexpr MaxMin kBestMaxMin = MaxMin::GoldenSection;
#endif

/// Maximum number of tets at a vertex. Vertices of the tilings have at most 80, at corners of cubes; larger rings are
/// rejected at construction.
inline constexpr int kMaxRing = 128;

/// Number of tets processed at once.
inline constexpr int kPackSize = 4;

/// The 1-ring of a vertex, as functions of its displacement y                        [Rangarajan2018, eq. (6)]
///
///   V_j(y) = v_j - n_j . y            six times the signed volume
///   L_j(y) = l_j + s_j . y + 3 |y|^2  sum of squared edge lengths
///   Q_j = 12 cbrt(1/4) cbrt(f_j),     f_j = V_j |V_j| / L_j^3
///
/// Qualities are compared through f, which needs no roots. Storage is a structure of arrays; the elements that fill the
/// last SIMD pack repeat the last tet, which does not change a minimum.
struct OneRing {
  int n = 0;          ///< number of tets
  double f_here = 0;  ///< min_j f_j(0)
  alignas(32) std::array<double, kMaxRing> nx, ny, nz, v, sx, sy, sz, l;

  /// The ring of a vertex at x, with the tets (x, p, q, r) for each face p, q, r, all positively oriented.
  /// \pre at least one and at most kMaxRing faces
  OneRing(const Vec3& x, std::span<const Vec3> V, std::span<const Triangle> faces);
  /// min_j f_j(y)
  double min_f(const Vec3& y) const;
};

/// The 1-ring restricted to a line y = lambda d, |d| = 1:  V_j = v0_j + v1_j lambda,  L_j = l0_j + l1_j lambda + 3
/// lambda^2
struct RingOnLine {
  int n = 0;
  alignas(32) std::array<double, kMaxRing> v0, v1, l0, l1;

  RingOnLine(const OneRing& ring, const Vec3& d);
};

/// Q of a tet with the given f.
double quality_of(double f);

/// f of a tet with the given Q.
double f_of_quality(double Q);

/// Result of max_min().
struct MaxMinResult {
  double lambda = 0;     ///< lambda_opt, 0 if nothing better was found or the ring is not valid at 0
  double f = 0;          ///< min_j f_j(lambda)
  double f_at_zero = 0;  ///< min_j f_j(0)
  int evaluations = 0;   ///< evaluations of the ring
};

/// Solves the max-min problem of a vertex on a line: argmax_lambda min_j Q_j(lambda)    [Rangarajan2018, eq. (5)]
///
/// Each Q_j is quasi-concave where V_j > 0, and so is their minimum. Its maximum is at a crossing of a rising and a
/// falling Q_j, or at the maximum of one of them.
/// - Exact keeps a rising and a falling tet and the bracket between them. It evaluates at the maximum of one (a root of
///   a quadratic) or at the crossing of the pair (a root of V_i^2 L_j^3 - V_j^2 L_i^3, degree 8). A tet that is lower
///   there replaces one of the two.
/// - GoldenSection shrinks the interval in which all V_j > 0.
///
/// The quality never drops: f >= f_at_zero.
/// \throw std::logic_error for Exact in a build without GSL
MaxMinResult max_min(const RingOnLine& ring, MaxMin method);

}  // namespace umtet
