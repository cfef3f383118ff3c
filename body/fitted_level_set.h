#pragma once

#include <functional>
#include <utility>

#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// Levels of psi with a smaller spacing, in edges of the mesh, are left out: faces fold over detail they cannot follow.
inline constexpr double kLeastSpacing = .7;

/// A level set of which a mesh needs the coarser levels, and now and then all. The finer ones, which are most of its
/// memory, may be put aside where they can be had again.
class FittedLevelSet {
 public:
  /// @param again  makes the same level set, to the bit; empty: nothing is put aside
  FittedLevelSet(LevelSet psi, std::function<LevelSet()> again = {})  // NOLINT(google-explicit-constructor)
      : held_(std::move(psi)), again_(std::move(again)) {}

  /// With all levels. Not to be called by several threads. \throw what `again` throws
  const LevelSet& whole() const;
  /// LevelSet::band_limited() of it. As whole().
  LevelSet band_limited(double spacing) const;
  /// What is in memory.
  const LevelSet& held() const { return held_; }
  /// Levels of a smaller spacing are put aside. Where they could not be had again, what evaluations have made of them
  /// is freed. Nobody may evaluate this level set, or a copy of it, meanwhile.
  void put_aside_below(double spacing);

 private:
  mutable LevelSet held_;
  mutable bool is_whole_ = true;
  std::function<LevelSet()> again_;
};

}  // namespace umtet
