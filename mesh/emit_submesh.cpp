#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <stdexcept>

#include "mesh/detail/assemble_submesh.h"
#include "mesh/lattice_shell.h"

namespace umtet {
namespace {

using detail::IdSet;

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

/// What a slab of cells, one thick in z, adds to omega_h.
struct Slab {
  std::size_t n_tets = 0, n_positive = 0;
};

}  // namespace

Submesh emit_submesh(const BackgroundMesh& background, const IdSet& inside) {
  const CellStencil stencil(background);
  if (!background.is_lattice() || !stencil.fits_a_word()) {
    return detail::assemble_submesh(background, detail::cut_or_inside_tets(background, inside), inside);
  }
  const auto& n = background.n_cells();
  const auto n_slabs = static_cast<std::size_t>(n[2]);
  const std::size_t per_cell = stencil.bits.size();
  const std::uint64_t all =
      stencil.step.size() == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << stencil.step.size()) - 1;
  IdSet used(background.n_vertices()), positive(background.n_vertices());

  const auto for_each_cell = [&](std::size_t slab, const auto& f) {
    for (std::int64_t j = 0; j < n[1]; ++j) {
      for (std::int64_t i = 0; i < n[0]; ++i) {
        const std::int64_t first = background.vertex_id(0, {i, j, static_cast<std::int64_t>(slab)});
        const std::uint64_t in = stencil.inside(inside, first);
        if (in != 0) f(first, i + n[0] * (j + n[1] * static_cast<std::int64_t>(slab)), in);
      }
    }
  };

  std::vector<Slab> begin(n_slabs + 1);
  tbb::parallel_for(std::size_t{0}, n_slabs, [&](std::size_t s) {
    Slab& slab = begin[s + 1];
    for_each_cell(s, [&](std::int64_t first, std::int64_t, std::uint64_t in) {
      std::uint64_t touched = in == all ? all : 0, on_boundary = 0;
      if (in == all) {
        slab.n_tets += per_cell;
      } else {
        for (const std::uint64_t tet : stencil.bits) {
          const int n_inside = std::popcount(in & tet);
          if (n_inside == 0) continue;
          touched |= tet;
          ++slab.n_tets;
          if (n_inside == 1) on_boundary |= tet & ~in, ++slab.n_positive;
        }
      }
      for (; touched != 0; touched &= touched - 1) used.insert_shared(first + stencil.step[std::countr_zero(touched)]);
      for (; on_boundary != 0; on_boundary &= on_boundary - 1) {
        positive.insert_shared(first + stencil.step[std::countr_zero(on_boundary)]);
      }
    });
  });
  for (std::size_t s = 0; s < n_slabs; ++s) {
    begin[s + 1].n_tets += begin[s].n_tets;
    begin[s + 1].n_positive += begin[s].n_positive;
  }
  constexpr std::size_t kMost = std::numeric_limits<int>::max();
  const std::size_t n_vertices = used.index(), n_positive_vertices = positive.index();
  if (begin.back().n_tets > kMost || n_vertices > kMost) {
    throw std::length_error("omega_h: more than 2^31 - 1 tets or vertices");
  }

  Submesh result;
  result.background_vertex.resize(n_vertices);
  result.mesh.V.resize(n_vertices);
  result.positive_vertices.resize(n_positive_vertices);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, used.n_words(), kWordsPerTask), [&](const auto& words) {
    for (std::size_t w = words.begin(); w != words.end(); ++w) {
      for (std::uint64_t bits = used.word(w); bits != 0; bits &= bits - 1) {
        const std::int64_t v = static_cast<std::int64_t>(w * 64) + std::countr_zero(bits);
        const int at = used.rank(v);
        result.background_vertex[at] = v;
        result.mesh.V[at] = background.position(v);
        if (positive.test(v)) result.positive_vertices[positive.rank(v)] = at;
      }
    }
  });
  result.mesh.C.resize(begin.back().n_tets);
  result.background_tet.resize(begin.back().n_tets);
  result.positive_faces.resize(begin.back().n_positive);
  result.positive_tets.resize(begin.back().n_positive);
  tbb::parallel_for(std::size_t{0}, n_slabs, [&](std::size_t s) {
    Slab at = begin[s];
    std::array<int, 64> local{};
    for_each_cell(s, [&](std::int64_t first, std::int64_t cell, std::uint64_t in) {
      for (std::size_t c = 0; c < stencil.step.size(); ++c) {
        const std::int64_t v = first + stencil.step[c];
        local[c] = used.rank(v);  // of a vertex that is not used: not read below
      }
      for (std::size_t t = 0; t < per_cell; ++t) {
        const std::uint64_t in_tet = in & stencil.bits[t];
        if (in_tet == 0) continue;
        const auto& corners = stencil.corners[t];
        const Tet tet = {local[corners[0]], local[corners[1]], local[corners[2]], local[corners[3]]};
        if (std::has_single_bit(in_tet)) {
          const int alone = std::countr_zero(in_tet);
          int k = 0;
          while (corners[k] != alone) ++k;
          const auto& face = kTetFace[k];
          result.positive_faces[at.n_positive] = {tet[face[0]], tet[face[1]], tet[face[2]]};
          result.positive_tets[at.n_positive++] = static_cast<int>(at.n_tets);
        }
        result.background_tet[at.n_tets] = static_cast<std::int64_t>(t) + static_cast<std::int64_t>(per_cell) * cell;
        result.mesh.C[at.n_tets++] = tet;
      }
    });
  });
  return result;
}

}  // namespace umtet
