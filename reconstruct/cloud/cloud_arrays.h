#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Calls visit(array, description) for every array of a cloud with an entry per sample, the points first. Optional
/// arrays that are empty are skipped.
template <class Cloud, class Visit>
void for_each_array(Cloud& cloud, Visit&& visit) {
  const auto if_there = [&](auto& array, const std::string& name) {
    if (!array.empty()) visit(array, name);
  };
  visit(cloud.points, "points");
  if_there(cloud.normals, "normals");
  if_there(cloud.labels, "labels");
  if_there(cloud.origins, "origins");
  if_there(cloud.colours, "colours");
  if_there(cloud.counts, "counts");
  if_there(cloud.spreads, "spreads");
  for (auto& field : cloud.fields) visit(field.values, "values of " + field.name);
}

/// Checks a cloud. \throw std::invalid_argument for an array whose length differs from the number of points
void require_equal_lengths(const OrientedPointCloud& cloud);

/// Names of the data of samples besides position and normal: "rgb" if there are colours, and the names of the fields.
std::vector<std::string> field_names(const OrientedPointCloud& cloud);

/// Keeps these samples and drops the others. @param rows  ascending
void keep_samples(OrientedPointCloud& cloud, const std::vector<std::uint32_t>& rows);

/// Normalises a normal. A normal that is unit to rounding is unchanged, so that a written cloud is read back bit by
/// bit.
/// @param n  finite, not zero
Vec3 unit_normal(Vec3 n);

/// The number of points that a sample represents. @param counts  OrientedPointCloud::counts
inline std::size_t count_of(const std::vector<int>& counts, std::size_t sample) {
  return counts.empty() ? 1 : static_cast<std::size_t>(counts[sample]);
}
/// The number of points that all samples represent.
inline std::size_t sum_of_counts(const std::vector<int>& counts, std::size_t n_samples) {
  return counts.empty() ? n_samples : std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

/// Every m-th of the rows 0 .. size - 1. If rows represent several samples, the rows of every m-th sample.
/// @param m      >= 1
/// @param count  count(row) is the number of samples that the row represents
template <class Count>
std::vector<std::size_t> every_mth(std::size_t m, std::size_t size, Count&& count) {
  std::vector<std::size_t> rows;
  std::size_t passed = 0;
  for (std::size_t row = 0; row < size; ++row) {
    const std::size_t next = (passed + m - 1) / m * m;
    passed += count(row);
    if (next < passed) rows.push_back(row);
  }
  return rows;
}

}  // namespace umtet
