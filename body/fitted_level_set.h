#pragma once

#include <functional>
#include <utility>

#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// Levels of psi with a smaller spacing, in edge lengths of the mesh, are omitted: faces fold over detail that they
/// cannot follow.
inline constexpr double kLeastSpacing = .7;

/// A level set whose finer levels can be released. A mesh needs the coarser levels, and only occasionally all levels.
/// The finer levels take most of the memory, so they may be released if they can be made again.
class FittedLevelSet {
 public:
  /// @param again  makes the same level set again, bit by bit; if empty, no level is released
  FittedLevelSet(LevelSet psi, std::function<LevelSet()> again = {})  // NOLINT(google-explicit-constructor)
      : held_(std::move(psi)), again_(std::move(again)) {}

  /// Returns the level set with all levels. Not thread-safe. \throw any exception of `again`
  const LevelSet& whole() const;
  /// Returns whole().band_limited(spacing), with the same restrictions as whole().
  LevelSet band_limited(double spacing) const;
  /// Returns the levels that are in memory.
  const LevelSet& held() const { return held_; }
  /// Releases the levels of a smaller spacing. If they could not be made again, it keeps them and frees only the data
  /// that evaluations have cached. No thread may evaluate this level set or a copy of it during the call.
  void put_aside_below(double spacing);

 private:
  mutable LevelSet held_;
  mutable bool is_whole_ = true;
  std::function<LevelSet()> again_;
};

}  // namespace umtet
