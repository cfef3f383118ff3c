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
#include "mesh/fast/smoothing/layer_exchange.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {

/// Parameters of p-norm smoothing. docs/constants.md lists the effect of other values.
struct SmoothingParams {
  double target = kQualityTarget;  ///< mean ratio that every tet should reach; in (0, 1)
  /// A vertex is solved while its worst tet is below target + margin; >= 0
  double margin = .034;
  double fine_gain = 2e-5;    ///< a solve with a smaller relative gain in the norm of 1/Q is no move; in (0, 1/96)
  double least_step = .0075;  ///< in units of h: a shorter move does not enqueue neighbours; >= 0
  /// Replaces fine_gain where a tet of the star is below the target; in (0, 1/96). In that case any move enqueues the
  /// neighbours. Gains by smaller steps are made at the expense of surrounding tets, and turn a few bad tets into a
  /// region just below the target.
  double least_gain = 3e-4;
  int max_sweeps = 60;  ///< sweeps over the vertices in the queue; >= 0
  /// A vertex that slid is off the surface by a sagitta only. There Damped converges in as many steps as Newton and
  /// needs no Hessian.
  ClosestPointParams closest_point{.method = ClosestPointMethod::Damped};
};

/// All broken constraints, not just the first.
std::vector<std::string> problems(const SmoothingParams&);

/// Report of p-norm smoothing: work done, and state of the layer.
struct SmoothingReport {
  int sweeps = 0;
  std::size_t checks = 0;           ///< checks of a ring, to see whether its vertex needs a solve
  std::size_t solves = 0;           ///< Newton solves for one vertex
  std::size_t moves = 0;            ///< solves that moved their vertex
  std::size_t psi_evaluations = 0;  ///< evaluations of psi and its derivatives, for vertices on the boundary
  bool settled = false;             ///< nothing moved in the last sweep; false: all max_sweeps were used
  // The final state of the layer; not set by PNormSmoother::run().
  std::size_t tangled = 0;  ///< vertices with a tet of V <= 0 in their ring, without Fixed ones
  double min_quality = 1;   ///< mean ratio of the worst tet with a vertex that is not Fixed; 1 if there is none

  SmoothingReport& operator+=(const SmoothingReport& later);  ///< adds counters; the state is the later one's
};

/// p-norm smoothing of vertex positions: raises the worst mean ratio around each vertex of a layer, one vertex at a
/// time.
///
/// 1/Q is proportional to L / V^(2/3), which is convex in the position of one vertex while V > 0, and so is the p-norm
/// of 1/Q over the vertex's ring. A solve makes one Newton step on this norm for p = 48 and one for p = 96. It works on
/// F = Q^-3 = L^3 / (432 V^2) and its powers 16 and 32, so that it needs no roots.
///
/// - A step is at most .5 h long, with the h of the vertex, and leaves every V at a fifth of its value or more. It is
///   halved until the sum of the powers falls.
/// - A solve counts if it lowers sum F^32 over the ring. This sum over the whole layer therefore falls monotonically,
///   and no solve leaves its ring with less than n^(-1/96) of its worst quality before, for n tets: a loss of 3.4 % for
///   28.
/// - A boundary vertex takes steps in its tangent plane and is then projected back onto psi = 0; the sum at the
///   projected point decides whether the solve counts.
/// - Steps are over-relaxed where this lowers the sum, too: a vertex alone moves less far than together with its
///   neighbours.
/// - Where some V <= 0, V + sigma replaces V, with sigma > -min V. This is the same convex problem, solved repeatedly
///   with decreasing sigma until all V > 0 (simultaneous untangling and smoothing). Such a solve counts if it raises
///   min V.
///
/// Vertices are solved colour by colour, the vertices of one colour by all threads. A vertex is solved again when it,
/// or a neighbour in a tet below target + margin, has moved; where no tet is below the target, only moves of at least
/// least_step count. The bytes are the same for any number of threads. Nothing is allocated inside a sweep.
class PNormSmoother {
 public:
  /// Enqueues every vertex of the layer that is not Fixed.
  /// \throw std::invalid_argument for a vertex with more than kMaxRing tets, unless Fixed
  explicit PNormSmoother(ActiveLayer& layer);

  /// Declares the layer a part of one that several processes move; they then call all following functions together. In
  /// reports, `settled` is decided for all processes by the last moves, while counts are counts of the part.
  void share(LayerExchange& exchange) { exchange_ = &exchange; }
  int n_colours() const { return exchange_ ? exchange_->n_colours() : static_cast<int>(colour_begin_.size()) - 1; }
  /// To be called after vertices of this colour were moved and enqueued: exchanges the changes if the layer is shared.
  void pass_on(int colour) {
    if (exchange_) exchange_->after(colour, layer_.V, queued_);
  }
  /// Sum over all processes that share the layer.
  std::size_t sum(std::size_t n) const { return exchange_ ? exchange_->sum(n) : n; }

  /// Enqueues vertex i and all vertices of its ring. Call it after i was moved from outside. Different threads may
  /// enqueue vertices that share no tet at the same time.
  void enqueue(int i);
  /// Enqueues every vertex that was not Fixed at construction.
  void enqueue_all();
  /// Empties the queue.
  void dequeue_all();
  /// Solves vertices in the queue until the queue is empty, or for max_sweeps sweeps. The remaining vertices stay in
  /// the queue for the next call.
  ///
  /// Roles are read at each call: the caller may hold vertices by making them Fixed temporarily, and they stay in
  /// the queue. The final state of the layer is not reported; measure() computes it by a check of every tet.
  /// \throw std::invalid_argument naming every broken constraint of params, Cancelled
  SmoothingReport run(ImplicitFunctionRef psi, const SmoothingParams& params, const Context& context = {});

  /// Sets the fields of a report that describe the layer's state.
  void measure(SmoothingReport& report) const;

  ActiveLayer& layer() { return layer_; }
  const ActiveLayer& layer() const { return layer_; }
  /// The ring of a vertex that was not Fixed at construction, around its present position.
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
  LayerExchange* exchange_ = nullptr;  ///< null: there is one process
  std::vector<Range> faces_of_;        ///< per vertex, into faces_
  std::unique_ptr<Triangle[]> faces_;  ///< faces opposite to a vertex in the tets of its ring, for vertices that are
                                       ///< not Fixed, in the order of by_colour_, in which sweeps read them
  std::vector<int> by_colour_;         ///< vertices, ascending within a colour
  std::vector<std::size_t> colour_begin_;  ///< into by_colour_
  std::vector<unsigned char> queued_;      ///< per vertex
};

/// Runs a PNormSmoother once over a layer.
SmoothingReport smooth(ActiveLayer& layer, ImplicitFunctionRef psi, const SmoothingParams& params = {},
                       const Context& context = {});

}  // namespace umtet
