#include "reconstruct/cloud/cloud_arrays.h"

#include <cmath>
#include <stdexcept>

#include "common/formatted.h"

namespace umtet {

void require_equal_lengths(const OrientedPointCloud& cloud) {
  const std::size_t n = cloud.points.size();
  for_each_array(cloud, [n](const auto& array, const std::string& name) {
    if (array.size() == n) return;
    throw std::invalid_argument(formatted("%zu points but %zu %s: must be equal", n, array.size(), name.c_str()));
  });
}

std::vector<std::string> field_names(const OrientedPointCloud& cloud) {
  std::vector<std::string> names;
  if (!cloud.colours.empty()) names.emplace_back("rgb");
  for (const SampleField& field : cloud.fields) names.push_back(field.name);
  return names;
}

void keep_samples(OrientedPointCloud& cloud, const std::vector<std::uint32_t>& rows) {
  if (rows.size() == cloud.points.size()) return;
  for_each_array(cloud, [&rows](auto& array, const std::string&) {
    for (std::size_t k = 0; k < rows.size(); ++k) array[k] = array[rows[k]];
    array.resize(rows.size());
  });
}

Vec3 unit_normal(Vec3 n) {
  constexpr double kRounding = 1e-14;  // of three squares, a root and a quotient, a few times
  if (std::abs(n.stableNorm() - 1) <= kRounding) return n;
  n /= n.cwiseAbs().maxCoeff();  // the squares of very short and very long normals are no doubles
  return n / n.norm();
}

}  // namespace umtet
