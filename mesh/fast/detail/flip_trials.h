#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mesh/base/id_list.h"
#include "mesh/base/id_set.h"
#include "mesh/fast/detail/flip_candidates.h"
#include "mesh/fast/p_norm_smoothing.h"
#include "mesh/fast/patch_state.h"
#include "mesh/fast/repair.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet::detail {

using TetIds = std::array<std::int64_t, 4>;

/// Where the vertices of a mesh under repair are: moved, or in the layer, or kept, or in the background mesh.
class Positions {
 public:
  /// Keeps all by reference. @param kept  ascending
  Positions(const BackgroundMesh& background, const BackgroundLayer& layer, const std::vector<KeptVertex>& kept)
      : background_(background), layer_(layer), kept_(kept) {}

  Vec3 of(std::int64_t v) const {
    std::size_t from = 0;
    return of(v, from);
  }
  /// @param from  where in the layer to look; receives where it was found, for the next greater one
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

/// What is tried for one tet.
struct FlipEffort {
  /// Patches without misaligned faces that smoothing leaves below the target are given to smooth_all_vertices(), at
  /// first without flips.
  bool all_vertices = false;
  std::size_t most_singles = std::numeric_limits<std::size_t>::max();  ///< candidates, the most promising ones
  bool pairs = true;                                                   ///< where no single flip helps
  int more_reach = 0;  ///< edges beyond RepairParams::reach within which a patch moves vertices
};

/// How many patches are tried for a tet without a misaligned face. @param max_tries  of RepairParams
std::size_t most_patches_of(const FlipEffort& effort, int max_tries);

/// What flips would make of the patch around one tet, tried on copies. Changes nothing of the mesh.
class FlipTrials {
 public:
  struct Best {
    BackgroundLayer layer;
    PatchState state;
    std::vector<std::int64_t> flips;
    std::ptrdiff_t more_below_target = 0;  ///< tets below RepairParams::target, than before
    bool found = false;                    ///< something betters the patch
    bool is_perfect() const { return found && state.is_perfect(); }
  };

  /// Keeps what it is given by reference, but for `inside`, of which it has its own copy.
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

  /// The best that was found for a tet.
  /// @param most_tries  patches
  Best operator()(const TetIds& tet, std::size_t most_tries);
  /// The patch around these vertices after relax_tangentially(), or as it is if that would make it worse.
  BackgroundLayer slid(const std::vector<std::int64_t>& centres);
  bool is_misaligned(const TetIds& tet);
  /// In omega_h, and below the target or with a misaligned face.
  bool is_bad(const TetIds& tet);
  /// From now on the target is this mean ratio, in place of params.target.
  void retry_with(double target, const FlipEffort& effort) {
    target_ = target;
    effort_ = effort;
  }
  void flip(std::int64_t v) { inside_.test(v) ? inside_.erase(v) : inside_.insert(v); }

  std::size_t tries = 0;            ///< patches shaped, of all calls
  std::size_t psi_evaluations = 0;  ///< of all calls

 private:
  /// Where a patch's vertices start from: where they are, or (a fold stays a fold under small steps) the lattice.
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
