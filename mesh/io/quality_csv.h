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

}  // namespace umtet
