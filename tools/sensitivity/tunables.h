#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/sensitivity/fit.h"

namespace umtet::sensitivity {

/// A parameter and the values that are tried in place of its default.
struct Tunable {
  std::string name;  ///< of the struct and the field
  std::vector<double> values;
  std::function<void(Settings&, double)> set;
  std::function<double(const Settings&)> get;
  bool is_of_moving = false;  ///< of a mesh that begins from the one before
};

const std::vector<Tunable>& tunables();

}  // namespace umtet::sensitivity
