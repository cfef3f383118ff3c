#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/first_touch.h"
#include "mesh/submesh/assemble_submesh.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {
namespace {

// Words of 64 vertices: some thousand positions.
constexpr std::size_t kWordsPerTask = 32;

/// The tets of one cell by their corners among all corners of a cell's tets (27 of A15), as bits. Of no use, and not
/// complete, if these do not fit a word.
struct CellStencil {
  std::vector<std::int64_t> step;           ///< id of each corner minus that of vertex type 0 of the cell
  std::vector<std::array<int, 4>> corners;  ///< of each tet
  std::vector<std::uint64_t> bits;          ///< of each tet

  explicit CellStencil(const BackgroundMesh& background) {
    std::vector<Tiling::Corner> seen;
    for (const auto& tet : background.tiling().tets) {
      std::array<int, 4> at{};
      std::uint64_t mask = 0;
      for (int k = 0; k < 4; ++k) {
        std::size_t c = 0;
        while (c < seen.size() && !(seen[c].type == tet[k].type && seen[c].offset == tet[k].offset)) ++c;
        if (c == seen.size()) {
          seen.push_back(tet[k]);
          step.push_back(background.id_step(0, tet[k]));
          if (!fits_a_word()) return;
        }
        at[k] = static_cast<int>(c);
        mask |= std::uint64_t{1} << c;
      }
      corners.push_back(at);
      bits.push_back(mask);
    }
  }
  bool fits_a_word() const { return step.size() <= 64; }
  std::uint64_t inside(const IdSet& set, std::int64_t first) const {
    std::uint64_t mask = 0;
    for (std::size_t c = 0; c < step.size(); ++c) mask |= static_cast<std::uint64_t>(set.test(first + step[c])) << c;
    return mask;
  }
};

/// What the slabs of cells below one add to omega_h; a slab is one cell thick in z.
struct Slab {
  std::size_t n_tets = 0, n_positive = 0;
};

/// Two passes over the cells: the first counts tets and faces, the second writes them to their places.
class Emitter {
 public:
  Emitter(const BackgroundMesh& background, const CellStencil& stencil, const IdSet& inside)
      : background_(background),
        stencil_(stencil),
        inside_(inside),
        used_(background.n_vertices()),
        positive_(background.n_vertices()),
        begin_(static_cast<std::size_t>(background.n_cells()[2]) + 1) {}

  Submesh operator()() {
    count();
    result_.mesh.C = touched<Tet>(begin_.back().n_tets);
    result_.background_tet = touched<std::int64_t>(begin_.back().n_tets);
    result_.positive_faces.resize(begin_.back().n_positive);
    result_.positive_tets.resize(begin_.back().n_positive);
    emit_vertices();
    emit_tets();
    return std::move(result_);
  }
  SubmeshOutline outline() {
    count();
    emit_vertices();
    return {std::move(result_), begin_.back().n_tets};
  }

 private:
  void count();
  void emit_vertices();
  /// \pre room for all of them
  void emit_tets();
  /// Calls f(slab, first vertex, cell, inside corners) for the cells with any, slabs by all threads.
  template <class F>
  void for_each_cell(const F& f) const;
  bool is_empty_row(std::int64_t j, std::int64_t k) const;

  const BackgroundMesh& background_;
  const CellStencil& stencil_;
  const IdSet& inside_;
  IdSet used_, positive_;
  std::vector<Slab> begin_;
  Submesh result_;
};

/// True if no vertex of the cells of a row is inside: so for most rows of a large background. Looks at 64 bits at once.
bool Emitter::is_empty_row(std::int64_t j, std::int64_t k) const {
  const std::int64_t row = background_.n_types() * (background_.n_cells()[0] + 2);
  for (std::int64_t dk = -1; dk <= 1; ++dk) {
    const std::int64_t first = background_.vertex_id(0, {-1, j - 1, k + dk});
    const std::int64_t last = background_.vertex_id(0, {-1, j + 1, k + dk});
    if (!inside_.is_empty_around(first, last + row)) return false;
  }
  return true;
}

template <class F>
void Emitter::for_each_cell(const F& f) const {
  const auto& n = background_.n_cells();
  tbb::parallel_for(std::int64_t{0}, n[2], [&](std::int64_t k) {
    for (std::int64_t j = 0; j < n[1]; ++j) {
      if (is_empty_row(j, k)) continue;
      for (std::int64_t i = 0; i < n[0]; ++i) {
        const std::int64_t first = background_.vertex_id(0, {i, j, k});
        const std::uint64_t in = stencil_.inside(inside_, first);
        if (in != 0) f(static_cast<std::size_t>(k), first, i + n[0] * (j + n[1] * k), in);
      }
    }
  });
}

void Emitter::count() {
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - stencil_.step.size());
  for_each_cell([&](std::size_t s, std::int64_t first, std::int64_t, std::uint64_t in) {
    Slab& slab = begin_[s + 1];
    std::uint64_t touched = in == all ? all : 0, on_boundary = 0;
    if (in == all) {
      slab.n_tets += stencil_.bits.size();
    } else {
      for (const std::uint64_t tet : stencil_.bits) {
        const int n_inside = std::popcount(in & tet);
        if (n_inside == 0) continue;
        touched |= tet;
        ++slab.n_tets;
        if (n_inside == 1) on_boundary |= tet & ~in, ++slab.n_positive;
      }
    }
    for (; touched != 0; touched &= touched - 1) used_.insert_shared(first + stencil_.step[std::countr_zero(touched)]);
    for (; on_boundary != 0; on_boundary &= on_boundary - 1) {
      positive_.insert_shared(first + stencil_.step[std::countr_zero(on_boundary)]);
    }
  });
  for (std::size_t s = 1; s < begin_.size(); ++s) {
    begin_[s].n_tets += begin_[s - 1].n_tets;
    begin_[s].n_positive += begin_[s - 1].n_positive;
  }
  // There are fewer vertices: each inside one has all its tets.
  if (begin_.back().n_tets > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw std::length_error("omega_h: more than 2^31 - 1 tets");
  }
}

void Emitter::emit_vertices() {
  const std::size_t n_vertices = used_.index(), n_positive_vertices = positive_.index();
  result_.background_vertex = touched<std::int64_t>(n_vertices);
  result_.mesh.V = touched<Vec3>(n_vertices);
  result_.positive_vertices.resize(n_positive_vertices);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, used_.n_words(), kWordsPerTask), [&](const auto& words) {
    for (std::size_t w = words.begin(); w != words.end(); ++w) {
      for (std::uint64_t bits = used_.word(w); bits != 0; bits &= bits - 1) {
        const std::int64_t v = static_cast<std::int64_t>(w * 64) + std::countr_zero(bits);
        const int at = used_.rank(v);
        result_.background_vertex[at] = v;
        result_.mesh.V[at] = background_.position(v);
        if (positive_.test(v)) result_.positive_vertices[positive_.rank(v)] = at;
      }
    }
  });
}

void Emitter::emit_tets() {
  const std::size_t per_cell = stencil_.bits.size();
  std::vector<Slab> next = begin_;
  for_each_cell([&](std::size_t s, std::int64_t first, std::int64_t cell, std::uint64_t in) {
    Slab& at = next[s];
    std::array<int, 64> local{};
    for (std::size_t c = 0; c < stencil_.step.size(); ++c) {
      local[c] = used_.rank(first + stencil_.step[c]);  // of a vertex that is not used: not read below
    }
    for (std::size_t t = 0; t < per_cell; ++t) {
      const std::uint64_t in_tet = in & stencil_.bits[t];
      if (in_tet == 0) continue;
      const auto& corners = stencil_.corners[t];
      const Tet tet = {local[corners[0]], local[corners[1]], local[corners[2]], local[corners[3]]};
      if (std::has_single_bit(in_tet)) {
        const int alone = std::countr_zero(in_tet);
        int k = 0;
        while (corners[k] != alone) ++k;
        const auto& face = kTetFace[k];
        result_.positive_faces[at.n_positive] = {tet[face[0]], tet[face[1]], tet[face[2]]};
        result_.positive_tets[at.n_positive++] = static_cast<int>(at.n_tets);
      }
      result_.background_tet[at.n_tets] = static_cast<std::int64_t>(t) + static_cast<std::int64_t>(per_cell) * cell;
      result_.mesh.C[at.n_tets++] = tet;
    }
  });
}

}  // namespace

Submesh emit_submesh(const BackgroundMesh& background, const IdSet& inside) {
  const CellStencil stencil(background);
  if (!background.is_lattice() || !stencil.fits_a_word()) {
    return assemble_submesh(background, cut_or_inside_tets(background, inside), inside);
  }
  return Emitter(background, stencil, inside)();
}

SubmeshOutline outline_submesh(const BackgroundMesh& background, const IdSet& inside) {
  const CellStencil stencil(background);
  if (background.is_lattice() && stencil.fits_a_word()) return Emitter(background, stencil, inside).outline();
  SubmeshOutline outline;
  outline.submesh = assemble_vertices(background, inside, outline.n_tets);
  return outline;
}

}  // namespace umtet
