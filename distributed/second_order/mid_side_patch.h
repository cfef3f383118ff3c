#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "mesh/second_order/mid_side_projection.h"
#include "mesh/second_order/quadratic_tets.h"

namespace umtet {

/// A ten-node tet as sent to another rank, by ids of the background.
struct SentTet {
  std::int64_t id, corner[4], kind[6];  ///< kind: MidSide of its mid-sides
  double place[10][3];                  ///< positions of its nodes
};

/// A mid-side whose position or kind has changed.
struct MovedMidSide {
  std::array<std::int64_t, 2> edge;  ///< ids of its corners, the lower one first
  std::int64_t kind;
  double place[3];
};

/// A patch of ten-node tets in which mid-sides are relaxed as in the whole mesh.
class MidSidePatch {
 public:
  /// Adds a ring of tets around the present ones, over edges. Tets that are already in the patch are skipped.
  void add_ring(const std::vector<SentTet>& tets);
  /// The edges of all tets, ascending.
  std::vector<std::array<std::int64_t, 2>> edges() const;

  struct Relaxed {
    bool has_met_rim = false;  ///< more tets are required; the other fields are then invalid
    std::vector<MovedMidSide> moved;
    std::size_t n_slid = 0, n_relaxed = 0;  ///< as in SecondOrder
  };
  /// Result of MidSideRelaxation for the tets of the first ring.
  Relaxed relaxed(ImplicitFunctionRef psi, double h, const SecondOrderParams& params) const;

 private:
  struct Member {
    SentTet tet;
    int ring;
  };
  std::map<std::int64_t, Member> tets_;  ///< by id
  int n_rings_ = 0;
};

}  // namespace umtet
