#include "mesh/moving_mesh.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "mesh/certify/certificate_memory.h"
#include "mesh/core/asking_psi.h"
#include "mesh/fast/fast_mesh.h"
#include "mesh/submesh/inside_walk.h"

namespace umtet {
namespace {

constexpr std::size_t kVerticesPerTask = 4096;
constexpr double kSearchShare = .1;  // share of the time of an update, about
// Boundary vertices that are checked together to see whether psi has moved: nearly always the first of them show it.
constexpr std::size_t kVerticesPerCheck = 256;

using Ids = std::vector<std::int64_t>;

Ids without(const Ids& a, const Ids& b) {
  Ids rest;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rest));
  return rest;
}

/// The cells of a lattice, halved until a box has no zero of psi or is one cell: vertices of these go to `found`.
class ZeroCells {
 public:
  ZeroCells(const BackgroundMesh& background, const std::function<bool(const Box&)>& no_zero_in, Ids& found)
      : background_(background), no_zero_in_(no_zero_in), found_(found), origin_(background.box().min()) {
    const auto& n = background.n_cells();
    const Vec3 size = background.box().sizes();
    for (int a = 0; a < 3; ++a) cell_[a] = size[a] / static_cast<double>(n[a]);
    search({-1, -1, -1}, {n[0] + 1, n[1] + 1, n[2] + 1});
  }

 private:
  using Cell = BackgroundMesh::Cell;

  Vec3 corner(const Cell& c) const {
    return origin_ + Vec3(cell_[0] * static_cast<double>(c[0]), cell_[1] * static_cast<double>(c[1]),
                          cell_[2] * static_cast<double>(c[2]));
  }
  void search(const Cell& first, const Cell& end) {
    // Rounding of a place must not put a vertex outside of its cell.
    const Vec3 slack = 1e-9 * cell_;
    if (no_zero_in_(Box(corner(first) - slack, corner(end) + slack))) return;
    int axis = 0;
    for (int a = 1; a < 3; ++a) {
      if (end[a] - first[a] > end[axis] - first[axis]) axis = a;
    }
    if (end[axis] - first[axis] > 1) {
      Cell middle_end = end, middle = first;
      middle_end[axis] = middle[axis] = (first[axis] + end[axis]) / 2;
      search(first, middle_end);
      search(middle, end);
      return;
    }
    for (int type = 0; type < background_.n_types(); ++type) {
      const std::int64_t v = background_.vertex_id(type, first);
      if (background_.has_tets(v)) found_.push_back(v);
    }
  }

  const BackgroundMesh& background_;
  const std::function<bool(const Box&)>& no_zero_in_;
  Ids& found_;
  Vec3 origin_, cell_ = Vec3::Zero();
};

}  // namespace

SparsityPattern sparsity_pattern(const BackgroundMesh& background) {
  const auto n = static_cast<std::size_t>(background.n_vertices());
  SparsityPattern pattern;
  pattern.row_begin.assign(n + 1, 0);
  const auto for_each_row = [&](const auto& f) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, kVerticesPerTask), [&](const auto& rows) {
      Ids link;
      for (std::size_t v = rows.begin(); v != rows.end(); ++v) {
        link.clear();
        background.link(static_cast<std::int64_t>(v), link);
        f(v, link);
      }
    });
  };
  for_each_row(
      [&](std::size_t v, const Ids& link) { pattern.row_begin[v + 1] = static_cast<std::int64_t>(link.size()); });
  std::partial_sum(pattern.row_begin.begin(), pattern.row_begin.end(), pattern.row_begin.begin());
  pattern.column.resize(static_cast<std::size_t>(pattern.row_begin.back()));
  for_each_row([&](std::size_t v, const Ids& link) {
    std::copy(link.begin(), link.end(), pattern.column.begin() + pattern.row_begin[v]);
  });
  return pattern;
}

struct UniversalMesh::Impl {
  Impl(BackgroundMesh mesh, const UmParams& um) : background(std::move(mesh)), params(um), walk(background) {}

  std::size_t search(ImplicitFunctionRef psi, const UpdateHints& hints, const Context& context);
  bool has_stayed(ImplicitFunctionRef psi, std::size_t& n_evaluations) const;
  void compare();

  const BackgroundMesh background;
  const UmParams params;
  InsideWalk walk;
  FastMemory memory;
  UmUpdate now;     ///< of the last call
  UmUpdate before;  ///< the last mesh but that
  CertificateMemory certified;
};

UniversalMesh::UniversalMesh(BackgroundMesh background, const UmParams& params) {
  std::vector<std::string> broken = problems(params);
  if (params.mode != UmMode::Fast) broken.emplace_back("mode = Paper: must be Fast");
  std::string all;
  for (const std::string& problem : broken) all += (all.empty() ? "" : "; ") + problem;
  if (!all.empty()) throw std::invalid_argument(all);
  impl_ = std::make_unique<Impl>(std::move(background), params);
}
UniversalMesh::~UniversalMesh() = default;
UniversalMesh::UniversalMesh(UniversalMesh&&) noexcept = default;
UniversalMesh& UniversalMesh::operator=(UniversalMesh&&) noexcept = default;

const BackgroundMesh& UniversalMesh::background() const { return impl_->background; }

std::size_t UniversalMesh::Impl::search(ImplicitFunctionRef psi, const UpdateHints& hints, const Context& context) {
  context.report("search", 0);
  // The walk begins at a boundary: there is none at first, nor after a domain that was empty.
  if (!walk.has_boundary() || (hints.no_zero_in && !background.is_lattice())) return walk.restart(psi, context);
  Ids more;
  if (hints.no_zero_in) ZeroCells(background, hints.no_zero_in, more);
  for (const Vec3& seed : hints.seeds) {
    const std::int64_t tet = background.tet_near(seed);
    if (tet < 0) continue;
    const auto corners = background.tet(tet);
    more.insert(more.end(), corners.begin(), corners.end());
    for (const std::int64_t v : corners) background.link(v, more);
  }
  return walk.update(psi, more, context);
}

/// True if psi < 0 at the vertices where it was, and psi = 0 at those of the boundary: the last mesh is one of this
/// psi.
bool UniversalMesh::Impl::has_stayed(ImplicitFunctionRef psi, std::size_t& n_evaluations) const {
  if (memory.moved.empty() || !(walk.inside() == memory.negative)) return false;
  const std::vector<int>& boundary = now.mesh.submesh.positive_vertices;
  const double tol = params.fast.projection.closest_point.tol * background.h();
  std::atomic<bool> stayed = true;
  for (std::size_t begin = 0; begin < boundary.size() && stayed; begin += kVerticesPerCheck) {
    const std::size_t end = std::min(boundary.size(), begin + kVerticesPerCheck);
    for_each_asking(psi, end - begin, end - begin, {}, [&](std::size_t k) {
      Vec3 gradient;
      const double value = psi.value(now.mesh.final[boundary[begin + k]], gradient);
      if (!(std::abs(value) <= tol * gradient.norm())) stayed.store(false, std::memory_order_relaxed);
    });
    n_evaluations += end - begin;
  }
  return stayed;
}

/// What is new now, against the mesh before.
void UniversalMesh::Impl::compare() {
  const Ids &a = before.mesh.submesh.background_vertex, &b = now.mesh.submesh.background_vertex;
  now.vertices_entered = without(b, a);
  now.vertices_left = without(a, b);
  now.tets_entered = without(now.mesh.submesh.background_tet, before.mesh.submesh.background_tet);
  now.tets_left = without(before.mesh.submesh.background_tet, now.mesh.submesh.background_tet);
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i] == b[j]) {
      if (before.mesh.final[i] != now.mesh.final[j]) now.vertices_moved.push_back(b[j]);
      ++i, ++j;
    } else {
      a[i] < b[j] ? ++i : ++j;
    }
  }
}

const UmUpdate& UniversalMesh::update(ImplicitFunctionRef psi, const UpdateHints& hints, const Context& context) {
  Impl& impl = *impl_;
  const bool has_mesh = impl.now.mesh.status == UmStatus::Success && !impl.now.mesh.final.empty();
  const auto start = [&]() -> UmUpdate& {
    if (has_mesh) std::swap(impl.now, impl.before);
    return impl.now = UmUpdate{};
  };
  const std::size_t n_searched = impl.search(psi, hints, context);
  std::size_t n_evaluations = n_searched;
  if (has_mesh && impl.has_stayed(psi, n_evaluations)) {
    UmResult mesh = std::move(impl.now.mesh);
    mesh.n_psi_evaluations = n_evaluations;
    impl.now = UmUpdate{};
    impl.now.mesh = std::move(mesh);
    impl.now.n_searched = n_searched;
    impl.now.n_recalled = impl.memory.moved.size();
    return impl.now;
  }
  UmUpdate& update = start();
  update.mesh = fast_mesh(impl.background, psi, impl.params.submesh, impl.params.fast, context.part(kSearchShare, 1),
                          impl.walk.inside(), impl.memory, impl.walk.values());
  update.mesh.n_psi_evaluations += n_evaluations;
  update.n_searched = n_searched;
  update.n_recalled = impl.memory.n_recalled;
  if (update.mesh.status == UmStatus::Success) impl.compare();
  return update;
}

MeshCertificate UniversalMesh::certify(const UmResult& mesh, ImplicitFunctionRef psi, const Context& context) {
  const Submesh& omega_h = mesh.submesh;
  const TetMesh fitted{mesh.final, omega_h.mesh.C};
  CertificateInput input;
  input.mesh = &fitted;
  input.h = impl_->background.h();
  input.positive_faces = &omega_h.positive_faces;
  input.psi = psi;
  input.context = context;
  if (!mesh.walls.empty()) {
    input.wall_faces = &mesh.walls;
    input.background_V = &omega_h.mesh.V;
  }
  return umtet::certify(input, omega_h.background_vertex, omega_h.background_tet, impl_->certified);
}

}  // namespace umtet
