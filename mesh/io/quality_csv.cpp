#include "mesh/io/quality_csv.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mesh/io/checked_file.h"

namespace umtet {

std::vector<std::size_t> quality_csv_indices(const std::vector<std::size_t>& lengths) {
  std::size_t longest = 0;
  std::set<std::size_t> indices;
  for (const std::size_t n : lengths) {
    longest = std::max(longest, n);
    if (n > 0) indices.insert(n);
  }
  constexpr double kPerDecade = 100;
  for (std::size_t i = 1; i <= std::min<std::size_t>(longest, 100); ++i) indices.insert(i);
  for (int step = 1;; ++step) {
    const auto i = static_cast<std::size_t>(std::llround(100 * std::pow(10.0, step / kPerDecade)));
    if (i > longest) break;
    indices.insert(i);
  }
  return {indices.begin(), indices.end()};
}

void write_quality_csv(const std::filesystem::path& path, const std::vector<std::size_t>& indices,
                       const std::vector<SampledCurve>& curves) {
  CheckedFile file(path);
  file.text("index");
  for (const SampledCurve& c : curves) file.text(",").text(c.name);
  file.text("\n");
  for (std::size_t line = 0; line < indices.size(); ++line) {
    file.number(indices[line]);
    for (const SampledCurve& c : curves) {
      file.text(",");
      if (line < c.values.size()) file.number(c.values[line]);
    }
    file.text("\n");
  }
  file.close();
}

void write_quality_csv(const std::filesystem::path& path, const std::vector<QualityCurve>& curves) {
  std::vector<std::size_t> lengths;
  for (const QualityCurve& c : curves) lengths.push_back(c.values.size());
  const std::vector<std::size_t> indices = quality_csv_indices(lengths);
  std::vector<SampledCurve> sampled;
  for (const QualityCurve& c : curves) {
    sampled.push_back({c.name, {}});
    for (const std::size_t i : indices) {
      if (i <= c.values.size()) sampled.back().values.push_back(c.values[i - 1]);
    }
  }
  write_quality_csv(path, indices, sampled);
}

}  // namespace umtet
