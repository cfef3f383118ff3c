#pragma once

#include <string>

#include "pipeline/case/parameters.h"

namespace umtet::detail {

/// The minimum of parameters that must be > 0.
inline constexpr double kAboveZero = 1e-300;

/// Returns the field of a key. \throw UsageError  names the nearest key
const ParamField& field(const std::string& key);

/// Returns a value in TOML.
std::string print(const ParamValue& value);

}  // namespace umtet::detail
