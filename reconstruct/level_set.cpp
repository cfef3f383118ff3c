#include "reconstruct/level_set.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "reconstruct/detail/contract.h"

namespace umtet {

namespace {

using namespace detail;

constexpr int kEdge = LatticeBlocks::kEdge;

// Adds a jet in lattice units to one in model units.
template <JetOrder order>
void add(const LatticeJet& f, double h, LatticeJet& sum) {
  sum.value += f.value;
  if constexpr (order >= kGradient) sum.gradient += f.gradient / h;
  if constexpr (order >= kHessian) sum.hessian += f.hessian / (h * h);
}

Vec3 lattice_coordinates(const Lattice& L, const Vec3& x) {
  return ((x - L.origin) / L.h).cwiseMax(0.0).cwiseMin((L.n.array() - 1).cast<double>().matrix());
}

template <JetOrder order>
void add_coarsest(const LmeTables& tables, const LevelSetLevel& level, const Vec3& x, LatticeJet& sum) {
  const Lattice& L = level.lattice;
  LmeBasis3d B;
  evaluate_lme_3d<order == kHessian>(tables, L.n, lattice_coordinates(L, x), B);
  const LatticeJet f = dispatch_width(
      tables.width(), [&](auto W) { return contract<W.value, order>(B, L.n, level.coefficients.data()); });
  add<order>(f, L.h, sum);
}

template <JetOrder order, class Band>
void add_band(const LmeTables& tables, const Band& band, const Vec3& x, LatticeJet& sum) {
  const Lattice& L = band.data.blocks.lattice();
  const Vec3 xi = lattice_coordinates(L, x);
  const Eigen::Vector3i cell = xi.cast<int>().cwiseMin((L.n.array() - 2).matrix()), block = cell / kEdge;
  const int window =
      band.index[block[0] + static_cast<std::size_t>(band.n[0]) * (block[1] + static_cast<std::size_t>(band.n[1]) * block[2])];
  if (window < 0) return;
  LmeBasis3d B;
  evaluate_lme_3d<order == kHessian>(tables, L.n, xi, B);
  const int corner = band.data.blocks.shift();  // the window begins at node 8 block - shift
  B.x.first += corner - kEdge * block[0];
  B.y.first += corner - kEdge * block[1];
  B.z.first += corner - kEdge * block[2];
  const int edge = band.edge;
  const float* c = band.windows.data() + static_cast<std::size_t>(window) * edge * edge * edge;
  const LatticeJet f =
      dispatch_width(tables.width(), [&](auto W) { return contract<W.value, order>(B, {edge, edge, edge}, c); });
  add<order>(f, L.h, sum);
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
  index.assign(static_cast<std::size_t>(n[0]) * n[1] * n[2], -1);
  const auto at = [&](const Eigen::Vector3i& b) -> std::int32_t& {
    return index[b[0] + static_cast<std::size_t>(n[0]) * (b[1] + static_cast<std::size_t>(n[1]) * b[2])];
  };
  std::vector<Eigen::Vector3i> cells;
  for (const Eigen::Vector3i& node_block : blocks.blocks())
    for (int q = 0; q < 8; ++q) {
      const Eigen::Vector3i b = node_block - Eigen::Vector3i(q & 1, q >> 1 & 1, q >> 2);
      if ((b.array() < 0).any() || (b.array() >= n.array()).any() || at(b) >= 0) continue;
      at(b) = static_cast<std::int32_t>(cells.size());
      cells.push_back(b);
    }
  const std::size_t size = static_cast<std::size_t>(edge) * edge * edge;
  windows.assign(cells.size() * size + LevelSetLevel::kPad, 0.f);
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t c) {
    blocks.copy_window(data.coefficients.data(), kEdge * cells[c] - Eigen::Vector3i::Constant(blocks.shift()),
                       {edge, edge, edge}, edge, windows.data() + c * size);
  });
}

LevelSet::LevelSet(const LmePrior& prior, LevelSetLevel coarsest, std::vector<LevelSetBand> bands)
    : tables_(std::make_shared<const LmeTables>(prior)) {
  const Lattice& L = coarsest.lattice;
  if (!(L.h > 0) || L.n.minCoeff() < tables_->width() ||
      static_cast<std::ptrdiff_t>(coarsest.coefficients.size()) != L.size()) {
    throw std::invalid_argument("a level needs h > 0, at least 2 half_width nodes an axis and a coefficient a node");
  }
  domain_ = Eigen::AlignedBox3d(L.origin, L.origin + L.h * (L.n.array() - 1).cast<double>().matrix());
  coarsest.coefficients.resize(coarsest.coefficients.size() + LevelSetLevel::kPad, 0.0);
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

double LevelSet::evaluate_level(int level, const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  LatticeJet f;
  const auto add_terms = [&](auto order) {
    if (level == 0)
      add_coarsest<order.value>(*tables_, *coarsest_, x, f);
    else
      add_band<order.value>(*tables_, *bands_[level - 1], x, f);
  };
  if (hessian)
    add_terms(std::integral_constant<JetOrder, kHessian>{});
  else if (gradient)
    add_terms(std::integral_constant<JetOrder, kGradient>{});
  else
    add_terms(std::integral_constant<JetOrder, kValue>{});
  if (gradient) *gradient = f.gradient;
  if (hessian) *hessian = f.hessian;
  return f.value;
}

double LevelSet::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  LatticeJet f;
  const auto add_levels = [&](auto order) {
    add_coarsest<order.value>(*tables_, *coarsest_, x, f);
    for (const auto& band : bands_) add_band<order.value>(*tables_, *band, x, f);
  };
  if (hessian)
    add_levels(std::integral_constant<JetOrder, kHessian>{});
  else if (gradient)
    add_levels(std::integral_constant<JetOrder, kGradient>{});
  else
    add_levels(std::integral_constant<JetOrder, kValue>{});
  const double outside = std::sqrt(domain_.squaredExteriorDistance(x));
  if (outside > 0) {
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
