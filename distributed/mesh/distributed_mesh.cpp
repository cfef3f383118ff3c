#include "distributed/mesh/distributed_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>

#include "distributed/exchange/collect.h"
#include "distributed/exchange/phase.h"
#include "distributed/mesh/part_classification.h"
#include "distributed/mesh/part_crawl.h"
#include "distributed/mesh/part_embedding.h"
#include "distributed/mesh/part_manifold.h"
#include "distributed/mesh/part_repair.h"
#include "distributed/mesh/shared_layer.h"
#include "distributed/partition/lattice_part.h"
#include "distributed/partition/partition.h"
#include "mesh/base/id_blocks.h"
#include "mesh/classification/classification.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/fast/fitted_layer.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {
namespace {

/// Vertices that are not at their background positions, with their positions, ascending.
using Places = std::vector<std::pair<std::int64_t, Vec3>>;

/// Returns the union of both lists; positions in `later` replace earlier ones.
Places replaced(const Places& earlier, Places later) {
  const auto is_less = [](const auto& a, const auto& b) { return a.first < b.first; };
  const auto n = static_cast<std::ptrdiff_t>(later.size());
  for (const auto& place : earlier) {
    if (!std::binary_search(later.begin(), later.begin() + n, place, is_less)) later.push_back(place);
  }
  std::sort(later.begin(), later.end(), is_less);
  return later;
}

class PartRun {
 public:
  PartRun(MPI_Comm comm, const BackgroundMesh& background, ImplicitFunctionRef psi, const FastParams& params,
          const std::vector<Vec3>& seeds, double held)
      : psi_(psi),
        params_(params),
        seeds_(seeds),
        comm_(comm),
        partition_(balanced_partition(comm, background, psi, held)),
        part_(background, partition_, rank_in(comm)),
        ranks_(comm, part_.neighbours()),
        costs_(*background_costs(part_.lattice())),
        classification_(params.classification),
        inside_(part_.lattice().n_vertices()) {
    if (!classification_.costs) classification_.costs = &costs_.costs;
  }

  DistributedMesh operator()() {
    find_inside();
    if (fits_background() && classify()) {
      fit();
      repair();
      emit();
      embed();
    }
    result_.n_psi_evaluations = ranks_.sum(result_.n_psi_evaluations);
    result_.traffic = ranks_.traffic();
    return std::move(result_);
  }

 private:
  bool fail(PartsStatus status, std::size_t n_places) {
    result_.status = status;
    result_.n_places = n_places;
    return false;
  }
  void find_inside();
  bool fits_background();
  bool classify();
  std::size_t count_inside();
  void fit();
  void repair();
  void emit();
  void list_positive_faces();
  template <class F>
  void for_each_tet(const F& f) const;
  void fetch(const Places& of_own, std::vector<Vec3>& V);
  void embed();
  Places own_of(const Places& moved) const;
  void list_tets(IdSet& used);
  Vec3 place(const Places& of_own, std::int64_t v) const;

  ImplicitFunctionRef psi_;
  const FastParams& params_;
  const std::vector<Vec3>& seeds_;
  MPI_Comm comm_;
  const Partition partition_;
  const LatticePart part_;
  Neighbourhood ranks_;
  const BackgroundCosts costs_;
  ClassificationParams classification_;  ///< parameters, including the costs
  IdSet inside_;                         ///< inside vertices among the known vertices
  BackgroundLayer layer_;
  Places places_, projected_;         ///< own vertices off their background positions: finally, and after projection
  std::vector<std::int64_t> vertex_;  ///< vertices of the result, as ids in lattice()
  DistributedMesh result_;
};

void PartRun::find_inside() {
  begin_phase("signs");
  if (!seeds_.empty()) {
    inside_ = crawl_part(comm_, part_, psi_, seeds_, result_.n_psi_evaluations);
    return;
  }
  for_each_in_blocks(part_.known(), [&](std::size_t, std::int64_t v) {
    if (part_.lattice().has_tets(v) && psi_.value(part_.lattice().position(v)) < 0) inside_.insert_shared(v);
  });
  part_.known().for_each([&](std::int64_t v) { result_.n_psi_evaluations += part_.lattice().has_tets(v); });
}

bool PartRun::fits_background() {
  if (count_inside() == 0) return fail(PartsStatus::EmptyDomain, 0);
  std::size_t n_on_boundary = 0;
  part_.own().for_each([&](std::int64_t v) {
    if (inside_.test(v)) n_on_boundary += part_.whole().on_boundary(part_.to_whole(v));
  });
  n_on_boundary = ranks_.sum(n_on_boundary);
  return n_on_boundary == 0 || fail(PartsStatus::DomainLeavesBackground, n_on_boundary);
}

bool PartRun::classify() {
  begin_phase("classify");
  PartClassification others(part_, ranks_);
  const ClassificationReport report =
      classify_vertices(part_.lattice(), *costs_.links, psi_, classification_, inside_, {}, nullptr, nullptr, &others);
  result_.manifold_flips = make_parts_manifold(comm_, part_, partition_, psi_, classification_, report.not_manifold,
                                               inside_, result_.n_psi_evaluations);
  result_.n_psi_evaluations += report.psi_evaluations;
  if (!result_.manifold_flips.empty() && count_inside() == 0) return fail(PartsStatus::EmptyDomain, 0);
  std::size_t n_tets = 0;
  for_each_tet([&](std::int64_t, const auto&, std::int64_t) { ++n_tets; });
  result_.n_chosen_tets = ranks_.sum(n_tets);
  return true;
}

std::size_t PartRun::count_inside() {
  std::size_t n = 0;
  part_.own().for_each([&](std::int64_t v) { n += inside_.test(v); });
  return ranks_.sum(n);
}

void PartRun::fit() {
  begin_phase("project");
  const IdSet movable = movable_vertices(part_.lattice(), *costs_.links, inside_, params_.layers);
  IdSet own = movable;
  for (std::size_t w = 0; w < own.n_words(); ++w) own.set_word(w, own.word(w) & part_.own().word(w));
  layer_ = layer_part(part_.lattice(), *costs_.links, inside_, movable, own);
  SharedLayer shared(part_, ranks_, layer_, movable);
  PNormSmoother smoother(layer_.layer);
  layer_.layer.ring = {};  // the smoother has listed their faces
  smoother.share(shared);
  const std::vector<std::uint8_t> inside = inside_of(layer_, inside_);
  FittedLayer made = fit_layer(smoother, psi_, params_, {.smoothing = params_.smoothing, .inside = &inside});
  result_.n_psi_evaluations += made.psi_evaluations;
  std::swap(layer_.layer.V, made.projected);
  projected_ = places_of(layer_);
  std::swap(layer_.layer.V, made.projected);
}

void PartRun::repair() {
  begin_phase("repair");
  RepairParams params = params_.repair;
  params.target += costs_.repair_target - kQualityTarget;
  params.reach = std::min(params.reach, costs_.repair_reach);
  const PartRepair made = repair_parts(comm_, part_, partition_, psi_, classification_, params, layer_, inside_);
  for (const std::int64_t there : made.flipped) {
    const std::int64_t v = part_.from_whole(there);
    if (v >= 0) inside_.test(v) ? inside_.erase(v) : inside_.insert(v);
  }
  places_ = replaced(places_of(layer_), own_of(made.moved));
  projected_ = replaced(projected_, own_of(made.moved));
  layer_ = {};
  result_.n_gets = made.n_gets;
  result_.bytes_got = made.bytes;
  result_.n_psi_evaluations += made.psi_evaluations;
}

/// Returns the own vertices in a list with ids of the whole lattice.
Places PartRun::own_of(const Places& moved) const {
  Places own;
  for (const auto& [there, x] : moved) {
    const std::int64_t v = part_.from_whole(there);
    if (v >= 0 && part_.own().test(v)) own.emplace_back(v, x);
  }
  return own;
}

/// Returns the position of an own vertex.
Vec3 PartRun::place(const Places& of_own, std::int64_t v) const {
  const auto found =
      std::lower_bound(of_own.begin(), of_own.end(), v, [](const auto& a, std::int64_t id) { return a.first < id; });
  return found != of_own.end() && found->first == v ? found->second : part_.lattice().position(v);
}

/// Calls f(vertex of type 0 of the cell, id steps from it to the corners, id in the whole lattice) for the tets of own
/// cells with an inside vertex.
template <class F>
void PartRun::for_each_tet(const F& f) const {
  const BackgroundMesh& lattice = part_.lattice();
  const auto& tets = lattice.tiling().tets;
  std::vector<std::array<std::int64_t, 4>> steps(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t k = 0; k < 4; ++k) steps[t][k] = lattice.id_step(0, tets[t][k]);
  }
  part_.for_each_own_cell([&](const BackgroundMesh::Cell& cell, std::int64_t number) {
    const std::int64_t first = lattice.vertex_id(0, cell);
    for (std::size_t t = 0; t < steps.size(); ++t) {
      bool any = false;
      for (const std::int64_t step : steps[t]) any |= inside_.test(first + step);
      if (any) f(first, steps[t], static_cast<std::int64_t>(t + steps.size() * static_cast<std::size_t>(number)));
    }
  });
}

/// Lists the tets, with the ids of lattice().
void PartRun::list_tets(IdSet& used) {
  std::size_t n = 0;
  for_each_tet([&](std::int64_t first, const auto& corners, std::int64_t) {
    ++n;
    for (const std::int64_t step : corners) used.insert(first + step);
  });
  used.index();
  result_.mesh.C.reserve(n);
  result_.background_tet.reserve(n);
  for_each_tet([&](std::int64_t first, const auto& corners, std::int64_t id) {
    result_.mesh.C.push_back({used.rank(first + corners[0]), used.rank(first + corners[1]),
                              used.rank(first + corners[2]), used.rank(first + corners[3])});
    result_.background_tet.push_back(id);
  });
}

void PartRun::emit() {
  begin_phase("emit");
  IdSet used(part_.lattice().n_vertices());
  list_tets(used);
  used.for_each([&](std::int64_t v) {
    vertex_.push_back(v);
    result_.background_vertex.push_back(part_.to_whole(v));
    result_.owner.push_back(part_.owner(v));
  });
  list_positive_faces();
  fetch(places_, result_.mesh.V);
  fetch(projected_, result_.projected);
}

void PartRun::list_positive_faces() {
  for (std::size_t t = 0; t < result_.mesh.C.size(); ++t) {
    const Tet& tet = result_.mesh.C[t];
    unsigned mask = 0;
    for (unsigned k = 0; k < 4; ++k) mask |= static_cast<unsigned>(inside_.test(vertex_[tet[k]])) << k;
    if (!is_positively_cut(mask)) continue;
    const auto& face = kTetFace[std::countr_zero(mask)];
    result_.positive_faces.push_back({tet[face[0]], tet[face[1]], tet[face[2]]});
    result_.positive_tets.push_back(static_cast<int>(t));
  }
}

/// Requests the positions of vertices that other ranks own, and answers such requests. Collective.
void PartRun::fetch(const Places& of_own, std::vector<Vec3>& V) {
  V.resize(vertex_.size());
  std::vector<Neighbourhood::Bytes> asked(ranks_.ranks().size()), answers(asked.size());
  std::vector<std::vector<std::size_t>> theirs(asked.size());
  for (std::size_t k = 0; k < vertex_.size(); ++k) {
    if (part_.own().test(vertex_[k])) {
      V[k] = place(of_own, vertex_[k]);
      continue;
    }
    const std::size_t neighbour = ranks_.number(result_.owner[k]);
    put(asked[neighbour], result_.background_vertex[k]);
    theirs[neighbour].push_back(k);
  }
  const std::vector<Neighbourhood::Bytes> wanted = ranks_.exchange(asked);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    for (std::size_t at = 0; at < wanted[k].size();) {
      const Vec3 x = place(of_own, part_.from_whole(take<std::int64_t>(wanted[k], at)));
      for (int a = 0; a < 3; ++a) put(answers[k], x[a]);
    }
  }
  const std::vector<Neighbourhood::Bytes> places = ranks_.exchange(answers);
  for (std::size_t k = 0; k < places.size(); ++k) {
    std::size_t at = 0;
    for (const std::size_t v : theirs[k]) {
      for (int a = 0; a < 3; ++a) V[v][a] = take<double>(places[k], at);
    }
  }
}

/// Moves vertices back where the mesh intersects itself.
void PartRun::embed() {
  begin_phase("embed");
  const auto moved = step_parts_back(comm_, part_, partition_, ranks_, {result_.mesh, vertex_, inside_, places_});
  result_.n_stepped_back = moved.size();
  if (moved.empty()) return;
  places_ = replaced(places_, own_of(moved));
  fetch(places_, result_.mesh.V);
}

}  // namespace

const char* to_string(PartsStatus status) {
  switch (status) {
    case PartsStatus::Success:
      return "success";
    case PartsStatus::EmptyDomain:
      return "empty domain";
    case PartsStatus::DomainLeavesBackground:
      return "domain leaves background";
  }
  return "";
}

DistributedMesh distributed_mesh(MPI_Comm comm, const BackgroundMesh& background, ImplicitFunctionRef psi,
                                 const FastParams& params, const std::vector<Vec3>& seeds, double held) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (!all.empty()) throw std::invalid_argument(all);
  if (!background.is_lattice()) throw std::invalid_argument("background: must be a lattice");
  if (!configuration_costs(background.tiling())) throw std::invalid_argument("background: its tiling has no costs");
  begin_phase("partition");
  return PartRun(comm, background, psi, params, seeds, held)();
}

}  // namespace umtet
