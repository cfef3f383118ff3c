#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mesh/base/id_list.h"
#include "mesh/base/id_set.h"
#include "mesh/fast/defects/patch_state.h"
#include "mesh/fast/repair/detail/flip_candidates.h"
#include "mesh/fast/repair/repair.h"
#include "mesh/fast/smoothing/p_norm_smoothing.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet::detail {

using TetIds = std::array<std::int64_t, 4>;

/// Positions of the vertices of a mesh under repair: moved by repair, or those of the layer, kept, or of the background
/// mesh.
class Positions {
 public:
  /// Keeps references. @param kept  ascending
  Positions(const BackgroundMesh& background, const BackgroundLayer& layer, const std::vector<KeptVertex>& kept)
      : background_(background), layer_(layer), kept_(kept) {}

  Vec3 of(std::int64_t v) const {
    std::size_t from = 0;
    return of(v, from);
  }
  /// @param from  index in the layer where the search begins; receives the index found, for the next greater vertex
  Vec3 of(std::int64_t v, std::size_t& from) const;
  void move(std::int64_t v, const Vec3& x);
  bool has_moved(std::int64_t v) const { return moved_.test(v); }

 private:
  const BackgroundMesh& background_;
  const BackgroundLayer& layer_;
  const std::vector<KeptVertex>& kept_;
  IdList moved_;
  std::vector<Vec3> moved_to_;
};

/// The trials that are made for one tet.
struct FlipEffort {
  /// smooth_all_vertices() is applied to patches without misaligned faces that smoothing leaves below the target, at
  /// first without flips.
  bool all_vertices = false;
  std::size_t most_singles = std::numeric_limits<std::size_t>::max();  ///< single flips tried, most promising first
  bool pairs = true;                                                   ///< pairs are tried if no single flip helps
  int more_reach = 0;  ///< edges beyond RepairParams::reach within which a patch moves vertices
};

/// The number of patches tried for a tet without a misaligned face. @param max_tries  RepairParams::max_tries
std::size_t most_patches_of(const FlipEffort& effort, int max_tries);

/// Trials of flips in the patch around one tet, made on copies. The mesh does not change.
class FlipTrials {
 public:
  struct Best {
    BackgroundLayer layer;
    PatchState state;
    std::vector<std::int64_t> flips;
    std::ptrdiff_t more_below_target = 0;  ///< increase of the number of tets below RepairParams::target
    bool found = false;                    ///< some trial improves the patch
    bool is_perfect() const { return found && state.is_perfect(); }
  };

  /// Keeps references to its arguments, except for `inside`, which is copied.
  FlipTrials(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
             const ClassificationParams& classification, const RepairParams& params, const Positions& places,
             const IdSet& inside)
      : background_(background),
        links_(links),
        psi_(psi),
        params_(params),
        target_(params.target),
        positions_(places),
        inside_(inside),
        candidates_(background, links, psi, classification, params, inside_) {}
  FlipTrials(const FlipTrials&) = delete;  // candidates_ reads inside_
  FlipTrials& operator=(const FlipTrials&) = delete;

  /// The best change found for a tet.
  /// @param most_tries  number of patches
  Best operator()(const TetIds& tet, std::size_t most_tries);
  /// The patch around these vertices after relax_tangentially(), or unchanged if this would make it worse.
  BackgroundLayer slid(const std::vector<std::int64_t>& centres);
  bool is_misaligned(const TetIds& tet);
  /// True if the tet is in omega_h, and below the target or with a misaligned face.
  bool is_bad(const TetIds& tet);
  /// Replaces the target params.target by another mean ratio from now on.
  void retry_with(double target, const FlipEffort& effort) {
    target_ = target;
    effort_ = effort;
  }
  void flip(std::int64_t v) { inside_.test(v) ? inside_.erase(v) : inside_.insert(v); }

  std::size_t tries = 0;            ///< patches shaped, in all calls
  std::size_t psi_evaluations = 0;  ///< in all calls

 private:
  /// Initial positions of a patch's vertices: the present ones, or the lattice's (a fold stays a fold under small
  /// steps).
  enum class Start { Here, Lattice };

  BackgroundLayer patch(const std::vector<std::int64_t>& centres, Start start) const;
  PatchState state(const ActiveLayer& layer, const std::vector<std::uint8_t>& inside);
  std::ptrdiff_t more_below_target(const ActiveLayer& after, const ActiveLayer& before) const;
  void attempt(const TetIds& tet, std::span<const std::int64_t> flips, Start start, Best& best);
  bool smooth_while_promising(PNormSmoother& smoother, const PatchState& before);
  void try_flips(const TetIds& tet, Start start, Best& best);

  const BackgroundMesh& background_;
  const VertexLinks& links_;
  ImplicitFunctionRef psi_;
  const RepairParams& params_;
  double target_;
  FlipEffort effort_;
  const Positions& positions_;
  IdSet inside_;
  FlipCandidates candidates_;
  std::size_t end_of_tries_ = 0;
};

}  // namespace umtet::detail
