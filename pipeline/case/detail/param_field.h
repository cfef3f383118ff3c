#pragma once

#include <string>

#include "pipeline/case/parameters.h"

namespace umtet::detail {

/// The least value of parameters that must be > 0.
inline constexpr double kAboveZero = 1e-300;

/// The row of a key. \throw UsageError that names the nearest
const ParamField& field(const std::string& key);

/// A value as TOML reads it back.
std::string print(const ParamValue& value);

}  // namespace umtet::detail
