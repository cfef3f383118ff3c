#include "mesh/submesh.h"

#include <oneapi/tbb/blocked_range.h>
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

#include "mesh/detail/assemble_submesh.h"
#include "mesh/detail/id_set.h"

namespace umtet {
namespace {

using detail::IdSet;

// 64 vertices share a word: 16 words are a thousand evaluations of psi, enough to hide the cost of a task.
constexpr std::size_t kWordsPerTask = 16;
constexpr std::int64_t kTetsPerBlock = 1 << 16;
// Side of the coarse sampling of h_for_tets.
constexpr int kSamples = 64;

/// Tets in a cube whose edge is that of an A15 cell of the same h.
double tets_per_cube(const Tiling& tiling) {
  const double a15_cells = tiling.mean_edge / a15().mean_edge;  // a unit of the tiling is 1 / this of such an edge
  return static_cast<double>(tiling.tets.size()) / (tiling.period[0] * tiling.period[1] * tiling.period[2]) *
         (a15_cells * a15_cells * a15_cells);
}

unsigned inside_mask(const std::array<std::int64_t, 4>& tet, const IdSet& inside) {
  unsigned mask = 0;
  for (unsigned k = 0; k < 4; ++k) mask |= static_cast<unsigned>(inside.test(tet[k])) << k;
  return mask;
}

}  // namespace

std::vector<std::int64_t> detail::cut_or_inside_tets(const BackgroundMesh& background, const IdSet& inside) {
  const std::int64_t n_blocks = (background.n_tets() + kTetsPerBlock - 1) / kTetsPerBlock;
  std::vector<std::vector<std::int64_t>> blocks(static_cast<std::size_t>(n_blocks));
  tbb::parallel_for(std::int64_t{0}, n_blocks, [&](std::int64_t b) {
    const std::int64_t end = std::min((b + 1) * kTetsPerBlock, background.n_tets());
    for (std::int64_t t = b * kTetsPerBlock; t < end; ++t) {
      if (inside_mask(background.tet(t), inside) != 0) blocks[b].push_back(t);
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

namespace {

struct CoarseMeasure {
  double volume = 0, area = 0;
  Box inside;  ///< of the samples inside, a sample wider on every side
};

/// Volume and area of {psi < 0} from the signs of psi on a lattice: counted points for the volume, Cauchy-Crofton for
/// the area (a unit of area is crossed by 3/2 lattice lines per d^2, averaged over normals).
CoarseMeasure sample(ImplicitFunctionRef psi, const Box& box) {
  const double d = box.sizes().maxCoeff() / kSamples;
  const Eigen::Array3i n = (box.sizes().array() / d).ceil().cast<int>().max(1) + 1;
  std::vector<double> values(static_cast<std::size_t>(n.prod()));
  const Vec3 origin = box.center() - .5 * d * (n - 1).cast<double>().matrix();
  tbb::parallel_for(0, n.z(), [&](int k) {
    for (int j = 0; j < n.y(); ++j) {
      for (int i = 0; i < n.x(); ++i) values[i + n.x() * (j + n.y() * k)] = psi.value(origin + d * Vec3(i, j, k));
    }
  });
  double inside = 0, crossings = 0;
  Box found;
  const std::array<int, 3> stride = {1, n.x(), n.x() * n.y()};
  for (int k = 0; k < n.z(); ++k) {
    for (int j = 0; j < n.y(); ++j) {
      for (int i = 0; i < n.x(); ++i) {
        const std::size_t at = i + n.x() * (j + n.y() * static_cast<std::size_t>(k));
        const std::array<int, 3> index = {i, j, k};
        if (values[at] < 0) {
          ++inside;
          found.extend(origin + d * Vec3(i, j, k));
        }
        for (int a = 0; a < 3; ++a) {
          if (index[a] + 1 < n[a]) crossings += (values[at] < 0) != (values[at + stride[a]] < 0);
        }
      }
    }
  }
  if (!found.isEmpty()) found = Box(found.min() - Vec3::Constant(d), found.max() + Vec3::Constant(d)).intersection(box);
  return {inside * d * d * d, crossings * d * d / 1.5, found};
}

/// A body in a large box is sampled again in its own.
CoarseMeasure measure(ImplicitFunctionRef psi, const Box& box) {
  // Below this share of the box's side, samples are too few for 10 %.
  constexpr double kTooSmall = .5;
  const CoarseMeasure first = sample(psi, box);
  if (first.inside.isEmpty()) return first;
  const bool small = first.inside.sizes().maxCoeff() < kTooSmall * box.sizes().maxCoeff();
  return small ? sample(psi, first.inside) : first;
}

void check_box(const Box& box) {
  if (box.isEmpty() || !box.sizes().allFinite()) throw std::invalid_argument("box: must be finite and not empty");
}

}  // namespace

namespace detail {

IdSet inside_vertices(const BackgroundMesh& background, ImplicitFunctionRef psi, std::size_t& n_evaluations,
                      const KeepGoing& keep_going) {
  IdSet inside(background.n_vertices());
  std::atomic<std::size_t> evaluations = 0;
  const auto evaluate = [&](const tbb::blocked_range<std::size_t>& words) {
    std::size_t n = 0;
    for (std::size_t w = words.begin(); w != words.end(); ++w) {
      std::uint64_t bits = 0;
      const std::int64_t first = static_cast<std::int64_t>(w * 64);
      const std::int64_t last = std::min(first + 64, background.n_vertices());
      for (std::int64_t v = first; v < last; ++v) {
        if (!background.has_tets(v)) continue;
        ++n;
        if (psi.value(background.position(v)) < 0) bits |= std::uint64_t{1} << (v - first);
      }
      inside.set_word(w, bits);
    }
    evaluations += n;
  };
  // A vertex's position costs as much as the cheapest psi: a thousandth of the time goes into questions.
  constexpr std::size_t kWordsPerPoll = 4 * kValuesPerPoll / 64;
  for (std::size_t begin = 0; begin < inside.n_words(); begin += kWordsPerPoll) {
    poll(keep_going);
    const std::size_t end = std::min(inside.n_words(), begin + kWordsPerPoll);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, kWordsPerTask), evaluate);
  }
  n_evaluations = evaluations;
  return inside;
}

Submesh assemble_submesh(const BackgroundMesh& background, std::vector<std::int64_t> tets, const IdSet& inside) {
  constexpr std::size_t kMost = std::numeric_limits<int>::max();
  IdSet used(background.n_vertices()), positive(background.n_vertices());
  Submesh result;
  std::vector<unsigned char> masks(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    const auto vertices = background.tet(tets[t]);
    const unsigned mask = inside_mask(vertices, inside);
    masks[t] = static_cast<unsigned char>(mask);
    for (unsigned k = 0; k < 4; ++k) {
      used.insert(vertices[k]);
      if (is_positively_cut(mask) && !(mask >> k & 1)) positive.insert(vertices[k]);  // Alg. 1, step 18
    }
  }
  const std::size_t n_vertices = used.index();
  if (tets.size() > kMost || n_vertices > kMost)
    throw std::length_error("omega_h: more than 2^31 - 1 tets or vertices");

  result.background_vertex.reserve(n_vertices);
  result.mesh.V.reserve(n_vertices);
  used.for_each([&](std::int64_t v) {
    result.background_vertex.push_back(v);
    result.mesh.V.push_back(background.position(v));  // Alg. 1, step 21
  });
  positive.for_each([&](std::int64_t v) { result.positive_vertices.push_back(used.rank(v)); });

  result.mesh.C.resize(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    const auto vertices = background.tet(tets[t]);
    Tet& tet = result.mesh.C[t];
    for (int k = 0; k < 4; ++k) tet[k] = used.rank(vertices[k]);
    if (!is_positively_cut(masks[t])) continue;
    const auto& face = kTetFace[std::countr_zero(static_cast<unsigned>(masks[t]))];
    result.positive_faces.push_back({tet[face[0]], tet[face[1]], tet[face[2]]});
    result.positive_tets.push_back(static_cast<int>(t));
  }
  result.background_tet = std::move(tets);
  return result;
}

}  // namespace detail

Submesh find_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, std::size_t* n_psi_evaluations,
                     const KeepGoing& keep_going) {
  std::size_t n = 0;
  const IdSet inside = detail::inside_vertices(background, psi, n, keep_going);
  if (n_psi_evaluations) *n_psi_evaluations = n;
  poll(keep_going);
  return detail::assemble_submesh(background, detail::cut_or_inside_tets(background, inside), inside);
}

double expected_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double h) {
  if (!(h > 0)) throw std::invalid_argument("h = " + std::to_string(h) + ": must be > 0");
  check_box(box);
  const auto [volume, area, inside] = measure(psi, box);
  const double a = h / a15().mean_edge;
  return tets_per_cube(tiling) * (volume + tiling.excess_layer * a * area) / (a * a * a);
}

double expected_tets(ImplicitFunctionRef psi, const Box& box, double h) { return expected_tets(a15(), psi, box, h); }

double h_for_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double n_tets) {
  if (!(n_tets > 0)) throw std::invalid_argument("n_tets = " + std::to_string(n_tets) + ": must be > 0");
  check_box(box);
  const auto [volume, area, inside] = measure(psi, box);
  if (!(volume > 0)) throw std::invalid_argument("psi: not negative at any of the samples taken in the box");
  // n a^3 = per_cube (volume + layer a area): a fixed point, contracting because the layer is a part of the whole.
  const double per_cube = tets_per_cube(tiling);
  double a = std::cbrt(per_cube * volume / n_tets);
  for (int i = 0; i < 50; ++i) a = std::cbrt(per_cube * (volume + tiling.excess_layer * a * area) / n_tets);
  return a * a15().mean_edge;
}

double h_for_tets(ImplicitFunctionRef psi, const Box& box, double n_tets) {
  return h_for_tets(a15(), psi, box, n_tets);
}

}  // namespace umtet
