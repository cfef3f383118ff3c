#include "tools/sensitivity/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "tools/star_costs/random.h"

namespace umtet::sensitivity {
namespace {

constexpr std::size_t kResamples = 4000;  // the ends of the interval are then known to a fiftieth of its length
constexpr double kTail = .025;

}  // namespace

Paired paired(const std::vector<double>& differences) {
  const std::size_t n = differences.size();
  const double sum = std::accumulate(differences.begin(), differences.end(), 0.);
  star_costs::Random random(n);
  std::vector<double> means(kResamples);
  for (double& mean : means) {
    double resampled = 0;
    for (std::size_t i = 0; i < n; ++i) resampled += differences[random.bits() % n];
    mean = resampled / static_cast<double>(n);
  }
  std::sort(means.begin(), means.end());
  // Of all signs, how many make a sum as great? These signs are among them.
  std::size_t as_great = 1;
  for (std::size_t k = 0; k < kResamples; ++k) {
    double flipped = 0;
    std::uint64_t signs = 0;
    for (std::size_t i = 0; i < n; ++i, signs >>= 1) {
      if (i % 64 == 0) signs = random.bits();
      flipped += (signs & 1) != 0 ? differences[i] : -differences[i];
    }
    as_great += std::abs(flipped) >= (1 - 1e-12) * std::abs(sum);
  }
  const auto tail = static_cast<std::size_t>(kTail * static_cast<double>(kResamples));
  return {sum / static_cast<double>(n), means[tail], means[kResamples - 1 - tail],
          static_cast<double>(as_great) / static_cast<double>(kResamples + 1)};
}

}  // namespace umtet::sensitivity
