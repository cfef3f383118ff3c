#include "reconstruct/solve/ssd_band.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "common/first_touch.h"
#include "reconstruct/basis/contract.h"
#include "reconstruct/basis/cross_gram.h"
#include "reconstruct/solve/detail/sample_basis.h"

namespace umtet {

namespace {

constexpr int kEdge = LatticeBlocks::kEdge, kNodes = LatticeBlocks::kNodes;
// The nodes of a cell block: two blocks along each axis.
constexpr int kWindow = 2 * kEdge, kWindowNodes = kWindow * kWindow * kWindow;
constexpr std::integral_constant<int, kWindow> kRow;
constexpr std::integral_constant<int, kWindow * kWindow> kPlane;

using Lanes = detail::FloatPack;
using In = detail::FloatIn;
using detail::float_pack;
template <int W>
using Basis = detail::SampleBasis<W>;

void sort_and_unite(std::vector<Eigen::Vector3i>& blocks) {
  tbb::parallel_sort(blocks.begin(), blocks.end(), [](const auto& a, const auto& b) {
    return std::array{a[2], a[1], a[0]} < std::array{b[2], b[1], b[0]};
  });
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
}

}  // namespace

// The node blocks that the functions of the samples' cells belong to.
std::vector<Eigen::Vector3i> SsdBand::blocks_of(const std::vector<SsdSample>& samples, int half_width) {
  const int reach = 2 * half_width - 1;  // the window of cell c ends in block (c + reach) / 8: its own or the next
  const std::vector<std::size_t> runs = block_runs(samples);
  std::vector<unsigned> ends(runs.size() - 1, 0);  // a bit for each of the eight blocks in which a window ends
  tbb::parallel_for(std::size_t{0}, ends.size(), [&](std::size_t run) {
    const Eigen::Vector3i block = cell_of(samples[runs[run]]) / kEdge;
    for (std::size_t i = runs[run]; i < runs[run + 1]; ++i) {
      const Eigen::Vector3i next = (cell_of(samples[i]).array() + reach) / kEdge - block.array();
      ends[run] |= 1U << (next[0] | next[1] << 1 | next[2] << 2);
    }
  });
  std::vector<Eigen::Vector3i> reached;
  for (std::size_t run = 0; run < ends.size(); ++run) {
    const Eigen::Vector3i block = cell_of(samples[runs[run]]) / kEdge;
    for (int q = 0; q < 8; ++q)
      for (int end = q; end < 8; ++end) {
        if ((ends[run] >> end & 1) == 0 || (q & end) != q) continue;
        reached.push_back(block + Eigen::Vector3i(q & 1, q >> 1 & 1, q >> 2));
        break;
      }
  }
  sort_and_unite(reached);
  return reached;
}

namespace {

// Functions of W nodes an axis reach no farther into the upper blocks: rows y and planes z that are of use.
template <int W>
constexpr int kReached = kEdge + W - 1;

template <class T>
using Row = Eigen::Array<T, kEdge, 1>;

/// f(row of a block's values, row of the window) for each row of the blocks that functions of W nodes reach.
template <int W, class F>
void for_each_row(int q, F&& f) {
  const int ox = kEdge * (q & 1), oy = kEdge * (q >> 1 & 1), oz = kEdge * (q >> 2);
  const int ny = oy > 0 ? W - 1 : kEdge, nz = oz > 0 ? W - 1 : kEdge;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y) f((z * kEdge + y) * kEdge, ((oz + z) * kWindow + oy + y) * kWindow + ox);
}

template <int W>
void load_window(const std::array<int, 8>& nodes, const float* values, float* window) {
  for (int q = 0; q < 8; ++q) {
    if (nodes[q] < 0) {
      for_each_row<W>(q, [&](int, int to) { float_pack(window + to).setZero(); });
      continue;
    }
    const float* from = values + static_cast<std::size_t>(nodes[q]) * kNodes;
    for_each_row<W>(q, [&](int row, int to) { float_pack(window + to) = In(from + row); });
  }
}

template <int W, class T>
void add_window(const std::array<int, 8>& nodes, const T* window, T* values) {
  for (int q = 0; q < 8; ++q) {
    if (nodes[q] < 0) continue;
    T* to = values + static_cast<std::size_t>(nodes[q]) * kNodes;
    for_each_row<W>(
        q, [&](int row, int from) { Eigen::Map<Row<T>>(to + row) += Eigen::Map<const Row<T>>(window + from); });
  }
}

}  // namespace

SsdBand::SsdBand(const LmeTables& tables, const Lattice& lattice, double kappa, const std::vector<SsdSample>& samples)
    : SsdBand(tables, LatticeBlocks(lattice, tables.half_width(), blocks_of(samples, tables.half_width())), kappa,
              samples, {0, std::numeric_limits<int>::max()}) {}

SsdBand::SsdBand(const LmeTables& tables, LatticeBlocks blocks, double kappa, const std::vector<SsdSample>& samples,
                 std::array<int, 2> own)
    : tables_(&tables),
      kappa_(kappa),
      samples_(&samples),
      blocks_(std::move(blocks)),
      own_{own[0], std::min(own[1], blocks_.size())} {
  neighbours_.resize(blocks_.size());
  tbb::parallel_for(0, blocks_.size(), [&](int b) { neighbours_[b] = blocks_.neighbours(b); });
  const std::vector<std::size_t> runs = block_runs(samples);
  cell_blocks_.resize(runs.size() - 1);
  tbb::parallel_for(std::size_t{0}, cell_blocks_.size(), [&](std::size_t run) {
    CellBlock& cells = cell_blocks_[run];
    cells.begin = runs[run];
    cells.end = runs[run + 1];
    cells.block = cell_of(samples[cells.begin]) / kEdge;
    for (int q = 0; q < 8; ++q) {
      const int b = blocks_.at(cells.block + Eigen::Vector3i(q & 1, q >> 1 & 1, q >> 2));
      cells.nodes[q] = b;
      cells.own_nodes[q] = b >= own_[0] && b < own_[1] ? b : -1;
    }
  });
  for (std::size_t run = 0; run < cell_blocks_.size(); ++run) {
    const Eigen::Vector3i& block = cell_blocks_[run].block;
    const int colour = (block[0] & 1) | (block[1] & 1) << 1 | (block[2] & 1) << 2;
    colours_[colour].push_back(static_cast<int>(run));
  }
  detail::dispatch_width(tables.width(), [&](auto W) { tabulate<W.value>(); });
  invert_diagonal();
}

double SsdBand::expected_bytes(const std::vector<SsdSample>& samples, int half_width) {
  constexpr double kPerNode = 5 * sizeof(float) + 16, kPerSample = 180;  // bytes: an estimate
  return kNodes * kPerNode * static_cast<double>(blocks_of(samples, half_width).size()) +
         kPerSample * static_cast<double>(samples.size());
}

// Cell blocks of one colour at a time: their windows of nodes are disjoint.
template <class F>
void SsdBand::for_each_cell_block(F&& f) const {
  for (const std::vector<int>& colour : colours_) {
    tbb::parallel_for(std::size_t{0}, colour.size(), [&](std::size_t c) { f(cell_blocks_[colour[c]]); });
  }
}

template <int W>
void SsdBand::tabulate() {
  constexpr int kStride = Basis<W>::kStride;
  bases_ = std::make_unique_for_overwrite<float[]>(samples_->size() * kStride);
  window_ = touched<std::uint16_t>(samples_->size());
  tbb::parallel_for(std::size_t{0}, cell_blocks_.size(), [&](std::size_t c) {
    const CellBlock& cells = cell_blocks_[c];
    const Eigen::Vector3i corner = kEdge * cells.block - Eigen::Vector3i::Constant(blocks_.shift());
    for (std::size_t i = cells.begin; i < cells.end; ++i) {
      const SsdSample& s = (*samples_)[i];
      LmeBasis3d B;
      evaluate_lme_3d<false>(*tables_, blocks_.lattice().n, s.xi, B);
      Basis<W>::store(B, s, bases_.get() + i * kStride);
      const Eigen::Vector3i first = Eigen::Vector3i(B.x.first, B.y.first, B.z.first) - corner;
      window_[i] = static_cast<std::uint16_t>((first[2] * kWindow + first[1]) * kWindow + first[0]);
    }
  });
}

template <int W>
void SsdBand::apply_data(const float* p, float* y) const {
  for_each_cell_block([&](const CellBlock& cells) {
    constexpr int kUsed = kReached<W> * kWindow * kWindow;
    // Eight-lane loads and stores may reach past the last row.
    alignas(32) float in[kWindowNodes + 8], out[kWindowNodes + 8];
    load_window<W>(cells.nodes, p, in);
    std::fill(in + kUsed, in + kUsed + 8, 0.f);
    std::fill(out, out + kUsed + 8, 0.f);
    for (std::size_t i = cells.begin; i < cells.end; ++i) {
      detail::add_sample<W>({bases_.get() + i * Basis<W>::kStride}, in + window_[i], out + window_[i], kRow, kPlane);
    }
    add_window<W>(cells.own_nodes, out, y);
  });
}

// kappa K p on each block from the nodes around it: the three axes one after the other, as in HessianEnergy.
template <int R>
void SsdBand::apply_energy(const float* p, float* y) const {
  constexpr int kHalf = 2 * R - 1, kAround = kEdge + 2 * kHalf;
  const CrossGram gram(*tables_, 0);
  float m[kHalf + 1], s[kHalf + 1], b[kHalf + 1];
  for (int o = 0; o <= kHalf; ++o) {
    m[o] = static_cast<float>(gram.m(o)), s[o] = static_cast<float>(gram.s(o)), b[o] = static_cast<float>(gram.b(o));
  }
  tbb::parallel_for(own_[0], own_[1], [&](int block) {
    const std::array<int, 27>& near = neighbours_[block];
    alignas(32) float with_m[kAround][kNodes / kEdge], with_b[kAround][kNodes / kEdge], with_s[kAround][kNodes / kEdge];
    for (int z = 0; z < kAround; ++z) {
      const int kz = z - kHalf + kEdge, bz = kz / kEdge;  // 0, 1, 2: below, in, above
      // All rows of the plane are copied before the first is read: what has just been written in pieces of eight cannot
      // be read across them until it has left the store buffer.
      alignas(32) float rows[kAround][3 * kEdge], M[kAround][kEdge], S[kAround][kEdge], B[kAround][kEdge];
      bool filled[kAround], plane = false;
      for (int j = 0; j < kAround; ++j) {
        const int ky = j - kHalf + kEdge, by = ky / kEdge;
        const int* three = near.data() + 9 * bz + 3 * by;
        filled[j] = three[0] >= 0 || three[1] >= 0 || three[2] >= 0;
        if (!filled[j]) continue;
        plane = true;
        for (int q = 0; q < 3; ++q) {
          if (three[q] < 0) {
            float_pack(rows[j] + q * kEdge).setZero();
          } else {
            float_pack(rows[j] + q * kEdge) =
                In(p + static_cast<std::size_t>(three[q]) * kNodes + (kz % kEdge * kEdge + ky % kEdge) * kEdge);
          }
        }
      }
      for (int j = 0; j < kAround; ++j) {
        if (!filled[j]) {
          float_pack(M[j]).setZero(), float_pack(S[j]).setZero(), float_pack(B[j]).setZero();
          continue;
        }
        const float* row = rows[j];
        const Lanes centre = In(row + kEdge);
        Lanes vm = m[0] * centre, vs = s[0] * centre, vb = b[0] * centre;
        for (int o = 1; o <= kHalf; ++o) {
          const Lanes pair = In(row + kEdge - o) + In(row + kEdge + o);
          vm += m[o] * pair, vs += s[o] * pair, vb += b[o] * pair;
        }
        float_pack(M[j]) = vm, float_pack(S[j]) = vs, float_pack(B[j]) = vb;
      }
      for (int j = 0; j < kEdge; ++j) {
        Lanes am = Lanes::Zero(), ab = am, as = am;
        if (plane) {
          const int at = j + kHalf;
          const Lanes Mj = In(M[at]), Sj = In(S[at]);
          am = m[0] * In(B[at]) + b[0] * Mj + (2 * s[0]) * Sj;
          ab = m[0] * Mj;
          as = m[0] * Sj + s[0] * Mj;
          for (int o = 1; o <= kHalf; ++o) {
            const Lanes Mo = In(M[at - o]) + In(M[at + o]), So = In(S[at - o]) + In(S[at + o]);
            am += m[o] * (In(B[at - o]) + In(B[at + o])) + b[o] * Mo + (2 * s[o]) * So;
            ab += m[o] * Mo;
            as += m[o] * So + s[o] * Mo;
          }
        }
        float_pack(with_m[z] + j * kEdge) = am, float_pack(with_b[z] + j * kEdge) = ab,
                                   float_pack(with_s[z] + j * kEdge) = 2 * as;
      }
    }
    float* to = y + static_cast<std::size_t>(block) * kNodes;
    const auto kappa = static_cast<float>(kappa_);
    for (int z = 0; z < kEdge; ++z) {
      const int at = z + kHalf;
      for (int j = 0; j < kEdge; ++j) {
        const int col = j * kEdge;
        Lanes sum = m[0] * In(with_m[at] + col) + b[0] * In(with_b[at] + col) + s[0] * In(with_s[at] + col);
        for (int o = 1; o <= kHalf; ++o) {
          sum += m[o] * (In(with_m[at - o] + col) + In(with_m[at + o] + col)) +
                 b[o] * (In(with_b[at - o] + col) + In(with_b[at + o] + col)) +
                 s[o] * (In(with_s[at - o] + col) + In(with_s[at + o] + col));
        }
        float_pack(to + (z * kEdge + j) * kEdge) = kappa * sum;
      }
    }
  });
}

void SsdBand::apply(const float* p, float* y) const {
  detail::dispatch_width(tables_->width(), [&](auto W) {
    apply_energy<W.value / 2>(p, y);
    apply_data<W.value>(p, y);
  });
}

void SsdBand::invert_diagonal() {
  std::vector<float>& d = inverse_diagonal_;
  d = touched<float>(size());
  detail::dispatch_width(tables_->width(), [&](auto width) {
    constexpr int W = width.value;
    for_each_cell_block([&](const CellBlock& cells) {
      alignas(32) float out[kWindowNodes + 8] = {};
      for (std::size_t i = cells.begin; i < cells.end; ++i) {
        const Basis<W> B{bases_.get() + i * Basis<W>::kStride};
        const Lanes N2 = B.xN().square(), d2 = B.xdN().square();
        for (int k = 0; k < W; ++k)
          for (int j = 0; j < W; ++j) {
            const float yz = B.yN()[j] * B.zN()[k], dyz = B.ydN()[j] * B.zN()[k], ydz = B.yN()[j] * B.zdN()[k];
            float_pack(out + window_[i] + (k * kWindow + j) * kWindow) +=
                B.w_value() * yz * yz * N2 + B.w_gradient() * (yz * yz * d2 + (dyz * dyz + ydz * ydz) * N2);
          }
      }
      add_window<W>(cells.own_nodes, out, d.data());
    });
  });
  const CrossGram gram(*tables_, 0);
  const double m = gram.m(0), s = gram.s(0), b = gram.b(0);
  const auto energy = static_cast<float>(kappa_ * (3 * b * m * m + 6 * s * s * m));
  std::vector<int> n_active(blocks_.size(), 0);
  tbb::parallel_for(own_[0], own_[1], [&](int block) {
    float* const of_block = d.data() + static_cast<std::size_t>(block) * kNodes;
    for (int a = 0; a < kNodes; ++a) {
      float& v = of_block[a];
      n_active[block] += v > 0;  // a node is active where a sample weighs something on it
      v = v > 0 ? 1 / (v + energy) : 0;
    }
  });
  n_active_ = std::accumulate(n_active.begin(), n_active.end(), n_active_);
}

// r = -kappa int H(N) : H(f): f level by level, in units of this lattice.
void SsdBand::subtract_energy(const LevelSet& f, std::vector<float>& r) const {
  const Lattice& L = blocks_.lattice();
  std::vector<CrossGram> grams;
  std::size_t widest = 0;
  for (int level = 0; level < f.n_levels(); ++level) {
    grams.emplace_back(*tables_, static_cast<int>(std::lround(std::log2(f.lattice(level).h / L.h))));
    widest = std::max<std::size_t>(widest, grams.back().window_size());
  }
  const auto scale = static_cast<float>(-kappa_ / L.h);
  tbb::parallel_for(own_[0], own_[1], [&](int block) {
    thread_local std::vector<float> window;
    thread_local std::vector<double> coarsest;
    window.resize(widest * widest * widest), coarsest.resize(window.size());
    const Eigen::Vector3i first = blocks_.first_node(block);
    Eigen::Map<Eigen::Array<float, kNodes, 1>> energy(r.data() + static_cast<std::size_t>(block) * kNodes);
    for (int level = 0; level < f.n_levels(); ++level) {
      const CrossGram& gram = grams[level];
      const int n = gram.window_size();
      const Eigen::Vector3i begin = gram.window_begin(first);
      bool any = false;
      if (level == 0) {
        any = copy_window(f.coarsest(), begin, n, coarsest.data());
        std::copy(coarsest.begin(), coarsest.begin() + static_cast<std::ptrdiff_t>(n) * n * n, window.begin());
      } else {
        const LevelSetBand& band = f.band(level);
        any = band.blocks.copy_window(band.coefficients.data(), begin, {n, n, n}, n, window.data());
      }
      if (any) gram.add_energy(first, window.data(), energy.data());
    }
    energy *= scale;
  });
}

template <int W>
void SsdBand::add_misfit(const LevelSet& f, std::vector<float>& r) const {
  const Lattice& L = blocks_.lattice();
  for_each_cell_block([&](const CellBlock& cells) {
    alignas(32) float out[kWindowNodes + 8] = {};
    for (std::size_t i = cells.begin; i < cells.end; ++i) {
      const SsdSample& s = (*samples_)[i];
      Vec3 gradient;
      const double value = f.evaluate(L.origin + L.h * s.xi, &gradient, nullptr) / L.h;
      const Eigen::Vector3f g = (s.w_gradient * (s.normal - gradient)).cast<float>();
      detail::scatter_sample<W>({bases_.get() + i * Basis<W>::kStride},
                                static_cast<float>(s.w_value * (s.value - value)), g[0], g[1], g[2], out + window_[i],
                                kRow, kPlane);
    }
    add_window<W>(cells.own_nodes, out, r.data());
  });
}

void SsdBand::residual(const LevelSet& f, std::vector<float>& r) const {
  r = touched<float>(size());
  subtract_energy(f, r);
  detail::dispatch_width(tables_->width(), [&](auto W) { add_misfit<W.value>(f, r); });
  tbb::parallel_for(own_[0], own_[1], [&](int block) {
    const std::size_t begin = static_cast<std::size_t>(block) * kNodes;
    for (std::size_t a = begin; a < begin + kNodes; ++a) {
      if (inverse_diagonal_[a] == 0) r[a] = 0;
    }
  });
}

}  // namespace umtet
