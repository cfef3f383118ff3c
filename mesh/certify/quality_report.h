#pragma once

#include <cstddef>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Q of every tet, eq. (6), to the bit as certificates find it; -1 where it is not a number (not finite, or all in one
/// point). By all threads. \pre indices of C are in range
std::vector<double> mean_ratios(const TetMesh& mesh);
/// The same of Q.size() tets from `first` on, into Q.
void measure_mean_ratios(const TetMesh& mesh, std::vector<double>& Q, std::size_t first = 0);

/// Quality vectors Q(S) = asc(q_1, ..., q_alpha), q_i = min Q(K) over the tets K at vertex i
///                                                                              [Rangarajan2018, Section 3.3]
/// Their first component is the least quality; a bad tet appears up to four times. Vertices without a tet are left out.
struct QualityVectors {
  std::vector<double> all;       ///< of the mesh
  std::vector<double> boundary;  ///< of its tets with a positive vertex, T_boundary of Fig. 8
};

/// @param Q  of each tet
/// \throw std::invalid_argument when Q and C differ in size
QualityVectors quality_vectors(const std::vector<Tet>& C, const std::vector<double>& Q,
                               const std::vector<int>& positive_vertices, std::size_t n_vertices);

/// Between which of n ascending values a quantile lies, and how far from the one to the other.
struct QuantilePlace {
  std::size_t below, above;
  double part;

  double of(double value_below, double value_above) const;
};
/// \pre n > 0
QuantilePlace quantile_place(std::size_t n, double p);

/// Quantile p in [0, 1] of ascending values, linear between neighbours (numpy's default). NaN without values.
double quantile(const std::vector<double>& ascending, double p);
/// The same of n values of which only the lowest are given, at least as many as the quantile needs: p (n - 1) + 2 or n.
double quantile(const std::vector<double>& lowest, std::size_t n, double p);

}  // namespace umtet
