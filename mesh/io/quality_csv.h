#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace umtet {

/// One curve of Fig. 8: a name that is a CSV column, and a quality vector.
struct QualityCurve {
  std::string name;
  std::vector<double> values;
};

/// CSV with columns `index` (1-based, as in Fig. 8) and one per curve, empty behind the end of a curve.
///
/// Indices 1 to 100 are all there, then 100 per decade and the last of each curve: the file stays below a thousand
/// lines and is exact where the bad tets are.
/// \throw std::system_error naming the path when writing fails
void write_quality_csv(const std::filesystem::path& path, const std::vector<QualityCurve>& curves);

/// The indices of its lines, ascending, of curves of these lengths.
std::vector<std::size_t> quality_csv_indices(const std::vector<std::size_t>& lengths);

/// A curve of which only these are known: values[i] at the i-th of the indices that are not behind its end.
struct SampledCurve {
  std::string name;
  std::vector<double> values;
};
/// The same file. @param indices  quality_csv_indices()
void write_quality_csv(const std::filesystem::path& path, const std::vector<std::size_t>& indices,
                       const std::vector<SampledCurve>& curves);

}  // namespace umtet
