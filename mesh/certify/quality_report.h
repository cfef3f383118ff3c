#pragma once

#include <cstddef>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Mean ratio Q of every tet, eq. (6), equal to the bit to the values in certificates; -1 where it is not a number
/// (coordinates not finite, or all corners in one point). Uses all threads. \pre indices of C are in range
std::vector<double> mean_ratios(const TetMesh& mesh);
/// Writes the mean ratios of Q.size() tets, from tet `first` on, into Q.
void measure_mean_ratios(const TetMesh& mesh, std::vector<double>& Q, std::size_t first = 0);

/// Quality vectors Q(S) = asc(q_1, ..., q_alpha), q_i = min Q(K) over the tets K at vertex i
///                                                                              [Rangarajan2018, Section 3.3]
/// The first component is the least quality; a bad tet appears up to four times. Vertices without a tet are omitted.
struct QualityVectors {
  std::vector<double> all;       ///< qualities of all tets of the mesh
  std::vector<double> boundary;  ///< qualities of the tets with a positive vertex, T_boundary of Fig. 8
};

/// Computes the quality vectors of a mesh.
/// @param Q  mean ratio of each tet
/// \throw std::invalid_argument if Q and C differ in size
QualityVectors quality_vectors(const std::vector<Tet>& C, const std::vector<double>& Q,
                               const std::vector<int>& positive_vertices, std::size_t n_vertices);

/// Position of a quantile among n ascending values: the two values around it, and the fraction of the way between them.
struct QuantilePlace {
  std::size_t below, above;
  double part;

  double of(double value_below, double value_above) const;
};
/// The position of quantile p. \pre n > 0
QuantilePlace quantile_place(std::size_t n, double p);

/// Quantile p in [0, 1] of ascending values, linear between neighbours (numpy's default); NaN for no values.
double quantile(const std::vector<double>& ascending, double p);
/// Quantile of n values, given only the lowest of them: at least p (n - 1) + 2 values, or all n.
double quantile(const std::vector<double>& lowest, std::size_t n, double p);

}  // namespace umtet
