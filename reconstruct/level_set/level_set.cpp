#include "reconstruct/level_set/level_set.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "reconstruct/basis/contract.h"

namespace umtet {

namespace {

using namespace simd;

constexpr int kEdge = LatticeBlocks::kEdge;

const float kNotYet = 0;  // its address stands for a window that has not been made yet

// Position in spacings of the coarsest lattice; on that of 2^-k times its spacing it is 2^k times as much, exactly.
Vec3 lattice_coordinates(const Lattice& L, const Vec3& x) {
  return ((x - L.origin) / L.h).cwiseMax(0.0).cwiseMin((L.n.array() - 1).cast<double>().matrix());
}

// What a level adds at a place, made in two steps: for several levels side by side, see kAtOnce.
template <class Coefficient>
struct Term {
  LmePlace place;
  Vec3 xi;
  const Eigen::Vector3i* n;
  double scale;              // to derivatives in model units
  const Coefficient* first;  // coefficient of the first function
  LmeBasis3d B;
};

// False where the band has none. No place is outside its index, not even one that is no number.
template <int edge, class Band>
bool find_window(const Band& band, Term<float>& term) {
  const Pack4i block = term.place.cell >> 3;
  const float* window = band.window(block);
  if (window == nullptr) return false;
  constexpr int corner = (edge - kEdge + 1) / 2 - 1;  // the window begins at node 8 block - (R - 1)
  const Pack4i at = term.place.first + corner - block * kEdge;
  term.first = window + at[0] + edge * (at[1] + edge * at[2]);
  return true;
}

// The same of coefficients that are copied to `room`, W^3 of them: no others.
template <int W, class Band>
bool copy_term(const Band& band, float* room, Term<float>& term) {
  if (!band.has(term.place.cell >> 3)) return false;
  const Pack4i at = term.place.first;
  band.data.blocks.copy_window(band.data.coefficients.data(), {at[0], at[1], at[2]}, {W, W, W}, W, room);
  term.first = room;
  return true;
}

// Levels that are evaluated side by side. Place, functions and sum of one level are a chain of operations, each of
// which needs the one before; the processor overlaps the chains of several levels (reconstruct_bench
// --benchmark_filter=EvaluatePsi).
constexpr int kAtOnce = 4;

/// The first node whose function counts in a cell, as LmeTables::locate() has it.
Eigen::Vector3i first_node(const Eigen::Vector3i& cell, const Eigen::Vector3i& n, int half_width) {
  return (cell.array() - half_width + 1).cwiseMax(0).min(n.array() - 2 * half_width);
}

}  // namespace

bool copy_window(const LevelSetLevel& level, const Eigen::Vector3i& first, int n, double* out) {
  const Lattice& L = level.lattice;
  const Eigen::Vector3i low = first.cwiseMax(0), high = (first.array() + n).min(L.n.array());
  if ((low.array() >= high.array()).any()) return false;
  if (((high - low).array() < n).any()) std::fill(out, out + static_cast<std::ptrdiff_t>(n) * n * n, 0.0);
  for (int z = low[2]; z < high[2]; ++z)
    for (int y = low[1]; y < high[1]; ++y) {
      const double* from = level.coefficients.data() + L.index(low[0], y, z);
      std::copy(from, from + (high[0] - low[0]),
                out + low[0] - first[0] + static_cast<std::ptrdiff_t>(n) * (y - first[1] + n * (z - first[2])));
    }
  return true;
}

LevelSet::Band::Band(LevelSetBand&& band, int half_width) : data(std::move(band)), edge(kEdge + 2 * half_width - 1) {
  const LatticeBlocks& blocks = data.blocks;
  n = ((blocks.lattice().n.array() - 1) + kEdge - 1) / kEdge;
  windows = std::vector<std::atomic<const float*>>(static_cast<std::size_t>(n[0]) * n[1] * n[2]);
  for (const Eigen::Vector3i& node_block : blocks.blocks())
    for (int q = 0; q < 8; ++q) {
      const Eigen::Vector3i b = node_block - Eigen::Vector3i(q & 1, q >> 1 & 1, q >> 2);
      if ((b.array() < 0).any() || (b.array() >= n.array()).any()) continue;
      windows[b[0] + static_cast<std::size_t>(n[0]) * (b[1] + static_cast<std::size_t>(n[1]) * b[2])] = &kNotYet;
    }
}

LevelSet::Band::~Band() { forget(); }

void LevelSet::Band::forget() const {
  for (std::atomic<const float*>& window : windows) {
    const float* made = window.load();
    if (made == nullptr || made == &kNotYet) continue;
    delete[] made;
    window = &kNotYet;
  }
}

inline std::size_t LevelSet::Band::index(const Pack4i& block) const {
  return block[0] + static_cast<std::size_t>(n[0]) * (block[1] + static_cast<std::size_t>(n[1]) * block[2]);
}

inline bool LevelSet::Band::has(const Pack4i& block) const {
  return windows[index(block)].load(std::memory_order_relaxed) != nullptr;
}

// Null where the band has nothing to add.
inline const float* LevelSet::Band::window(const Pack4i& block) const {
  const std::size_t index = this->index(block);
  const float* made = windows[index].load(std::memory_order_acquire);
  return made == &kNotYet ? make_window(index) : made;
}

const float* LevelSet::Band::make_window(std::size_t index) const {
  const auto along_x = static_cast<std::size_t>(n[0]), in_plane = along_x * n[1];
  const Eigen::Vector3i block =
      Eigen::Vector3<std::size_t>(index % along_x, index % in_plane / along_x, index / in_plane).cast<int>();
  auto mine = std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(edge) * edge * edge);
  data.blocks.copy_window(data.coefficients.data(), kEdge * block - Eigen::Vector3i::Constant(data.blocks.shift()),
                          {edge, edge, edge}, edge, mine.get());
  const float* first = &kNotYet;  // another thread may have been faster
  return windows[index].compare_exchange_strong(first, mine.get(), std::memory_order_acq_rel) ? mine.release() : first;
}

LevelSet::LevelSet(const LmePrior& prior, LevelSetLevel coarsest, std::vector<LevelSetBand> bands)
    : tables_(std::make_shared<const LmeTables>(prior)) {
  const Lattice& L = coarsest.lattice;
  if (!(L.h > 0) || L.n.minCoeff() < tables_->width() ||
      static_cast<std::ptrdiff_t>(coarsest.coefficients.size()) != L.size()) {
    throw std::invalid_argument("a level needs h > 0, at least 2 half_width nodes an axis and a coefficient a node");
  }
  domain_ = Eigen::AlignedBox3d(L.origin, L.origin + L.h * (L.n.array() - 1).cast<double>().matrix());
  coarsest_ = std::make_shared<const LevelSetLevel>(std::move(coarsest));
  for (LevelSetBand& band : bands) *this = with_band(std::move(band));
}

LevelSet LevelSet::with_band(LevelSetBand band) const {
  const Lattice &L = band.blocks.lattice(), &coarse = lattice(n_levels() - 1);
  if (L.origin != coarse.origin || 2 * L.h != coarse.h || ((L.n.array() - 1) != 2 * (coarse.n.array() - 1)).any() ||
      band.coefficients.size() != static_cast<std::size_t>(band.blocks.size()) * LatticeBlocks::kNodes) {
    throw std::invalid_argument("a band needs the nodes of the level before it, half its spacing, and full blocks");
  }
  LevelSet finer = *this;
  finer.bands_.push_back(std::make_shared<const Band>(std::move(band), tables_->half_width()));
  return finer;
}

LevelSet LevelSet::band_limited(double spacing) const {
  LevelSet limited = *this;
  while (!limited.bands_.empty() && limited.spacing() < spacing) limited.bands_.pop_back();
  return limited;
}

void LevelSet::forget_below(double spacing) const {
  for (const std::shared_ptr<const Band>& band : bands_) {
    if (band->data.blocks.lattice().h < spacing) band->forget();
  }
}

CoefficientWindow<double> LevelSet::coarsest_window(const Eigen::Vector3i& cell) const {
  const Lattice& L = coarsest_->lattice;
  const Eigen::Vector3i at = first_node(cell, L.n, tables_->half_width());
  const std::ptrdiff_t nx = L.n[0], ny = L.n[1];
  return {coarsest_->coefficients.data() + L.index(at[0], at[1], at[2]), nx, nx * ny};
}

CoefficientWindow<float> LevelSet::band_window(int level, const Eigen::Vector3i& cell) const {
  const Band& band = *bands_[level - 1];
  const int R = tables_->half_width(), edge = band.edge;
  const Eigen::Vector3i block = cell / kEdge;
  const float* window = band.window(Pack4i{block[0], block[1], block[2], 0});
  if (window == nullptr) return {nullptr, 0, 0};
  const Eigen::Vector3i at =
      first_node(cell, band.data.blocks.lattice().n, R) - kEdge * block + Eigen::Vector3i::Constant(R - 1);
  return {window + at[0] + edge * (at[1] + edge * at[2]), edge, static_cast<std::ptrdiff_t>(edge) * edge};
}

template <int W, int order, bool apart>
LatticeJet LevelSet::sum_levels(const Vec3& x, int first, int end) const {
  constexpr auto kOrder = static_cast<JetOrder>(order);
  const Vec3 xi = lattice_coordinates(coarsest_->lattice, x);
  constexpr int row = apart ? W : kEdge + W - 1;  // of the coefficients of a term
  float room[kAtOnce][apart ? W * W * W : 1];
  const LmeTables& tables = *tables_;
  const double scale = 1 / coarsest_->lattice.h;
  JetPacks<kOrder> sum;
  Term<double> coarsest;
  if (first == 0) {
    const Lattice& L = coarsest_->lattice;
    coarsest.place = tables.locate(L.n, xi);
    const Pack4i at = coarsest.place.first;
    coarsest.first = coarsest_->coefficients.data() + L.index(at[0], at[1], at[2]);
  }
  for (int level = std::max(first, 1);;) {
    Term<float> terms[kAtOnce];
    int n = 0;
    for (; level < end && n < kAtOnce; ++level) {
      const Band& band = *bands_[level - 1];
      const double finer = static_cast<double>(1 << level);
      Term<float>& term = terms[n];
      term.n = &band.data.blocks.lattice().n;
      term.xi = finer * xi, term.scale = finer * scale;
      term.place = tables.locate(*term.n, term.xi);
      if constexpr (apart) {
        n += copy_term<W>(band, room[n], term);
      } else {
        n += find_window<row>(band, term);
      }
    }
    if (first == 0) tables.evaluate_at<order>(coarsest.place, coarsest_->lattice.n, xi, scale, coarsest.B);
    for (int i = 0; i < n; ++i) {
      Term<float>& term = terms[i];
      tables.evaluate_at<order>(term.place, *term.n, term.xi, term.scale, term.B);
    }
    if (first == 0) {
      const std::ptrdiff_t nx = coarsest_->lattice.n[0], ny = coarsest_->lattice.n[1];
      contract<W, kOrder>(coarsest.B, coarsest.first, nx, nx * ny, sum);
      first = 1;
    }
    for (int i = 0; i < n; ++i) {
      contract<W, kOrder>(terms[i].B, terms[i].first, std::integral_constant<int, row>{},
                          std::integral_constant<int, row * row>{}, sum);
    }
    if (level == end) break;
  }
  return sum.sum();
}

LatticeJet LevelSet::sum_levels(const Vec3& x, int first, int end, bool apart, Vec3* gradient, Mat3* hessian) const {
  const auto sum = [&](auto W, auto is_apart) {
    if (hessian) return sum_levels<W.value, kHessian, is_apart.value>(x, first, end);
    if (gradient) return sum_levels<W.value, kGradient, is_apart.value>(x, first, end);
    return sum_levels<W.value, kValue, is_apart.value>(x, first, end);
  };
  return dispatch_width(tables_->width(),
                        [&](auto W) { return apart ? sum(W, std::true_type{}) : sum(W, std::false_type{}); });
}

double LevelSet::evaluate_level(int level, const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const LatticeJet f = sum_levels(x, level, level + 1, false, gradient, hessian);
  if (gradient) *gradient = f.gradient;
  if (hessian) *hessian = f.hessian;
  return f.value;
}

double LevelSet::evaluate(const Vec3& x, bool apart, Vec3* gradient, Mat3* hessian) const {
  LatticeJet f = sum_levels(x, 0, n_levels(), apart, gradient, hessian);
  if (const double outside2 = domain_.squaredExteriorDistance(x); outside2 > 0) {
    const double outside = std::sqrt(outside2);
    const Vec3 away = x - x.cwiseMax(domain_.min()).cwiseMin(domain_.max());
    f.value += outside;
    f.gradient = (away.array() != 0).select(0.0, f.gradient.array()).matrix() + away / outside;
    f.hessian.setZero();
  }
  if (gradient) *gradient = f.gradient;
  if (hessian) *hessian = f.hessian;
  return f.value;
}

double LevelSet::value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }

Vec3 LevelSet::gradient(const Vec3& x) const {
  Vec3 g;
  evaluate(x, &g, nullptr);
  return g;
}

Mat3 LevelSet::hessian(const Vec3& x) const {
  Vec3 g;
  Mat3 H;
  evaluate(x, &g, &H);
  return H;
}

}  // namespace umtet
