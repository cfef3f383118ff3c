#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Calls visit(array, what it holds) for every array of a cloud that has an entry a sample, the points first. Those
/// that may be missing and are empty are left out.
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

/// \throw std::invalid_argument  an array that has not as many entries as there are points
void require_equal_lengths(const OrientedPointCloud& cloud);

/// What a sample carries besides its place and side: "rgb" where there are colours, and the names of the fields.
std::vector<std::string> field_names(const OrientedPointCloud& cloud);

/// Leaves these samples. @param rows  ascending
void keep_samples(OrientedPointCloud& cloud, const std::vector<std::uint32_t>& rows);

}  // namespace umtet
