#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/max_min.h"
#include "mesh/core/quality_target.h"
#include "mesh/fast/layer_exchange.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {

/// docs/constants.md has what other values do.
struct SmoothingParams {
  double target = kQualityTarget;  ///< mean ratio every tet is to reach; in (0, 1)
  /// A vertex is solved while its worst tet is below target + margin; >= 0
  double margin = .034;
  double fine_gain = 2e-5;    ///< relative gain in the norm of 1/Q below which a solve is no move; in (0, 1/96)
  double least_step = .0075;  ///< of h: a shorter move enqueues no neighbour; >= 0
  /// In place of fine_gain where a tet of the star is below the target; in (0, 1/96). There any move enqueues the
  /// neighbours. What smoothing wins there by smaller steps it takes from the tets around, and leaves a region just
  /// below the target where there were a few bad tets.
  double least_gain = 3e-4;
  int max_sweeps = 60;  ///< over the vertices in the queue; >= 0
  /// A vertex that slid is off the surface by a sagitta only, where Damped settles in as many steps as Newton and needs
  /// no Hessian.
  ClosestPointParams closest_point{.method = ClosestPointMethod::Damped};
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const SmoothingParams&);

struct SmoothingReport {
  int sweeps = 0;
  std::size_t checks = 0;           ///< at a ring, to see whether its vertex needs a solve
  std::size_t solves = 0;           ///< Newton solves for one vertex
  std::size_t moves = 0;            ///< solves that moved their vertex
  std::size_t psi_evaluations = 0;  ///< of psi and its derivatives, for vertices on the boundary
  bool settled = false;             ///< nothing moved in the last sweep; false: max_sweeps used up
  // Of the layer as it is left; not filled by PNormSmoother::run().
  std::size_t tangled = 0;  ///< vertices left with a tet of V <= 0 in their ring, Fixed ones not counted
  double min_quality = 1;   ///< mean ratio of the worst tet with a vertex that is not Fixed; 1 without any

  SmoothingReport& operator+=(const SmoothingReport& later);  ///< counters add up, the state is the later one's
};

/// Maximises the worst mean ratio around each vertex of a layer, one vertex at a time.
///
/// 1/Q is proportional to L / V^(2/3), convex in the place of one vertex while V > 0, and so is the p-norm of the 1/Q
/// of its ring. A solve makes a Newton step on that norm for p = 48 and one for p = 96, through F = Q^-3 = L^3 / (432
/// V^2) and its powers 16 and 32, so that it takes no roots. A step is at most .5 h long, h that of the vertex, leaves
/// every V a fifth of its value or more, and is halved until the sum of the powers falls. A solve counts if it lowers
/// sum F^32 over the ring: that sum over the whole layer falls monotonically, and no solve leaves its ring with less
/// than n^(-1/96) of the worst quality it had, n tets: 3.4 % at 28.
///
/// A boundary vertex takes the steps in its tangent plane and is then put back on psi = 0; the solve counts by the sum
/// there. Steps are over-relaxed, where that lowers the sum, too: alone, a vertex goes less far than with its
/// neighbours. Where some V <= 0, V + sigma takes the place of V, with sigma > -min V: the same convex problem, solved
/// again with ever smaller sigma until all V > 0; such a solve counts if it raises min V.
///
/// Vertices are solved colour by colour, those of one colour by all threads, and again when they, or a neighbour in a
/// tet below target + margin, have moved, by least_step or more where no tet is below the target: the same bytes for
/// any number of threads. Does not allocate inside a sweep.
class PNormSmoother {
 public:
  /// Every vertex of the layer that is not Fixed is in the queue.
  /// \throw std::invalid_argument for a vertex with more than kMaxRing tets, unless Fixed
  explicit PNormSmoother(ActiveLayer& layer);

  /// The layer is a part of one that several processes move: they call what follows together. Of reports, what was
  /// moved last decides for all whether a layer has settled; counts are those of the part.
  void share(LayerExchange& exchange) { exchange_ = &exchange; }
  int n_colours() const { return exchange_ ? exchange_->n_colours() : static_cast<int>(colour_begin_.size()) - 1; }
  /// Vertices of this colour have been moved and enqueued: passes that on if the layer is shared.
  void pass_on(int colour) {
    if (exchange_) exchange_->after(colour, layer_.V, queued_);
  }
  /// Over all processes that share the layer.
  std::size_t sum(std::size_t n) const { return exchange_ ? exchange_->sum(n) : n; }

  /// Puts vertex i and all vertices of its ring in the queue: to be called when i was moved from outside. Vertices that
  /// share no tet may be enqueued by different threads at once.
  void enqueue(int i);
  /// Puts every vertex in the queue that was not Fixed at construction.
  void enqueue_all();
  /// Empties the queue.
  void dequeue_all();
  /// Solves vertices in the queue until none is left, or for max_sweeps; those left stay for the next call. Roles are
  /// read anew: the caller may hold vertices by making them Fixed for a while, which leaves them in the queue.
  /// What it says of the layer is left to measure(), which checks at every tet.
  /// \throw std::invalid_argument naming every broken constraint of params, Cancelled
  SmoothingReport run(ImplicitFunctionRef psi, const SmoothingParams& params, const Context& context = {});

  /// Fills in what a report says of the layer.
  void measure(SmoothingReport& report) const;

  ActiveLayer& layer() { return layer_; }
  const ActiveLayer& layer() const { return layer_; }
  /// The ring of a vertex that was not Fixed at construction, around its present place.
  OneRing ring(int i) const { return OneRing(layer_.V[i], layer_.V, faces(i)); }

 private:
  class ColourSweep;

  std::span<const Triangle> faces(int i) const {
    return {faces_.get() + faces_of_[i].begin, static_cast<std::size_t>(faces_of_[i].n)};
  }
  struct Range {
    int begin = 0, n = 0;
  };

  ActiveLayer& layer_;
  LayerExchange* exchange_ = nullptr;      ///< or null: there is one process
  std::vector<Range> faces_of_;            ///< per vertex, in faces_
  std::unique_ptr<Triangle[]> faces_;      ///< opposite to a vertex in the tets of its ring; of those not Fixed, in the
                                           ///< order of by_colour_, in which sweeps read them
  std::vector<int> by_colour_;             ///< vertices, ascending within a colour
  std::vector<std::size_t> colour_begin_;  ///< into by_colour_
  std::vector<unsigned char> queued_;      ///< per vertex
};

/// PNormSmoother for one call.
SmoothingReport smooth(ActiveLayer& layer, ImplicitFunctionRef psi, const SmoothingParams& params = {},
                       const Context& context = {});

}  // namespace umtet
