#pragma once

#include <functional>
#include <string>

#include "pipeline/case/parameters.h"

namespace umtet {

/// A message of the pipeline, which names flags of the program, with what `name` calls these parameters.
std::string without_flags(std::string message, const std::function<std::string(const ParamField&)>& name);

}  // namespace umtet
