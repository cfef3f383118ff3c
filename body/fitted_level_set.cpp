#include "body/fitted_level_set.h"

namespace umtet {

const LevelSet& FittedLevelSet::whole() const {
  if (!is_whole_) held_ = again_();
  is_whole_ = true;
  return held_;
}

LevelSet FittedLevelSet::band_limited(double spacing) const {
  // The next level has half the spacing.
  const bool is_held = is_whole_ || held_.spacing() / 2 < spacing;
  return (is_held ? held_ : whole()).band_limited(spacing);
}

void FittedLevelSet::put_aside_below(double spacing) {
  held_.forget_below(spacing);
  if (!again_) return;
  LevelSet left = held_.band_limited(spacing);
  is_whole_ = is_whole_ && left.n_levels() == held_.n_levels();
  held_ = std::move(left);
}

}  // namespace umtet
