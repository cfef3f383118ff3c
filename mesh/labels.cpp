#include "mesh/labels.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace umtet {
namespace {

using detail::IdSet;

// Flips reach two rings, 1.3 cells of A15; bricks of one colour are this many cells apart.
constexpr std::int64_t kBrick = 4;
constexpr std::size_t kVerticesPerTask = 256;
// A gain below this is rounding of floats.
constexpr float kLeastGain = 1e-3F;
// Feet from farther away may be on another sheet, and those closer together, in h, say little about curvature.
constexpr float kFarthestFoot = 1.8F;
constexpr double kApart = .3;

/// Vertices within three edges of a change of label, and all the descent knows about them, by rank.
class Band {
 public:
  Band(const BackgroundMesh& background, const std::vector<LinkTopology>& links, ImplicitFunctionRef psi,
       const LabelParams& params, IdSet& inside)
      : background_(background),
        links_(links),
        psi_(psi),
        params_(params),
        energies_(params.energies ? *params.energies : a15_label_energies()),
        inside_(inside),
        band_(background.n_vertices()) {
    for (int type = 0; type < background.n_types(); ++type) {
      for (const Tiling::Corner& c : background.tiling_tables().link[type])
        steps_[type].push_back(background.id_step(type, c));
    }
  }

  LabelReport operator()(const KeepGoing& keep_going);

 private:
  struct Brick {
    std::uint32_t begin, end;
  };
  enum class Thin : std::uint8_t { Unknown, No, Yes };

  void gather();
  void measure(const KeepGoing& keep_going);
  bool has_foot(int v) const { return std::abs(phi_[v]) < kFarthestFoot; }  // false for NaN
  void hold_where_stretched(const KeepGoing& keep_going);
  void make_bricks();
  /// In the outermost layer of cells, where a step along an edge may leave the range of ids.
  bool is_outermost(std::int64_t id) const {
    const auto cell = background_.cell(id);
    bool outermost = false;
    for (int a = 0; a < 3; ++a) outermost |= cell[a] < 0 || cell[a] >= background_.n_cells()[a];
    return outermost;
  }
  float price(int v, bool inside, std::uint16_t mask) const;
  float gain_of_flip(int v) const;
  bool may_flip(int v);
  bool keeps_manifold(int v) const;
  void flip(int v);
  bool is_thin(int v);
  template <class F>
  std::size_t sweep(const F& visit);

  const BackgroundMesh& background_;
  const std::vector<LinkTopology>& links_;
  ImplicitFunctionRef psi_;
  const LabelParams& params_;
  const LabelEnergies& energies_;
  IdSet& inside_;
  IdSet band_;
  std::vector<std::vector<std::int64_t>> steps_ = std::vector<std::vector<std::int64_t>>(background_.n_types());
  std::vector<std::int64_t> id_;
  std::vector<std::array<int, kMaxLink>> link_;  ///< ranks, -1 where the neighbour is not in the band
  std::vector<std::uint8_t> type_, label_, movable_, held_, dirty_;
  std::vector<std::uint16_t> mask_;
  std::vector<float> phi_;  ///< signed distance in h
  std::vector<Vec3> foot_, normal_;
  std::vector<Thin> thin_;
  std::vector<std::uint32_t> order_;          ///< movable vertices, brick by brick
  std::array<std::vector<Brick>, 8> bricks_;  ///< into order_, per colour
  std::atomic<std::size_t> psi_evaluations_{0};
};

/// The vertices with a neighbour of the other label, and two rings more.
void Band::gather() {
  std::vector<std::int64_t> front;
  inside_.for_each([&](std::int64_t v) {
    bool cut = false;
    for (const std::int64_t step : steps_[background_.type(v)]) {
      if (inside_.test(v + step)) continue;
      cut = true;
      if (!band_.test(v + step)) {
        band_.insert(v + step);
        front.push_back(v + step);
      }
    }
    if (cut && !band_.test(v)) {
      band_.insert(v);
      front.push_back(v);
    }
  });
  std::vector<std::int64_t> next;
  for (int ring = 0; ring < 2; ++ring) {
    next.clear();
    for (const std::int64_t v : front) {
      if (is_outermost(v)) continue;  // too far out for a neighbour to change
      for (const std::int64_t step : steps_[background_.type(v)]) {
        if (band_.test(v + step)) continue;
        band_.insert(v + step);
        next.push_back(v + step);
      }
    }
    front.swap(next);
  }
  const std::size_t n = band_.index();
  id_.reserve(n);
  band_.for_each([&](std::int64_t v) { id_.push_back(v); });
}

void Band::measure(const KeepGoing& keep_going) {
  const std::size_t n = id_.size();
  link_.resize(n);
  type_.resize(n);
  label_.resize(n);
  movable_.assign(n, 0);
  held_.assign(n, 0);
  dirty_.assign(n, 1);
  mask_.assign(n, 0);
  phi_.assign(n, std::numeric_limits<float>::quiet_NaN());
  foot_.resize(n);
  normal_.resize(n);
  thin_.assign(n, Thin::Unknown);
  const float far = static_cast<float>(params_.reach_in + params_.reach_out + 1);
  polled_parallel_for(n, kValuesPerPoll, keep_going, [&](std::size_t v) {
    const std::int64_t id = id_[v];
    const int type = background_.type(id);
    const LinkTopology& link = links_[type];
    type_[v] = static_cast<std::uint8_t>(type);
    label_[v] = inside_.test(id);
    link_[v].fill(-1);
    // Labels beyond the range of ids are those of the rim: outside. Ranks are left out there.
    const bool outermost = is_outermost(id);
    bool complete = !outermost;
    for (int k = 0; k < link.n; ++k) {
      const std::int64_t w = id + steps_[type][k];
      mask_[v] = static_cast<std::uint16_t>(mask_[v] | inside_.test_any(w) << k);
      if (!outermost && band_.test(w)) {
        link_[v][k] = band_.rank(w);
      } else {
        complete = false;
      }
    }
    // A vertex without its whole link in the band is there to complete the masks of others.
    if (!complete && (mask_[v] == 0 || mask_[v] == link.full())) {
      phi_[v] = label_[v] ? -far : far;
      return;
    }
    const Vec3 x = background_.position(id);
    const double h = background_.h();
    Vec3 g;
    double value = psi_.value(x, g), norm = g.norm();
    psi_evaluations_.fetch_add(1, std::memory_order_relaxed);
    const double first = std::clamp(norm > 0 ? value / norm : far * h, -far * h, far * h);
    double distance = first;
    foot_[v] = x;
    normal_[v] = norm > 0 ? Vec3(g / norm) : Vec3::Zero();
    if (norm > 0 && std::abs(first) < far * h) {
      // One more step: psi may be far from linear over an edge.
      foot_[v] = x - first * normal_[v];
      value = psi_.value(foot_[v], g);
      norm = g.norm();
      psi_evaluations_.fetch_add(1, std::memory_order_relaxed);
      if (norm > 0) {
        normal_[v] = g / norm;
        const double second = std::clamp(value / norm, -h, h);
        foot_[v] -= second * normal_[v];
        distance = (x - foot_[v]).norm();
        if (label_[v]) distance = -distance;
      }
    }
    phi_[v] = static_cast<float>(std::isfinite(distance) ? distance / h : label_[v] ? -far : far);
    movable_[v] = complete && phi_[v] >= -params_.reach_in && phi_[v] <= params_.reach_out && !background_.on_rim(id);
  });
}

/// Labels stay where a vertex on its way to the surface would draw apart those around it by more than most_stretch: a
/// patch at depth d under a surface of curvature kappa is 1 / (1 - kappa d) times as wide up there. The curvature is
/// the greatest between the feet of neighbours, on the side that the vertex would come from.
void Band::hold_where_stretched(const KeepGoing& keep_going) {
  const double most = 1 - 1 / params_.most_stretch, apart = kApart * background_.h();
  polled_parallel_for(id_.size(), kValuesPerPoll, keep_going, [&](std::size_t v) {
    if (!movable_[v]) return;
    double kappa = 0;
    for (int k = 0; k < links_[type_[v]].n; ++k) {
      const int w = link_[v][k];
      if (!has_foot(w)) continue;
      const Vec3 between = foot_[w] - foot_[v];
      if (between.norm() < apart) continue;
      kappa = std::max(kappa, (phi_[v] > 0 ? -1 : 1) * between.dot(normal_[w] - normal_[v]) / between.squaredNorm());
    }
    if (kappa * std::abs(phi_[v]) * background_.h() > most) movable_[v] = 0, held_[v] = 1;
  });
}

/// Bricks of kBrick^3 cells; two of one colour never touch a vertex in common.
void Band::make_bricks() {
  struct Key {
    std::uint64_t brick;  ///< colour first
    std::uint32_t vertex;
  };
  const auto& n = background_.n_cells();
  const std::int64_t nx = (n[0] + 2) / kBrick + 1, ny = (n[1] + 2) / kBrick + 1, nz = (n[2] + 2) / kBrick + 1;
  std::vector<Key> keys;
  for (std::uint32_t v = 0; v < id_.size(); ++v) {
    if (!movable_[v]) continue;
    const auto cell = background_.cell(id_[v]);
    const std::int64_t i = (cell[0] + 1) / kBrick, j = (cell[1] + 1) / kBrick, k = (cell[2] + 1) / kBrick;
    const std::int64_t colour = (i & 1) + 2 * (j & 1) + 4 * (k & 1);
    keys.push_back({static_cast<std::uint64_t>(i + nx * (j + ny * (k + nz * colour))), v});
  }
  std::stable_sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) { return a.brick < b.brick; });
  const std::uint64_t per_colour = static_cast<std::uint64_t>(nx * ny * nz);
  order_.reserve(keys.size());
  for (std::size_t b = 0; b < keys.size();) {
    std::size_t e = b;
    while (e < keys.size() && keys[e].brick == keys[b].brick) order_.push_back(keys[e++].vertex);
    bricks_[keys[b].brick / per_colour].push_back({static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(e)});
    b = e;
  }
}

/// What vertex v adds to the energy.
float Band::price(int v, bool inside, std::uint16_t mask) const {
  if (inside) {
    const float lack = phi_[v] + static_cast<float>(params_.inside_depth);
    return lack > 0 ? static_cast<float>(params_.inside_weight) * lack * lack : 0;
  }
  if (mask == 0) return 0;
  const float d = phi_[v] - static_cast<float>(params_.outside_height);
  return energies_[type_[v]][mask] + static_cast<float>(params_.outside_weight) * d * d;
}

float Band::gain_of_flip(int v) const {
  const LinkTopology& link = links_[type_[v]];
  float change = price(v, !label_[v], mask_[v]) - price(v, label_[v], mask_[v]);
  for (int k = 0; k < link.n; ++k) {
    const int w = link_[v][k];
    if (label_[w]) continue;  // the price of an inside vertex does not depend on its link
    change += price(w, false, static_cast<std::uint16_t>(mask_[w] ^ 1u << link.back[k])) - price(w, false, mask_[w]);
  }
  return -change;
}

/// True if no outside vertex of the ring leaves the manifold boundary it has, or gets a bad one it did not have.
bool Band::keeps_manifold(int v) const {
  const LinkTopology& link = links_[type_[v]];
  int before = 0, after = 0;
  const auto bad = [&](int w, std::uint16_t mask) { return mask != 0 && !links_[type_[w]].states[mask].manifold; };
  if (label_[v]) {
    after += bad(v, mask_[v]);
  } else {
    before += bad(v, mask_[v]);
  }
  for (int k = 0; k < link.n; ++k) {
    const int w = link_[v][k];
    if (label_[w]) continue;
    before += bad(w, mask_[w]);
    after += bad(w, static_cast<std::uint16_t>(mask_[w] ^ 1u << link.back[k]));
  }
  return after <= before;
}

bool Band::is_thin(int v) {
  if (thin_[v] == Thin::Unknown) {
    // The other sheet lies within least_thickness h along the normal, on either side. Steps of half an edge see all
    // sheets that the background can resolve.
    thin_[v] = Thin::No;
    const int n_steps = static_cast<int>(std::ceil(2 * params_.least_thickness));
    for (int side = -1; side <= 1 && thin_[v] == Thin::No; side += 2) {
      for (int s = 1; s <= n_steps; ++s) {
        const double t = params_.least_thickness * s / n_steps * background_.h();
        psi_evaluations_.fetch_add(1, std::memory_order_relaxed);
        if ((psi_.value(foot_[v] + side * t * normal_[v]) < 0) != (side < 0)) {
          thin_[v] = Thin::Yes;
          break;
        }
      }
    }
  }
  return thin_[v] == Thin::Yes;
}

bool Band::may_flip(int v) {
  return links_[type_[v]].states[mask_[v]].simple && keeps_manifold(v) && !(params_.least_thickness > 0 && is_thin(v));
}

void Band::flip(int v) {
  label_[v] ^= 1;
  const LinkTopology& link = links_[type_[v]];
  for (int k = 0; k < link.n; ++k) {
    const int w = link_[v][k];
    mask_[w] = static_cast<std::uint16_t>(mask_[w] ^ 1u << link.back[k]);
    dirty_[w] = 1;
    for (const int u : link_[w]) {
      if (u >= 0) dirty_[u] = 1;
    }
  }
}

template <class F>
std::size_t Band::sweep(const F& visit) {
  std::atomic<std::size_t> flips = 0;
  for (const auto& bricks : bricks_) {
    tbb::parallel_for(std::size_t{0}, bricks.size(), [&](std::size_t b) {
      std::size_t n = 0;
      for (std::uint32_t k = bricks[b].begin; k < bricks[b].end; ++k) n += visit(static_cast<int>(order_[k]));
      if (n != 0) flips.fetch_add(n, std::memory_order_relaxed);
    });
  }
  return flips;
}

LabelReport Band::operator()(const KeepGoing& keep_going) {
  LabelReport report;
  gather();
  measure(keep_going);
  hold_where_stretched(keep_going);
  make_bricks();
  report.candidates = order_.size();
  report.shifted = sweep([&](int v) {
    if (!label_[v] || phi_[v] < -params_.shift || !may_flip(v)) return false;
    flip(v);
    return true;
  });
  std::fill(dirty_.begin(), dirty_.end(), 1);
  while (report.sweeps < params_.max_sweeps && !report.settled) {
    poll(keep_going);
    const std::size_t flips = sweep([&](int v) {
      if (!dirty_[v]) return false;
      dirty_[v] = 0;
      if (!links_[type_[v]].states[mask_[v]].simple || gain_of_flip(v) <= kLeastGain || !may_flip(v)) return false;
      flip(v);
      return true;
    });
    report.flips += flips;
    report.settled = flips == 0;
    ++report.sweeps;
  }
  for (std::size_t v = 0; v < id_.size(); ++v) {
    if (label_[v]) {
      inside_.insert(id_[v]);
    } else {
      inside_.erase(id_[v]);
      report.not_manifold += mask_[v] != 0 && !links_[type_[v]].states[mask_[v]].manifold;
    }
    report.thin += thin_[v] == Thin::Yes;
    report.stretched += held_[v];
  }
  report.psi_evaluations = psi_evaluations_;
  return report;
}

}  // namespace

std::vector<std::string> problems(const LabelParams& params) {
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
  in("inside_weight", params.inside_weight, 0, kAny, ">= 0");
  in("inside_depth", params.inside_depth, -kAny, kAny, "finite");
  in("max_sweeps", params.max_sweeps, 0, kAny, ">= 0");
  return list;
}

LabelReport choose_labels(const BackgroundMesh& background, const std::vector<LinkTopology>& links,
                          ImplicitFunctionRef psi, const LabelParams& params, IdSet& inside,
                          const KeepGoing& keep_going) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (!all.empty()) throw std::invalid_argument(all);
  return Band(background, links, psi, params, inside)(keep_going);
}

}  // namespace umtet
