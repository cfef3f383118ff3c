#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/sizes/size_function.h"
#include "mesh/sizes/source_tree.h"

namespace umtet {

/// Parameters of a SizeField.
struct SizeFieldParams {
  double grade = .3;  ///< maximum growth of edge length per unit distance: the Lipschitz constant of h
  double h_min = 0;   ///< model units
  double h_max = std::numeric_limits<double>::infinity();
};

/// All broken constraints: 0 < grade < infinity, 0 < h_min <= h_max, h_min finite.
std::vector<std::string> problems(const SizeFieldParams&);

/// Size field: the required edge length at each point                         [Persson2006; Alauzet2010]
///
///     h(x) = min(h_max, f(x), min_i h_i + grade max(0, |x - x_i| - radius_i)),    f and all h_i at least h_min
///
/// A single source gives a cone, so the minimum over all has the Lipschitz constant `grade`. In free space it is the
/// limit of the gradient-limiting equation dh/dt + |grad h| = min(|grad h|, grade) of [Persson2006]. f is limited in
/// the same way, by sources at the lower ends of its steep regions (steep_ends()).
///
/// Redundant and nearly redundant sources are dropped. All results are within 5 % of the formula. Queries are
/// thread-safe and do not allocate; the result does not depend on the number of threads.
class SizeField {
 public:
  /// \throw std::invalid_argument for problems(), a source with h <= 0, radius < 0 or a value that is not a number, or
  ///        an empty box
  /// \throw Cancelled
  /// Cost: O(n log n), plus the cost of steep_ends()
  SizeField(std::vector<SizeSource> sources, const SizeFieldParams& params, std::optional<SizeFunction> f = {},
            const Context& context = {});

  /// The minimum of this field and of the cones of additional sources, which may be below h_min. If these require at
  /// least 5 % more everywhere, the field stays the same to the bit, and so does an octree made for it.
  /// \throw std::invalid_argument under the conditions of the constructor
  SizeField refined(std::vector<SizeSource> more) const;

  double at(const Vec3& x) const;
  /// The least size in a cube. f, whose slope is unknown, contributes its minimum over the centre and the corners. If f
  /// is as flat as `grade`, this exceeds its true minimum by at most 1.12 grade half_width.
  double least_in(const Vec3& centre, double half_width) const;

  const SizeFieldParams& params() const { return params_; }
  /// The sources that were kept, without those of refined().
  const std::vector<SizeSource>& sources() const { return tree_.sources(); }

 private:
  double of_function(const Vec3& x) const;

  SizeFieldParams params_;
  std::optional<SizeFunction> f_;
  SourceTree tree_, more_;
  double least_of_more_ = std::numeric_limits<double>::infinity();
};

}  // namespace umtet
