#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/sizes/size_function.h"
#include "mesh/sizes/source_tree.h"

namespace umtet {

struct SizeFieldParams {
  double grade = .3;  ///< the most that h grows a length: its Lipschitz constant
  double h_min = 0;   ///< model units
  double h_max = std::numeric_limits<double>::infinity();
};

/// Every broken constraint: 0 < grade < infinity, 0 < h_min <= h_max, h_min finite.
std::vector<std::string> problems(const SizeFieldParams&);

/// The edge length that is wanted at each point                                        [Persson2006; Alauzet2010]
///
///     h(x) = min(h_max, f(x), min_i h_i + grade max(0, |x - x_i| - radius_i)),    f and all h_i at least h_min
///
/// A source alone gives a cone, so the least of all has the Lipschitz constant `grade`: in free space that is what the
/// gradient-limiting equation dh/dt + |grad h| = min(|grad h|, grade) of [Persson2006] tends to. f is limited in the
/// same way, by sources at the lower ends of its steep places (steep_ends()).
///
/// Sources that others make superfluous are left out, and nearly superfluous ones, too. All answers are within 5 % of
/// the formula.
/// Queries are thread-safe and do not allocate; the result does not depend on the number of threads.
class SizeField {
 public:
  /// \throw std::invalid_argument  problems(), a source with h <= 0, radius < 0 or what is no number, an empty box
  /// \throw Cancelled
  /// Cost: O(n log n), and that of steep_ends()
  SizeField(std::vector<SizeSource> sources, const SizeFieldParams& params, std::optional<SizeFunction> f = {},
            const Context& context = {});

  /// The least of this field and of the cones of some more sources, which may be below h_min. Where they ask for at
  /// least 5 % more the field stays as it is, to the bit, and with it the octree made for it.
  /// \throw std::invalid_argument  as above
  SizeField refined(std::vector<SizeSource> more) const;

  double at(const Vec3& x) const;
  /// The least in a cube. f, whose slope is not known, counts with its least at the middle and the corners: where it is
  /// as flat as `grade` that is at most 1.12 grade half_width above.
  double least_in(const Vec3& centre, double half_width) const;

  const SizeFieldParams& params() const { return params_; }
  /// Those that are left, without those of refined().
  const std::vector<SizeSource>& sources() const { return tree_.sources(); }

 private:
  double of_function(const Vec3& x) const;

  SizeFieldParams params_;
  std::optional<SizeFunction> f_;
  SourceTree tree_, more_;
  double least_of_more_ = std::numeric_limits<double>::infinity();
};

}  // namespace umtet
