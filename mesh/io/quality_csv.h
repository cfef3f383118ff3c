#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace umtet {

/// A curve of Fig. 8: a quality vector with its name, which is a CSV column.
struct QualityCurve {
  std::string name;
  std::vector<double> values;
};

/// Writes a CSV file with the column `index` (1-based, as in Fig. 8) and one column per curve, empty beyond the end of
/// a curve.
///
/// Contains all indices from 1 to 100, then 100 per decade, and the last index of each curve. The file has less than a
/// thousand lines and is exact for the bad tets.
/// \throw std::system_error naming the path if writing fails
void write_quality_csv(const std::filesystem::path& path, const std::vector<QualityCurve>& curves);

/// The indices of the lines of such a file, ascending, for curves of these lengths.
std::vector<std::size_t> quality_csv_indices(const std::vector<std::size_t>& lengths);

/// A curve known only at the indices of the file: values[i] is the value at the i-th index that is not beyond its end.
struct SampledCurve {
  std::string name;
  std::vector<double> values;
};
/// Writes the same file. @param indices  quality_csv_indices()
void write_quality_csv(const std::filesystem::path& path, const std::vector<std::size_t>& indices,
                       const std::vector<SampledCurve>& curves);

}  // namespace umtet
