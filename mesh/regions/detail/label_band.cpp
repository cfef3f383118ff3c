#include "mesh/regions/detail/label_band.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "common/polled_loops.h"
#include "mesh/base/id_blocks.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/assemble_submesh.h"

namespace umtet::detail {
namespace {

constexpr double kFar = 4;  // edges: beyond every vertex of the band that may be on an interface

/// A function of a region as psi, without ownership.
struct FunctionPsi {
  const PatchFunction* function;
  double value(const Vec3& x) const { return (*function)(x, nullptr, nullptr); }
  Vec3 gradient(const Vec3& x) const {
    Vec3 g;
    (*function)(x, &g, nullptr);
    return g;
  }
};

/// In the outermost layer of cells of a lattice, where a step along an edge may leave the range of ids.
bool is_outermost(const BackgroundMesh& background, std::int64_t v) {
  if (!background.is_lattice()) return false;
  const BackgroundMesh::Cell cell = background.cell(v);
  for (int a = 0; a < 3; ++a)
    if (cell[a] < 0 || cell[a] >= background.n_cells()[a]) return true;
  return false;
}

}  // namespace

std::vector<std::uint8_t> regions_of_vertices(const RegionDomain& domain, const BackgroundMesh& background,
                                              std::size_t& n_evaluations, const Context& context) {
  const auto n = static_cast<std::size_t>(background.n_vertices());
  std::vector<std::uint8_t> region(n, 0);
  if (!domain.has_bodies()) {
    polled_parallel_for(n, kValuesPerPoll, context, [&](std::size_t v) {
      const auto id = static_cast<std::int64_t>(v);
      if (background.has_tets(id)) region[v] = static_cast<std::uint8_t>(domain.region(background.position(id)));
    });
    n_evaluations += n * static_cast<std::size_t>(domain.n_regions());
    return region;
  }
  for (int k = 0; k + 1 < domain.n_regions(); ++k) {
    const FunctionPsi psi{&domain.body(k)};
    std::size_t n_of_body = 0;
    const IdSet inside = inside_vertices(background, ImplicitFunctionRef(psi), n_of_body, context);
    n_evaluations += n_of_body;
    for_each_in_blocks(inside, [&](std::size_t, std::int64_t v) {
      region[static_cast<std::size_t>(v)] = static_cast<std::uint8_t>(k + 1);
    });
  }
  return region;
}

LabelBand::LabelBand(const RegionDomain& domain, const BackgroundMesh& background, const VertexLinks& links,
                     const std::vector<std::uint8_t>& of_vertex, double reach, const PeriodicCells* cells,
                     const Context& context)
    : domain_(domain), background_(background), links_(links), cells_(cells), band_(background.n_vertices()) {
  gather(of_vertex);
  if (leaves_background_) return;
  list_links(of_vertex);
  find_near();
  measure(reach, context);
}

/// The ends of edges between two regions, and three rings around them.
void LabelBand::gather(const std::vector<std::uint8_t>& of_vertex) {
  const auto n = of_vertex.size();
  std::atomic<bool> leaves = false;
  const auto label_of = [&](std::int64_t w) {
    return static_cast<std::uint64_t>(w) < n ? of_vertex[static_cast<std::size_t>(w)] : std::uint8_t{0};
  };
  // From the greater of two regions, which is not 0: only such a vertex may have a neighbour with another label.
  tbb::parallel_for(std::size_t{0}, n_blocks(band_), [&](std::size_t b) {
    const std::size_t end = std::min(n, (b + 1) * kWordsPerBlock * 64);
    for (std::size_t v = b * kWordsPerBlock * 64; v < end; ++v) {
      if (of_vertex[v] == 0) continue;
      const auto id = static_cast<std::int64_t>(v);
      if (representative(id) != id) continue;
      if (background_.on_boundary(id)) {
        leaves = true;
        continue;
      }
      links_.for_each(id, [&](std::int64_t copy) {
        const std::int64_t w = representative(copy);
        if (label_of(w) >= of_vertex[v]) return;
        band_.insert_shared(id);
        band_.insert_shared(w);
      });
    }
  });
  leaves_background_ = leaves;
  if (leaves_background_) return;
  IdSet front = band_;
  for (int ring = 0; ring < 3; ++ring) {
    IdSet next(background_.n_vertices());
    for_each_in_blocks(front, [&](std::size_t, std::int64_t v) {
      if (is_outermost(background_, v)) return;
      links_.for_each(v, [&](std::int64_t copy) {
        const std::int64_t w = representative(copy);
        if (static_cast<std::uint64_t>(w) < n && !band_.test(w)) next.insert_shared(w);
      });
    });
    for (std::size_t w = 0; w < next.n_words(); ++w) band_.set_word(w, band_.word(w) | next.word(w));
    front = std::move(next);
  }
  ids_.resize(static_cast<std::size_t>(band_.index()));
  for_each_in_blocks(band_, [&](std::size_t, std::int64_t v) { ids_[static_cast<std::size_t>(band_.rank(v))] = v; });
}

void LabelBand::list_links(const std::vector<std::uint8_t>& of_vertex) {
  const std::size_t n = ids_.size();
  type_.resize(n);
  label.resize(n);
  is_complete_.resize(n);
  first_.assign(n + 1, 0);
  for (std::size_t v = 0; v < n; ++v) {
    type_[v] = links_.type(ids_[v]);
    label[v] = of_vertex[static_cast<std::size_t>(ids_[v])];
    is_complete_[v] = !is_outermost(background_, ids_[v]) && !background_.on_boundary(ids_[v]);
    first_[v + 1] = first_[v] + static_cast<std::size_t>(links_.of_type(type_[v]).n);
  }
  codes_.assign(first_[n], -1);  // region 0, beyond the band
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t v) {
    if (!is_complete_[v]) return;
    std::size_t k = first_[v];
    links_.for_each(ids_[v], [&](std::int64_t copy) {
      const std::int64_t w = representative(copy);
      codes_[k++] = band_.test_any(w) ? band_.rank(w) : -1 - of_vertex[static_cast<std::size_t>(w)];
    });
  });
}

void LabelBand::find_near() {
  near_.resize(size());
  for (std::size_t v = 0; v < size(); ++v) near_[v] = RegionSet{1} << label[v];
  for (int ring = 0; ring < 2; ++ring) {
    const std::vector<RegionSet> before = near_;
    for (std::size_t v = 0; v < size(); ++v)
      for (const int w : link(static_cast<int>(v))) near_[v] |= w >= 0 ? before[w] : RegionSet{1} << label_beyond(w);
  }
}

void LabelBand::measure(double reach, const Context& context) {
  distances_.resize(size());
  is_movable.assign(size(), 0);
  polled_parallel_for(size(), kValuesPerPoll, context, [&](std::size_t v) {
    if (std::popcount(near_[v]) < 2) return;
    std::vector<PatchDistance>& list = distances_[v];
    const Vec3 x = background_.position(ids_[v]);
    const double h = background_.h(ids_[v]);
    double nearest = kFar;
    for (RegionSet as = near_[v]; as != 0; as &= as - 1) {
      const int a = std::countr_zero(as);
      for (RegionSet bs = near_[v] & ((RegionSet{1} << a) - 1); bs != 0; bs &= bs - 1) {
        const int b = std::countr_zero(bs), patch = domain_.patch(a, b);
        if (std::any_of(list.begin(), list.end(), [&](const PatchDistance& d) { return d.patch == patch; })) continue;
        Vec3 g;
        const double value = domain_.boundary().patch(patch, x, &g), distance = value / (g.norm() * h);
        list.push_back({patch, std::isfinite(distance) ? std::clamp(distance, -kFar, kFar) : kFar});
        nearest = std::min(nearest, std::abs(list.back().distance));
      }
    }
    is_movable[v] = is_complete_[v] != 0 && nearest <= reach;
  });
  for (const auto& list : distances_) n_evaluations_ += list.size();
}

Vec3 LabelBand::to_copy(int v, int k) const {
  if (!cells_) return Vec3::Zero();
  const std::int64_t w = links_.neighbour(ids_[static_cast<std::size_t>(v)], k);
  return background_.position(w) - background_.position(cells_->representative(w));
}

double LabelBand::distance(int v, int a, int b) const {
  const int patch = domain_.patch(a, b);
  for (const PatchDistance& d : distances_[v])
    if (d.patch == patch) return d.distance;
  return kFar;
}

void LabelBand::shrink(double shift) {
  for (std::size_t v = 0; v < size(); ++v) {
    if (!is_movable[v]) continue;
    // The greatest region of those near v that is deep enough below its sheets with all lower ones found so far.
    int now = std::countr_zero(near_[v]);
    for (RegionSet rest = near_[v] & (near_[v] - 1); rest != 0; rest &= rest - 1) {
      const int next = std::countr_zero(rest);
      if (distance(static_cast<int>(v), next, now) < -shift) now = next;
    }
    label[v] = static_cast<std::uint8_t>(now);
  }
}

}  // namespace umtet::detail
