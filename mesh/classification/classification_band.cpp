#include "mesh/classification/classification_band.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/first_touch.h"
#include "common/polled_loops.h"
#include "mesh/base/id_blocks.h"
#include "mesh/core/asking_psi.h"

namespace umtet {
namespace {

// Blocks of one colour are this many cells apart. No edge of a tiling is longer than half a cell along an axis, so that
// is nine rings; to flip a vertex and a neighbour reads and writes three rings around, and seven are enough.
constexpr std::int64_t kBlock = 4;
// For the estimate of curvature: feet of vertices farther away (in units of the vertex) may be on another sheet, and
// between feet closer together (in h) the difference of normals is mostly rounding of psi.
constexpr float kFarthestFoot = 1.8F;
constexpr double kApart = .3;
constexpr std::size_t kVerticesPerTask = 1 << 12;  // of some ten nanoseconds each
constexpr std::size_t kFeetPerTask = 1 << 8;       // of two values of psi each

}  // namespace

ClassificationBand::ClassificationBand(const BackgroundMesh& background, const VertexLinks& links,
                                       ImplicitFunctionRef psi, const ClassificationParams& params, const IdSet& inside,
                                       const Context& context, const PsiValues* known, const ClassificationPart* part)
    : background_(background),
      links_(links),
      psi_(psi),
      params_(params),
      inside_(inside),
      known_(known),
      part_(part),
      band_(background.n_vertices()) {
  gather();
  measure(context);
  hold_where_stretched(context);
  make_blocks();
}

/// In the outermost layer of cells, where a step along an edge may leave the range of ids.
bool ClassificationBand::is_outermost(std::int64_t v) const {
  if (!background_.is_lattice()) return false;  // links are listed
  const auto cell = background_.cell(v);
  bool outermost = false;
  for (int a = 0; a < 3; ++a) outermost |= cell[a] < 0 || cell[a] >= background_.n_cells()[a];
  return outermost;
}

/// The vertices with a neighbour on the other side, and two rings more.
void ClassificationBand::gather() {
  if (known_) {
    std::vector<std::int64_t> cut;
    for (const PsiValue& at : *known_) cut.push_back(at.vertex);
    gather_around(std::move(cut));
  } else {
    for_each_in_blocks(inside_, [&](std::size_t, std::int64_t v) {
      if (part_ && !part_->knows(v)) return;
      bool is_cut = false;
      links_.for_each(v, [&](std::int64_t w) {
        if (inside_.test(w) || (part_ && !part_->knows(w))) return;
        is_cut = true;
        band_.insert_shared(w);
      });
      if (is_cut) band_.insert_shared(v);
    });
    IdSet front = band_;
    for (int ring = 0; ring < 2; ++ring) {
      IdSet next(background_.n_vertices());
      for_each_in_blocks(front, [&](std::size_t, std::int64_t v) {
        if (is_outermost(v)) return;  // too far out for a neighbour to change
        links_.for_each(v, [&](std::int64_t w) {
          if (!band_.test(w)) next.insert_shared(w);
        });
      });
      for (std::size_t w = 0; w < next.n_words(); ++w) band_.set_word(w, band_.word(w) | next.word(w));
      front = std::move(next);
    }
  }
  id.resize(band_.index());
  for_each_in_blocks(band_, [&](std::size_t, std::int64_t v) { id[band_.rank(v)] = v; });
}

/// Two rings around a few vertices in a large background.
void ClassificationBand::gather_around(std::vector<std::int64_t> front) {
  for (const std::int64_t v : front) band_.insert(v);
  std::vector<std::int64_t> next;
  for (int ring = 0; ring < 2; ++ring) {
    next.clear();
    for (const std::int64_t v : front) {
      if (is_outermost(v)) continue;
      links_.for_each(v, [&](std::int64_t w) {
        if (band_.test(w)) return;
        band_.insert(w);
        next.push_back(w);
      });
    }
    front.swap(next);
  }
}

/// State of the vertex, mask and ranks of its link. Returns whether the whole link is in the band.
bool ClassificationBand::find_link(std::size_t v) {
  is_inside[v] = inside_.test(id[v]);
  mask[v] = links_.mask(id[v], inside_);
  // What is beyond the range of ids counts as outside, like the background boundary. Ranks are left out there.
  if (is_outermost(id[v])) return false;
  bool complete = true;
  std::size_t k = first_[v];
  links_.for_each(id[v], [&](std::int64_t w) {
    if (band_.test(w)) {
      ranks_[k] = band_.rank(w);
    } else {
      complete = false;
    }
    ++k;
  });
  return complete;
}

/// psi at vertex v, which is at x.
double ClassificationBand::value_at(std::size_t v, const Vec3& x, Vec3& gradient, std::size_t& n_evaluations) {
  if (known_ && known_at_[v] >= 0) {
    const PsiValue& at = (*known_)[known_at_[v]];
    gradient = at.gradient;
    return at.value;
  }
  ++n_evaluations;
  return psi_.value(x, gradient);
}

/// Foot, normal and distance.
void ClassificationBand::find_foot(std::size_t v, std::size_t& n_evaluations) {
  const Vec3 x = background_.position(id[v]);
  const double h = unit(v), most = far() * h;
  Vec3 g;
  double value = value_at(v, x, g, n_evaluations), norm = g.norm();
  const double first = std::clamp(norm > 0 ? value / norm : most, -most, most);
  double distance = first;
  foot[v] = x;
  normal[v] = norm > 0 ? Vec3(g / norm) : Vec3::Zero();
  if (norm > 0 && std::abs(first) < most) {
    // One more step: psi may be far from linear over an edge.
    foot[v] = x - first * normal[v];
    value = psi_.value(foot[v], g);
    norm = g.norm();
    ++n_evaluations;
    if (norm > 0) {
      normal[v] = g / norm;
      const double second = std::clamp(value / norm, -h, h);
      foot[v] -= second * normal[v];
      distance = (x - foot[v]).norm();
      if (is_inside[v]) distance = -distance;
    }
  }
  phi[v] = static_cast<float>(std::isfinite(distance) ? distance / h : is_inside[v] ? -far() : far());
}

void ClassificationBand::measure(const Context& context) {
  const std::size_t n = size();
  type.resize(n);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, kVerticesPerTask), [&](const auto& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v) {
      type[v] = links_.type(id[v]);
    }
  });
  first_.assign(n + 1, 0);
  for (std::size_t v = 0; v < n; ++v) {
    first_[v + 1] = first_[v] + static_cast<std::size_t>(links_.of_type(type[v]).n);
  }
  if (known_) {
    known_at_.assign(n, -1);
    for (std::size_t v = 0, k = 0; v < n && k < known_->size();) {
      if ((*known_)[k].vertex == id[v]) known_at_[v] = static_cast<int>(k);
      (*known_)[k].vertex <= id[v] ? ++k : ++v;
    }
  }
  ranks_ = reserved<int>(first_[n]);
  ranks_.resize(first_[n], -1);
  is_inside.resize(n);
  held.assign(n, 0);
  mask = touched<LinkMask>(n);
  phi.resize(n);
  foot = touched<Vec3>(n);
  normal = touched<Vec3>(n);
  movable.assign(n, 0);
  psi_evaluations = sum_asking<std::size_t>(psi_, 0, n, kFeetPerTask, context, [&](std::size_t v, std::size_t& sum) {
    const bool complete = find_link(v);
    // A vertex without its whole link in the band is there to complete the masks of others.
    if (!complete && (mask[v] == 0 || mask[v] == links_.of_type(type[v]).full())) {
      phi[v] = is_inside[v] ? -far() : far();
      return;
    }
    find_foot(v, sum);
    movable[v] =
        complete && phi[v] >= -params_.reach_in && phi[v] <= params_.reach_out && !background_.on_boundary(id[v]);
  });
}

bool ClassificationBand::has_foot(int v) const { return std::abs(phi[v]) < kFarthestFoot; }

/// A vertex keeps its state where projection to the surface would stretch the faces around it by more than
/// most_stretch: lengths at depth d under a surface of curvature kappa grow by 1 / (1 - kappa d) on the way. The
/// curvature is the greatest one estimated between the foot of the vertex and those of its neighbours, signed for the
/// side it is on.
void ClassificationBand::hold_where_stretched(const Context& context) {
  const double most = 1 - 1 / params_.most_stretch;
  polled_parallel_for(size(), kValuesPerPoll, context, [&](std::size_t v) {
    if (!movable[v]) return;
    const double apart = kApart * background_.h(id[v]);
    double kappa = 0;
    for (int k = 0; k < links_.of_type(type[v]).n; ++k) {
      const int w = link(v)[static_cast<std::size_t>(k)];
      if (!has_foot(w)) continue;
      const Vec3 between = foot[w] - foot[v];
      if (between.norm() < apart) continue;
      kappa = std::max(kappa, (phi[v] > 0 ? -1 : 1) * between.dot(normal[w] - normal[v]) / between.squaredNorm());
    }
    if (kappa * std::abs(phi[v]) * unit(v) > most) movable[v] = 0, held[v] = 1;
  });
}

/// Blocks of kBlock^3 cells.
void ClassificationBand::make_blocks() {
  if (!background_.is_lattice()) {
    for (std::uint32_t v = 0; v < size(); ++v) {
      if (movable[v]) order.push_back(v);
    }
    blocks[0].push_back({0, static_cast<std::uint32_t>(order.size())});
    return;
  }
  const auto& n = background_.n_cells();
  const std::int64_t nx = (n[0] + 2) / kBlock + 1, ny = (n[1] + 2) / kBlock + 1, nz = (n[2] + 2) / kBlock + 1;
  std::vector<std::uint32_t> block(size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size(), kVerticesPerTask), [&](const auto& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v) {
      if (!is_visited(v)) continue;
      const auto cell = background_.cell(id[v]);
      const std::int64_t i = (cell[0] + 1) / kBlock, j = (cell[1] + 1) / kBlock, k = (cell[2] + 1) / kBlock;
      block[v] = static_cast<std::uint32_t>(i + nx * (j + ny * k));
    }
  });
  std::vector<std::uint32_t> end(static_cast<std::size_t>(nx * ny * nz) + 1, 0);
  for (std::size_t v = 0; v < size(); ++v) end[block[v] + 1] += is_visited(v);
  std::partial_sum(end.begin(), end.end(), end.begin());
  order.resize(end.back());
  for (std::uint32_t v = 0; v < size(); ++v) {
    if (is_visited(v)) order[end[block[v]]++] = v;
  }
  std::uint32_t begin = 0;
  for (std::size_t b = 0; b + 1 < end.size(); begin = end[b++]) {
    if (end[b] == begin) continue;
    const auto at = static_cast<std::int64_t>(b);
    const std::int64_t i = at % nx, j = at / nx % ny, k = at / nx / ny;
    blocks[static_cast<std::size_t>((i & 1) + 2 * (j & 1) + 4 * (k & 1))].push_back({begin, end[b]});
  }
}

}  // namespace umtet
