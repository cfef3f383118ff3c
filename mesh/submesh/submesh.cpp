#include "mesh/submesh/submesh.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/polled_loops.h"
#include "mesh/background/tet_reader.h"
#include "mesh/base/id_set.h"
#include "mesh/core/asking_psi.h"
#include "mesh/submesh/assemble_submesh.h"

namespace umtet {
namespace {

// 64 vertices share a word: 16 words are a thousand evaluations of psi, enough to hide the cost of a task.
constexpr std::size_t kWordsPerTask = 16;
constexpr std::size_t kWordsPerPoll = kValuesPerPoll / 64;
constexpr std::int64_t kTetsPerBlock = 1 << 14;

unsigned inside_mask(const std::array<std::int64_t, 4>& tet, const IdSet& inside) {
  unsigned mask = 0;
  for (unsigned k = 0; k < 4; ++k) mask |= static_cast<unsigned>(inside.test(tet[k])) << k;
  return mask;
}

/// Inserts the vertices where psi < 0, a psi that is asked in blocks. @return evaluations
std::size_t insert_in_blocks(const BackgroundMesh& background, ImplicitFunctionRef psi, IdSet& inside,
                             const Context& context) {
  std::vector<std::int64_t> asked;
  const auto ask = [&] {
    take_in_blocks(
        psi, asked.size(), context, [&](std::size_t i) { return background.position(asked[i]); },
        [&](std::size_t i, double value) {
          if (value < 0) inside.insert(asked[i]);
        });
    asked.clear();
  };
  std::size_t n = 0;
  for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
    if (!background.has_tets(v)) continue;
    ++n;
    asked.push_back(v);
    if (asked.size() == kPointsPerBlock) ask();
  }
  ask();
  return n;
}

/// Which background vertices are corners of omega_h, and which of those positive.
struct Corners {
  IdSet used, positive;

  explicit Corners(std::int64_t n_vertices) : used(n_vertices), positive(n_vertices) {}
  void add(const std::array<std::int64_t, 4>& vertices, unsigned mask) {
    for (unsigned k = 0; k < 4; ++k) {
      used.insert_shared(vertices[k]);
      if (is_positively_cut(mask) && !(mask >> k & 1)) positive.insert_shared(vertices[k]);  // Alg. 1, step 18
    }
  }
  /// Those alone. \throw std::length_error for more than 2^31 - 1, of tets, too
  Submesh vertices(const BackgroundMesh& background, std::size_t n_tets) {
    constexpr std::size_t kMost = std::numeric_limits<int>::max();
    const std::size_t n = used.index();
    if (n_tets > kMost || n > kMost) throw std::length_error("omega_h: more than 2^31 - 1 tets or vertices");
    Submesh result;
    result.background_vertex.reserve(n);
    used.for_each([&](std::int64_t v) { result.background_vertex.push_back(v); });
    result.mesh.V.resize(n);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      result.mesh.V[i] = background.position(result.background_vertex[i]);  // Alg. 1, step 21
    });
    positive.for_each([&](std::int64_t v) { result.positive_vertices.push_back(used.rank(v)); });
    return result;
  }
};

std::int64_t n_blocks(std::int64_t n) { return (n + kTetsPerBlock - 1) / kTetsPerBlock; }

/// f(block, reader, first, end) for the numbers 0 .. n - 1 by blocks, with threads.
template <class F>
void for_each_block(const BackgroundMesh& background, std::int64_t n, const F& f) {
  tbb::parallel_for(std::int64_t{0}, n_blocks(n), [&](std::int64_t b) {
    TetReader reader(background);
    f(b, reader, b * kTetsPerBlock, std::min((b + 1) * kTetsPerBlock, n));
  });
}

}  // namespace

IdSet inside_vertices(const BackgroundMesh& background, ImplicitFunctionRef psi, std::size_t& n_evaluations,
                      const Context& context, const KnownSigns& known) {
  IdSet inside(background.n_vertices());
  if (psi.side_by_side()) {
    n_evaluations = insert_in_blocks(background, psi, inside, context);
    return inside;
  }
  n_evaluations = polled_parallel_sum<std::size_t>(
      0, inside.n_words(), kWordsPerTask, kWordsPerPoll, context, [&](std::size_t w, std::size_t& n) {
        std::uint64_t bits = 0;
        const std::int64_t first = static_cast<std::int64_t>(w * 64);
        const std::int64_t last = std::min(first + 64, background.n_vertices());
        Vec3 before = Vec3::Constant(std::numeric_limits<double>::infinity());
        bool is_inside = false;
        for (std::int64_t v = first; v < last; ++v) {
          if (!background.has_tets(v)) continue;
          const Vec3 x = background.position(v);
          const bool is_near = known.far && (x - before).cwiseAbs().maxCoeff() <= known.reach;
          if (!is_near || !known.far(x)) {
            ++n;
            is_inside = psi.value(x) < 0;
          }
          before = x;
          if (is_inside) bits |= std::uint64_t{1} << (v - first);
        }
        inside.set_word(w, bits);
      });
  return inside;
}

std::vector<std::int64_t> cut_or_inside_tets(const BackgroundMesh& background, const IdSet& inside) {
  std::vector<std::vector<std::int64_t>> blocks(static_cast<std::size_t>(n_blocks(background.n_tets())));
  for_each_block(background, background.n_tets(),
                 [&](std::int64_t b, TetReader& reader, std::int64_t first, std::int64_t end) {
                   for (std::int64_t t = first; t < end; ++t) {
                     if (inside_mask(reader.tet(t), inside) != 0) blocks[b].push_back(t);
                   }
                 });
  std::size_t n = 0;
  for (const auto& block : blocks) n += block.size();
  std::vector<std::int64_t> tets;
  tets.reserve(n);
  for (auto& block : blocks) {
    tets.insert(tets.end(), block.begin(), block.end());
    block = {};
  }
  return tets;
}

Submesh assemble_submesh(const BackgroundMesh& background, std::vector<std::int64_t> tets, const IdSet& inside) {
  Corners corners(background.n_vertices());
  std::vector<unsigned char> masks(tets.size());
  const auto n_tets = static_cast<std::int64_t>(tets.size());
  for_each_block(background, n_tets, [&](std::int64_t, TetReader& reader, std::int64_t first, std::int64_t end) {
    for (std::int64_t t = first; t < end; ++t) {
      const auto vertices = reader.tet(tets[t]);
      const unsigned mask = inside_mask(vertices, inside);
      masks[t] = static_cast<unsigned char>(mask);
      corners.add(vertices, mask);
    }
  });
  Submesh result = corners.vertices(background, tets.size());
  result.mesh.C.resize(tets.size());
  for_each_block(background, n_tets, [&](std::int64_t, TetReader& reader, std::int64_t first, std::int64_t end) {
    for (std::int64_t t = first; t < end; ++t) {
      const auto vertices = reader.tet(tets[t]);
      for (std::size_t k = 0; k < 4; ++k) result.mesh.C[t][k] = corners.used.rank(vertices[k]);
    }
  });
  for (std::size_t t = 0; t < tets.size(); ++t) {
    if (!is_positively_cut(masks[t])) continue;
    const Tet& tet = result.mesh.C[t];
    const auto& face = kTetFace[std::countr_zero(static_cast<unsigned>(masks[t]))];
    result.positive_faces.push_back({tet[face[0]], tet[face[1]], tet[face[2]]});
    result.positive_tets.push_back(static_cast<int>(t));
  }
  result.background_tet = std::move(tets);
  return result;
}

Submesh assemble_vertices(const BackgroundMesh& background, const IdSet& inside, std::size_t& n_tets) {
  Corners corners(background.n_vertices());
  std::atomic<std::size_t> n = 0;
  for_each_block(background, background.n_tets(),
                 [&](std::int64_t, TetReader& reader, std::int64_t first, std::int64_t end) {
                   std::size_t of_block = 0;
                   for (std::int64_t t = first; t < end; ++t) {
                     const auto vertices = reader.tet(t);
                     const unsigned mask = inside_mask(vertices, inside);
                     if (mask == 0) continue;
                     ++of_block;
                     corners.add(vertices, mask);
                   }
                   n += of_block;
                 });
  n_tets = n;
  return corners.vertices(background, n_tets);
}

Submesh find_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, std::size_t* n_psi_evaluations,
                     const Context& context, const KnownSigns& known) {
  std::size_t n = 0;
  const IdSet inside = inside_vertices(background, psi, n, context, known);
  if (n_psi_evaluations) *n_psi_evaluations = n;
  context.poll();
  return assemble_submesh(background, cut_or_inside_tets(background, inside), inside);
}

}  // namespace umtet
