#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace umtet {

/// Quality vector Q(S) = asc(q_1, ..., q_alpha) of a mesh, q_i = min Q(K) over the tets K at vertex i
///                                                                              [Rangarajan2018, Section 3.3]
/// Its first component is the least quality in the mesh; a bad tet appears up to four times. Vertices without a tet
/// are left out; a tet whose quality is not a number (not finite, or all in one point) counts as -1.
/// @param C  connectivity, indices into V
std::vector<double> quality_vector(const std::vector<Tet>& C, const std::vector<Vec3>& V);

/// The tets with at least one of the given vertices: with I^+ it is the mesh T_boundary of Fig. 8.
std::vector<Tet> tets_at(const std::vector<Tet>& C, const std::vector<int>& vertices, std::size_t n_vertices);

/// Quantile p in [0, 1] of ascending values, linear between neighbours (numpy's default). NaN without values.
double quantile(const std::vector<double>& ascending, double p);
/// The same of n values of which only the lowest are given, at least as many as the quantile needs: p (n - 1) + 2 or n.
double quantile(const std::vector<double>& lowest, std::size_t n, double p);

/// One curve of Fig. 8: a name that is a CSV column, and a quality vector.
struct QualityCurve {
  std::string name;
  std::vector<double> values;
};

/// The six curves of Fig. 8: `omega_h`, `projected`, `final` for the mesh, and the same with prefix `boundary_` for its
/// tets with a positive vertex.
/// \throw std::invalid_argument when the three coordinate lists differ in size
std::vector<QualityCurve> quality_curves(const std::vector<Tet>& C, const std::vector<int>& positive_vertices,
                                         const std::vector<Vec3>& omega_h, const std::vector<Vec3>& projected,
                                         const std::vector<Vec3>& final);

/// CSV with columns `index` (1-based, as in Fig. 8) and one per curve, empty behind the end of a curve.
///
/// Indices 1 to 100 are all there, then 100 per decade and the last of each curve: the file stays below a thousand
/// lines and is exact where the bad tets are.
/// \throw std::system_error naming the path when writing fails
void write_quality_csv(const std::filesystem::path& path, const std::vector<QualityCurve>& curves);

}  // namespace umtet
