#include "mesh/io/quality_csv.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mesh/io/checked_file.h"

namespace umtet {

void write_quality_csv(const std::filesystem::path& path, const std::vector<QualityCurve>& curves) {
  std::size_t longest = 0;
  std::set<std::size_t> indices;
  for (const QualityCurve& c : curves) {
    longest = std::max(longest, c.values.size());
    if (!c.values.empty()) indices.insert(c.values.size());
  }
  constexpr double kPerDecade = 100;
  for (std::size_t i = 1; i <= std::min<std::size_t>(longest, 100); ++i) indices.insert(i);
  for (int step = 1;; ++step) {
    const auto i = static_cast<std::size_t>(std::llround(100 * std::pow(10.0, step / kPerDecade)));
    if (i > longest) break;
    indices.insert(i);
  }
  CheckedFile file(path);
  file.text("index");
  for (const QualityCurve& c : curves) file.text(",").text(c.name);
  file.text("\n");
  for (const std::size_t i : indices) {
    file.number(i);
    for (const QualityCurve& c : curves) {
      file.text(",");
      if (i <= c.values.size()) file.number(c.values[i - 1]);
    }
    file.text("\n");
  }
  file.close();
}

}  // namespace umtet
