#include "mesh/classification/classification.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>

#include "mesh/classification/classification_band.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/core/asking_psi.h"

namespace umtet {
namespace {

// A gain below this is rounding of floats.
constexpr float kLeastGain = 1e-3F;
// Two neighbours whose flips, each by itself, would together cost more than this are not tried as a pair. A flip often
// passes through configurations that are not in the table and cost 100 each (StarCostTable): a pair that wins may make
// up for three of them. Less loses such pairs; more tries pairs that hardly ever win, and most pairs are of this kind.
constexpr float kMostCost = 300;
constexpr std::size_t kBlocksPerTask = 4;  // of a hundred vertices each

/// Iterated conditional modes [Besag1986] with single and pair moves in the band, block by block.
class Descent {
 public:
  /// @param h  of the background
  Descent(double h, const VertexLinks& links, ImplicitFunctionRef psi, const ClassificationParams& params,
          ClassificationBand& band, const IdSet* last, ClassificationPart* part)
      : h_(h),
        links_(links),
        psi_(psi),
        params_(params),
        costs_(params.costs ? *params.costs : a15_star_costs()),
        band_(band),
        last_(last),
        part_(part),
        gain_(band.size()),
        open_(band.size(), kAll),
        thin_(band.size(), Thin::Unknown) {
    find_costs_of_distance();
    for (std::size_t v = 0; part_ && v < band_.size(); ++v) {
      if (part_->shares(band_.id[v])) shared_.push_back({static_cast<int>(v), state_of(static_cast<int>(v))});
    }
  }

  /// @param inside  receives the classification
  ClassificationReport operator()(IdSet& inside, const Context& context);

 private:
  enum class Thin : std::uint8_t { Unknown, No, Yes };
  /// What is to be done about a vertex since one near it was flipped.
  enum Open : std::uint8_t { kSingle = 1, kPair = 2, kGain = 4, kAll = 7 };

  void find_costs_of_distance();
  float cost_outside(int v, LinkMask mask) const;
  float find_gain(int v) const;
  float gain_of_flip(int v);
  bool may_flip(int v);
  bool is_simple(int v) const { return links_.of_type(band_.type[v]).state(band_.mask[v]).simple; }
  bool keeps_manifold(int v) const;
  void toggle(int v);
  void flip(int v);
  int flip_if_better(int v);
  int flip_with_neighbour(int v);
  bool is_thick(int v);
  bool is_as_before(int v) const { return last_ && (band_.is_inside[v] != 0) == last_->test(band_.id[v]); }
  float least_gain(int v) const {
    return is_as_before(v) ? std::max(kLeastGain, static_cast<float>(params_.keep)) : kLeastGain;
  }
  void set_state(const VertexState& state);
  void exchange();
  std::size_t sum(std::size_t n) const { return part_ ? part_->sum(n) : n; }
  template <class F>
  std::size_t sweep(const F& visit);
  template <class F>
  bool descend(Open what, const F& visit, const Context& context, ClassificationReport& report);

  /// A vertex that another process knows, and its state as it was passed on last.
  struct Shared {
    int v;
    VertexState state;
  };
  VertexState state_of(int v) const {
    return {band_.id[v], band_.is_inside[v], static_cast<std::uint8_t>(open_[v] & (kSingle | kPair))};
  }

  double h_;
  const VertexLinks& links_;
  ImplicitFunctionRef psi_;
  const ClassificationParams& params_;
  const StarCostTable& costs_;
  ClassificationBand& band_;
  const IdSet* last_;                 ///< classification of the mesh before, or null
  ClassificationPart* part_;          ///< or null: there is one process
  std::vector<float> height_, lack_;  ///< costs of distance: of an outside vertex at the boundary, of an inside one
  std::vector<float> gain_;
  std::vector<std::uint8_t> open_;  ///< Open
  std::vector<Thin> thin_;
  std::vector<Shared> shared_;  ///< ascending
  std::atomic<std::size_t> psi_evaluations_{0};
};

void Descent::find_costs_of_distance() {
  const auto outside_height = static_cast<float>(params_.outside_height);
  const auto inside_depth = static_cast<float>(params_.inside_depth);
  const auto square = [](double weight, float d) { return static_cast<float>(weight) * d * d; };
  height_.resize(band_.size());
  lack_.resize(band_.size());
  for (std::size_t v = 0; v < band_.size(); ++v) {
    height_[v] = square(params_.outside_weight, band_.phi[v] - outside_height);
    lack_[v] = square(params_.inside_weight, std::max(0.F, band_.phi[v] + inside_depth));
  }
}

/// What vertex v adds to the cost while it is outside; an inside one adds lack_.
inline float Descent::cost_outside(int v, LinkMask mask) const {
  if (mask == 0) return 0;
  const LinkTopology& link = links_.of_type(band_.type[v]);
  return costs_(link.site, link.state(mask)) + height_[v];
}

float Descent::find_gain(int v) const {
  const LinkTopology& link = links_.of_type(band_.type[v]);
  const std::span<const int> ring = band_.link(v);
  float gain = lack_[v] - cost_outside(v, band_.mask[v]);
  if (!band_.is_inside[v]) gain = -gain;
  for (int k = 0; k < link.n; ++k) {
    const int w = ring[k];
    if (band_.is_inside[w]) continue;  // the cost of an inside vertex does not depend on its link
    gain += cost_outside(w, band_.mask[w]) - cost_outside(w, band_.mask[w] ^ LinkMask{1} << link.back[k]);
  }
  return gain;
}

float Descent::gain_of_flip(int v) {
  if ((open_[v] & kGain) != 0) {
    gain_[v] = find_gain(v);
    open_[v] &= ~kGain;
  }
  return gain_[v];
}

/// True if no outside vertex of the ring leaves the manifold boundary it has, or gets a bad one it did not have.
bool Descent::keeps_manifold(int v) const {
  const LinkTopology& link = links_.of_type(band_.type[v]);
  int before = 0, after = 0;
  const auto bad = [&](int w, LinkMask mask) {
    return mask != 0 && !links_.of_type(band_.type[w]).state(mask).manifold;
  };
  if (band_.is_inside[v]) {
    after += bad(v, band_.mask[v]);
  } else {
    before += bad(v, band_.mask[v]);
  }
  for (int k = 0; k < link.n; ++k) {
    const int w = band_.link(v)[k];
    if (band_.is_inside[w]) continue;
    before += bad(w, band_.mask[w]);
    after += bad(w, band_.mask[w] ^ LinkMask{1} << link.back[k]);
  }
  return after <= before;
}

/// Evaluates psi, so it is called only where every other condition holds.
bool Descent::is_thick(int v) {
  if (params_.least_thickness == 0) return true;
  if (thin_[v] == Thin::Unknown) {
    std::size_t n = 0;
    const double unit = links_.of_type(band_.type[v]).unit * h_;
    const bool thin = umtet::is_thin(psi_, band_.foot[v], band_.normal[v], params_.least_thickness, unit, n);
    thin_[v] = thin ? Thin::Yes : Thin::No;
    psi_evaluations_.fetch_add(n, std::memory_order_relaxed);
  }
  return thin_[v] == Thin::No;
}

bool Descent::may_flip(int v) { return is_simple(v) && keeps_manifold(v) && is_thick(v); }

void Descent::toggle(int v) {
  band_.is_inside[v] ^= 1;
  const LinkTopology& link = links_.of_type(band_.type[v]);
  for (int k = 0; k < link.n; ++k) band_.mask[band_.link(v)[k]] ^= LinkMask{1} << link.back[k];
}

/// Flips v, and opens all vertices whose gain that changes.
void Descent::flip(int v) {
  toggle(v);
  for (const int w : band_.link(v)) {
    open_[w] = kAll;
    for (const int u : band_.link(w)) {
      if (u >= 0) open_[u] = kAll;
    }
  }
}

/// @return the number of flips
int Descent::flip_if_better(int v) {
  if (!is_simple(v) || gain_of_flip(v) <= least_gain(v) || !may_flip(v)) return 0;
  flip(v);
  return 1;
}

/// Flips v if that is better, else v and the neighbour with which most is gained.
/// @return the number of flips
int Descent::flip_with_neighbour(int v) {
  if (flip_if_better(v) == 1) return 1;
  if (!is_simple(v)) return 0;
  const float gain = gain_of_flip(v);
  std::array<int, kMaxLink> partners;
  int n = 0;
  for (const int w : band_.link(v)) {
    if (!band_.movable[w] || (open_[w] & kPair) != 0) continue;  // an open one will try v
    if (gain + gain_of_flip(w) > -kMostCost) partners[n++] = w;
  }
  if (n == 0 || !keeps_manifold(v)) return 0;
  float most = least_gain(v);
  int best = -1;
  toggle(v);
  for (const int w : std::span(partners.data(), static_cast<std::size_t>(n))) {
    if (!is_simple(w)) continue;
    const float both = gain + find_gain(w);
    if (both <= std::max(most, least_gain(w)) || !may_flip(w)) continue;
    most = both;
    best = w;
  }
  toggle(v);
  if (best < 0 || !is_thick(v)) return 0;
  flip(v);
  flip(best);
  return 2;
}

/// What another process has made of a vertex.
void Descent::set_state(const VertexState& state) {
  const int v = band_.find(state.vertex);
  if (v < 0) return;
  if (band_.is_inside[v] != state.is_inside) {
    band_.is_inside[v] = state.is_inside;
    const LinkTopology& link = links_.of_type(band_.type[v]);
    for (int k = 0; k < link.n; ++k) {
      const int w = band_.link(v)[k];
      if (w < 0) continue;  // at the rim of what is known
      band_.mask[w] ^= LinkMask{1} << link.back[k];
      open_[w] |= kGain;
      for (const int u : band_.link(w)) {
        if (u >= 0) open_[u] |= kGain;
      }
    }
  }
  open_[v] = static_cast<std::uint8_t>(state.open | kGain);
}

void Descent::exchange() {
  std::vector<VertexState> changed;
  for (Shared& s : shared_) {
    const VertexState now = state_of(s.v);
    if (now.is_inside != s.state.is_inside || now.open != s.state.open) changed.push_back(s.state = now);
  }
  const std::vector<VertexState> received = part_->exchange(changed);
  for (const VertexState& state : received) set_state(state);
  if (received.empty()) return;
  for (Shared& s : shared_) s.state = state_of(s.v);
}

/// @param visit  returns the number of its flips
template <class F>
std::size_t Descent::sweep(const F& visit) {
  std::size_t flips = 0;
  for (const auto& blocks : band_.blocks) {
    flips += sum_asking<std::size_t>(psi_, 0, blocks.size(), kBlocksPerTask, {}, [&](std::size_t b, std::size_t& n) {
      for (std::uint32_t k = blocks[b].begin; k < blocks[b].end; ++k) {
        n += static_cast<std::size_t>(visit(static_cast<int>(band_.order[k])));
      }
    });
    if (part_) exchange();
  }
  return sum(flips);
}

/// Sweeps over the vertices with `what` to be done until nothing changes.
/// @return false if max_sweeps are used up
template <class F>
bool Descent::descend(Open what, const F& visit, const Context& context, ClassificationReport& report) {
  while (report.sweeps < params_.max_sweeps) {
    context.poll();
    const std::size_t flips = sweep([&](int v) {
      if ((open_[v] & what) == 0) return 0;
      open_[v] &= ~what;
      return visit(v);
    });
    report.flips += flips;
    ++report.sweeps;
    if (flips == 0) return true;
  }
  return false;
}

ClassificationReport Descent::operator()(IdSet& inside, const Context& context) {
  ClassificationReport report;
  report.candidates = sum(band_.order.size());
  report.shifted = sweep([&](int v) {
    if (!band_.is_inside[v] || band_.phi[v] < -params_.shift || !may_flip(v)) return 0;
    flip(v);
    return 1;
  });
  // Twice: whether a flip is allowed, and what it costs, depends on the flips around it.
  for (int pass = 0; last_ && pass < 2; ++pass) {
    report.returned += sweep([&](int v) {
      if (is_as_before(v) || gain_of_flip(v) < -params_.keep || !may_flip(v)) return 0;
      flip(v);
      return 1;
    });
  }
  // A pair takes ten times the time of a single flip: pairs come when no single flip is left that wins.
  report.settled = descend(
                       kSingle, [&](int v) { return flip_if_better(v); }, context, report) &&
                   descend(
                       kPair, [&](int v) { return flip_with_neighbour(v); }, context, report);
  for (std::size_t v = 0; v < band_.size(); ++v) {
    if (band_.is_inside[v]) {
      inside.insert(band_.id[v]);
    } else {
      inside.erase(band_.id[v]);
      const bool is_bad = (!part_ || part_->owns(band_.id[v])) && band_.mask[v] != 0 &&
                          !links_.of_type(band_.type[v]).state(band_.mask[v]).manifold;
      if (is_bad) report.not_manifold.push_back(band_.id[v]);
    }
    report.thin += thin_[v] == Thin::Yes;
    report.stretched += band_.held[v];
  }
  report.psi_evaluations = band_.psi_evaluations + psi_evaluations_;
  return report;
}

}  // namespace

std::vector<std::string> problems(const ClassificationParams& params) {
  std::vector<std::string> list;
  const auto in = [&](const char* name, double value, double low, double high, const char* range) {
    if (!(value >= low && value <= high))
      list.push_back(std::string(name) + " = " + std::to_string(value) + ": must be " + range);
  };
  constexpr double kAny = std::numeric_limits<double>::max();
  in("shift", params.shift, 0, .15, "in 0 .. .15");
  in("reach_in", params.reach_in, 0, kAny, ">= 0");
  in("reach_out", params.reach_out, 0, kAny, ">= 0");
  in("most_stretch", params.most_stretch, 1, kAny, ">= 1");
  in("least_thickness", params.least_thickness, 0, kAny, ">= 0");
  in("outside_weight", params.outside_weight, 0, kAny, ">= 0");
  in("outside_height", params.outside_height, -kAny, kAny, "finite");
  in("inside_weight", params.inside_weight, 0, kAny, ">= 0");
  in("inside_depth", params.inside_depth, -kAny, kAny, "finite");
  in("keep", params.keep, 0, kAny, ">= 0");
  in("max_sweeps", params.max_sweeps, 0, kAny, ">= 0");
  return list;
}

bool is_thin(ImplicitFunctionRef psi, const Vec3& foot, const Vec3& normal, double thickness, double h,
             std::size_t& n_evaluations) {
  // In steps of half an edge no sheet that the background can resolve is missed.
  const int n_steps = static_cast<int>(std::ceil(2 * thickness));
  for (int side = -1; side <= 1; side += 2) {
    for (int s = 1; s <= n_steps; ++s) {
      const double t = thickness * s / n_steps * h;
      ++n_evaluations;
      if ((psi.value(foot + side * t * normal) < 0) != (side < 0)) return true;
    }
  }
  return false;
}

ClassificationReport classify_vertices(const BackgroundMesh& background, const VertexLinks& links,
                                       ImplicitFunctionRef psi, const ClassificationParams& params, IdSet& inside,
                                       const Context& context, const IdSet* last, const PsiValues* known,
                                       ClassificationPart* part) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (!all.empty()) throw std::invalid_argument(all);
  ClassificationBand band(background, links, psi, params, inside, context, known, part);
  return Descent(background.h(), links, psi, params, band, last, part)(inside, context);
}

}  // namespace umtet
