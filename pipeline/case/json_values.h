#pragma once

#include <Eigen/Core>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

namespace umtet {

using Json = nlohmann::ordered_json;

// Conversions of values in the documents that the program writes and reads back. The functions that read throw
// Json::exception if the document contains a value of another type.

/// Returns null if there is no value.
template <class T>
Json json_of(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

inline Json json_of(const Eigen::Vector3d& x) { return {x.x(), x.y(), x.z()}; }

/// Reads a number. JSON contains null in place of NaN and infinity; null is read as NaN.
inline double number_from(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

inline Eigen::Vector3d vector_from(const Json& json) {
  return {number_from(json.at(0)), number_from(json.at(1)), number_from(json.at(2))};
}

}  // namespace umtet
