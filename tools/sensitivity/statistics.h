#pragma once

#include <vector>

namespace umtet::sensitivity {

/// What paired differences say of their mean.
struct Paired {
  double mean = 0;
  double low = 0, high = 0;  ///< 95 % confidence interval: percentile bootstrap over the bodies
  double p = 1;              ///< of a sign-flip permutation test of mean = 0, two-sided
};

/// The same numbers for the same differences. \pre not empty
Paired paired(const std::vector<double>& differences);

}  // namespace umtet::sensitivity
