#pragma once

#include <array>
#include <span>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// How eq. (5), the max-min problem of a vertex on a line, is solved.
enum class MaxMin {
  Exact,         ///< the argmax itself, from maxima and crossings of the quality curves      [Rangarajan2017]
  GoldenSection  ///< ten golden-section steps: faster, suboptimal                   [Rangarajan2018, Section 3.8(d)]
};

/// The default of everything that solves it: Exact where the build has GSL, else GoldenSection.
#ifdef UMTET_WITH_GSL
inline constexpr MaxMin kBestMaxMin = MaxMin::Exact;
#else
inline constexpr MaxMin kBestMaxMin = MaxMin::GoldenSection;
#endif

/// Tets a vertex may have. The tilings have at most 80, at corners of cubes; a ring beyond this is refused where rings
/// are built.
inline constexpr int kMaxRing = 128;

/// Tets handled at once.
inline constexpr int kPackSize = 4;

/// The 1-ring of a vertex as functions of its displacement y:                        [Rangarajan2018, eq. (6)]
///
///   V_j(y) = v_j - n_j . y            six times the signed volume
///   L_j(y) = l_j + s_j . y + 3 |y|^2  sum of squared edge lengths
///   Q_j = 12 cbrt(1/4) cbrt(f_j),     f_j = V_j |V_j| / L_j^3
///
/// Qualities are compared through f, which needs no roots. Structure of arrays; the elements that fill up the last SIMD
/// pack repeat the last tet, which changes no minimum.
struct OneRing {
  int n = 0;          ///< tets
  double f_here = 0;  ///< min_j f_j(0)
  alignas(32) std::array<double, kMaxRing> nx, ny, nz, v, sx, sy, sz, l;

  /// The ring of a vertex at x, whose tets are (x, p, q, r) for each face p, q, r, all positively oriented.
  /// \pre at least one and at most kMaxRing faces
  OneRing(const Vec3& x, std::span<const Vec3> V, std::span<const Triangle> faces);
  /// min_j f_j(y).
  double min_f(const Vec3& y) const;
};

/// The same on a line y = lambda d, |d| = 1:  V_j = v0_j + v1_j lambda,  L_j = l0_j + l1_j lambda + 3 lambda^2.
struct RingOnLine {
  int n = 0;
  alignas(32) std::array<double, kMaxRing> v0, v1, l0, l1;

  RingOnLine(const OneRing& ring, const Vec3& d);
};

/// Q of a tet whose f is given.
double quality_of(double f);

/// The f of a tet whose Q is given.
double f_of_quality(double Q);

struct MaxMinResult {
  double lambda = 0;     ///< lambda_opt, 0 if nothing better was found or the ring is not valid at 0
  double f = 0;          ///< min_j f_j(lambda)
  double f_at_zero = 0;  ///< min_j f_j(0)
  int evaluations = 0;   ///< of the ring
};

/// argmax_lambda min_j Q_j(lambda)                                                    [Rangarajan2018, eq. (5)]
///
/// Each Q_j is quasi-concave where V_j > 0, so the least of them is, and its maximum is where the rising and the
/// falling members meet or at the maximum of one of them. Exact keeps a rising and a falling tet with the bracket
/// between them, goes to the maximum of one (a quadratic's root) or to the crossing of the pair (a root of
/// V_i^2 L_j^3 - V_j^2 L_i^3, degree 8), and lets a tet that is lower there replace one of the two.
/// GoldenSection shrinks the interval where all V_j > 0.
/// The quality never drops: f >= f_at_zero.
/// \pre  Exact needs a build with GSL, otherwise it throws std::logic_error
MaxMinResult max_min(const RingOnLine& ring, MaxMin method);

}  // namespace umtet
