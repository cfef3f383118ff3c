#include "distributed/distributed_mesh.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "distributed/collect.h"
#include "distributed/lattice_part.h"
#include "distributed/part_classification.h"
#include "distributed/part_embedding.h"
#include "distributed/part_manifold.h"
#include "distributed/part_repair.h"
#include "distributed/partition.h"
#include "distributed/shared_layer.h"
#include "mesh/base/id_blocks.h"
#include "mesh/classification/classification.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/fast/fitted_layer.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {
namespace {

class PartRun {
 public:
  PartRun(MPI_Comm comm, const BackgroundMesh& background, ImplicitFunctionRef psi, const FastParams& params)
      : psi_(psi),
        params_(params),
        comm_(comm),
        partition_(balanced_partition(comm, background, psi)),
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
  void fetch_places();
  void embed();
  void move(const std::vector<std::pair<std::int64_t, Vec3>>& moved);
  void list_tets(IdSet& used);
  Vec3 place(std::int64_t v) const;

  ImplicitFunctionRef psi_;
  const FastParams& params_;
  MPI_Comm comm_;
  const Partition partition_;
  const LatticePart part_;
  Neighbourhood ranks_;
  const BackgroundCosts costs_;
  ClassificationParams classification_;  ///< with the costs
  IdSet inside_;                         ///< of known vertices
  BackgroundLayer layer_;
  std::vector<std::pair<std::int64_t, Vec3>> places_;  ///< of own vertices that are not where the background has them
  std::vector<std::int64_t> vertex_;                   ///< those of the result, by ids of the part
  DistributedMesh result_;
};

void PartRun::find_inside() {
  for_each_in_blocks(part_.known(), [&](std::size_t, std::int64_t v) {
    if (part_.lattice().has_tets(v) && psi_.value(part_.lattice().position(v)) < 0) inside_.insert_shared(v);
  });
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
  PartClassification others(part_, ranks_);
  const ClassificationReport report =
      classify_vertices(part_.lattice(), *costs_.links, psi_, classification_, inside_, {}, nullptr, nullptr, &others);
  result_.manifold_flips =
      make_parts_manifold(comm_, part_, partition_, psi_, classification_, report.not_manifold, inside_);
  return result_.manifold_flips.empty() || count_inside() > 0 || fail(PartsStatus::EmptyDomain, 0);
}

std::size_t PartRun::count_inside() {
  std::size_t n = 0;
  part_.own().for_each([&](std::int64_t v) { n += inside_.test(v); });
  return ranks_.sum(n);
}

void PartRun::fit() {
  const IdSet movable = movable_vertices(part_.lattice(), *costs_.links, inside_, params_.layers);
  IdSet own = movable;
  for (std::size_t w = 0; w < own.n_words(); ++w) own.set_word(w, own.word(w) & part_.own().word(w));
  layer_ = layer_part(part_.lattice(), *costs_.links, inside_, movable, own);
  SharedLayer shared(part_, ranks_, layer_, movable);
  PNormSmoother smoother(layer_.layer);
  layer_.layer.ring = {};  // the smoother has listed their faces
  smoother.share(shared);
  const std::vector<std::uint8_t> inside = inside_of(layer_, inside_);
  fit_layer(smoother, psi_, params_, {.smoothing = params_.smoothing, .inside = &inside});
}

void PartRun::repair() {
  RepairParams params = params_.repair;
  params.target += costs_.repair_target - kQualityTarget;
  params.reach = std::min(params.reach, costs_.repair_reach);
  const PartRepair made = repair_parts(comm_, part_, partition_, psi_, classification_, params, layer_, inside_);
  for (const std::int64_t there : made.flipped) {
    const std::int64_t v = part_.from_whole(there);
    if (v >= 0) inside_.test(v) ? inside_.erase(v) : inside_.insert(v);
  }
  places_ = places_of(layer_);
  layer_ = {};
  move(made.moved);
  result_.n_gets = made.n_gets;
  result_.bytes_got = made.bytes;
}

/// Own vertices, by ids of the whole.
void PartRun::move(const std::vector<std::pair<std::int64_t, Vec3>>& moved) {
  std::vector<std::pair<std::int64_t, Vec3>> both;
  for (const auto& [there, x] : moved) {
    const std::int64_t v = part_.from_whole(there);
    if (v >= 0 && part_.own().test(v)) both.emplace_back(v, x);
  }
  const auto is_less = [](const auto& a, const auto& b) { return a.first < b.first; };
  const std::size_t n = both.size();
  for (const auto& place : places_) {
    const auto end = both.begin() + static_cast<std::ptrdiff_t>(n);
    if (!std::binary_search(both.begin(), end, place, is_less)) both.push_back(place);
  }
  std::sort(both.begin(), both.end(), is_less);
  places_ = std::move(both);
}

/// Where an own vertex is.
Vec3 PartRun::place(std::int64_t v) const {
  const auto found =
      std::lower_bound(places_.begin(), places_.end(), v, [](const auto& a, std::int64_t id) { return a.first < id; });
  return found != places_.end() && found->first == v ? found->second : part_.lattice().position(v);
}

/// The tets of own cells with a vertex inside, by ids of lattice().
void PartRun::list_tets(IdSet& used) {
  const BackgroundMesh& lattice = part_.lattice();
  const auto& tets = lattice.tiling().tets;
  std::vector<std::array<std::int64_t, 4>> steps(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t k = 0; k < 4; ++k) steps[t][k] = lattice.id_step(0, tets[t][k]);
  }
  const auto for_each = [&](const auto& f) {
    part_.for_each_own_cell([&](const BackgroundMesh::Cell& cell, std::int64_t number) {
      const std::int64_t first = lattice.vertex_id(0, cell);
      for (std::size_t t = 0; t < steps.size(); ++t) {
        bool any = false;
        for (const std::int64_t step : steps[t]) any |= inside_.test(first + step);
        if (any) f(first, steps[t], static_cast<std::int64_t>(t + steps.size() * static_cast<std::size_t>(number)));
      }
    });
  };
  std::size_t n = 0;
  for_each([&](std::int64_t first, const auto& corners, std::int64_t) {
    ++n;
    for (const std::int64_t step : corners) used.insert(first + step);
  });
  used.index();
  result_.mesh.C.reserve(n);
  result_.background_tet.reserve(n);
  for_each([&](std::int64_t first, const auto& corners, std::int64_t id) {
    result_.mesh.C.push_back({used.rank(first + corners[0]), used.rank(first + corners[1]),
                              used.rank(first + corners[2]), used.rank(first + corners[3])});
    result_.background_tet.push_back(id);
  });
}

void PartRun::emit() {
  IdSet used(part_.lattice().n_vertices());
  list_tets(used);
  used.for_each([&](std::int64_t v) {
    vertex_.push_back(v);
    result_.background_vertex.push_back(part_.to_whole(v));
    result_.owner.push_back(part_.owner(v));
  });
  result_.mesh.V.resize(vertex_.size());
  fetch_places();
}

/// Places of vertices of others are asked for, and the others answer.
void PartRun::fetch_places() {
  std::vector<Neighbourhood::Bytes> asked(ranks_.ranks().size()), answers(asked.size());
  std::vector<std::vector<std::size_t>> theirs(asked.size());
  for (std::size_t k = 0; k < vertex_.size(); ++k) {
    if (part_.own().test(vertex_[k])) {
      result_.mesh.V[k] = place(vertex_[k]);
      continue;
    }
    const std::size_t neighbour = ranks_.number(result_.owner[k]);
    put(asked[neighbour], result_.background_vertex[k]);
    theirs[neighbour].push_back(k);
  }
  const std::vector<Neighbourhood::Bytes> wanted = ranks_.exchange(asked);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    for (std::size_t at = 0; at < wanted[k].size();) {
      const Vec3 x = place(part_.from_whole(take<std::int64_t>(wanted[k], at)));
      for (int a = 0; a < 3; ++a) put(answers[k], x[a]);
    }
  }
  const std::vector<Neighbourhood::Bytes> places = ranks_.exchange(answers);
  for (std::size_t k = 0; k < places.size(); ++k) {
    std::size_t at = 0;
    for (const std::size_t v : theirs[k]) {
      for (int a = 0; a < 3; ++a) result_.mesh.V[v][a] = take<double>(places[k], at);
    }
  }
}

/// Vertices go back where the mesh meets itself.
void PartRun::embed() {
  const auto moved = step_parts_back(comm_, part_, partition_, ranks_, {result_.mesh, vertex_, inside_, places_});
  result_.n_stepped_back = moved.size();
  if (moved.empty()) return;
  move(moved);
  fetch_places();
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
                                 const FastParams& params) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (!all.empty()) throw std::invalid_argument(all);
  if (!background.is_lattice()) throw std::invalid_argument("background: must be a lattice");
  if (!configuration_costs(background.tiling())) throw std::invalid_argument("background: its tiling has no costs");
  return PartRun(comm, background, psi, params)();
}

}  // namespace umtet
