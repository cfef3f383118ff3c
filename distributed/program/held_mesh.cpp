#include "distributed/program/held_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "distributed/certify/part_boundary.h"
#include "distributed/certify/part_certificate.h"
#include "distributed/exchange/collect.h"
#include "distributed/exchange/phase.h"
#include "distributed/io/curved_files.h"
#include "distributed/io/part_quality.h"
#include "distributed/io/standard_data.h"
#include "distributed/io/whole_xdmf.h"
#include "distributed/io/write_together.h"
#include "distributed/program/boundary_values.h"
#include "mesh/io/quality_csv.h"
#include "mesh/submesh/assumptions.h"
#include "pipeline/meshing/sample_fields.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

/// A positive face in a message to rank 0.
struct SentFace {
  std::int64_t id;
  std::int64_t corner[3];
  double place[3][3];
};

}  // namespace

HeldMesh::HeldMesh(MPI_Comm comm, const BackgroundMesh& background, ImplicitFunctionRef psi, const FastParams& params,
                   const std::vector<Vec3>& seeds, const RoundedPlaces& places, double held)
    : comm_(comm),
      background_(background),
      places_(places),
      mesh_(distributed_mesh(comm, background, psi, params, seeds, held)) {
  for (auto* V : {&mesh_.mesh.V, &mesh_.projected}) {
    for (Vec3& x : *V) x = (x + places_.shift) - places_.shift;
  }
}

/// Returns the positions before projection, rounded like the other positions.
std::vector<Vec3> HeldMesh::chosen() const {
  std::vector<Vec3> V;
  for (const std::int64_t v : mesh_.background_vertex)
    V.push_back((background_.position(v) + places_.shift) - places_.shift);
  return V;
}

/// Gathers the boundary on rank 0: faces in the order of their tets and vertices in the order of their ids, as in the
/// whole mesh.
void HeldMesh::gather_boundary(UmResult& result) const {
  begin_phase("boundary");
  std::vector<SentFace> faces;
  for (std::size_t f = 0; f < mesh_.positive_faces.size(); ++f) {
    const Triangle& t = mesh_.positive_faces[f];
    SentFace& sent = faces.emplace_back();
    sent.id = face_id(mesh_, static_cast<std::size_t>(mesh_.positive_tets[f]), t);
    for (std::size_t k = 0; k < 3; ++k) {
      sent.corner[k] = mesh_.background_vertex[t[k]];
      std::copy_n(mesh_.mesh.V[t[k]].data(), 3, sent.place[k]);
    }
  }
  faces = gathered(comm_, faces);
  std::sort(faces.begin(), faces.end(), [](const SentFace& a, const SentFace& b) { return a.id < b.id; });
  std::vector<std::int64_t>& ids = result.submesh.background_vertex;
  for (const SentFace& f : faces) ids.insert(ids.end(), f.corner, f.corner + 3);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  result.final.resize(ids.size());
  for (const SentFace& f : faces) {
    Triangle& t = result.submesh.positive_faces.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      t[k] = static_cast<int>(std::lower_bound(ids.begin(), ids.end(), f.corner[k]) - ids.begin());
      result.final[t[k]] = Vec3(f.place[k][0], f.place[k][1], f.place[k][2]);
    }
  }
  for (std::size_t v = 0; v < ids.size(); ++v) result.submesh.positive_vertices.push_back(static_cast<int>(v));
}

/// Counts violations of the assumptions about conditioning angles, at the positive faces of local tets.
void HeldMesh::measure_assumptions(UmResult& result) const {
  Submesh own;
  for (const std::int64_t v : mesh_.background_vertex) own.mesh.V.push_back(background_.position(v));
  own.positive_faces = mesh_.positive_faces;
  for (const int t : mesh_.positive_tets) {
    own.positive_tets.push_back(static_cast<int>(own.mesh.C.size()));
    own.mesh.C.push_back(mesh_.mesh.C[t]);
  }
  for (const Triangle& f : own.positive_faces)
    own.positive_vertices.insert(own.positive_vertices.end(), f.begin(), f.end());
  std::sort(own.positive_vertices.begin(), own.positive_vertices.end());
  own.positive_vertices.erase(std::unique(own.positive_vertices.begin(), own.positive_vertices.end()),
                              own.positive_vertices.end());
  std::vector<double> distance;
  for (const int v : own.positive_vertices) distance.push_back((mesh_.mesh.V[v] - own.mesh.V[v]).norm());
  const ConditioningAngles angles = conditioning_angles(own, distance);
  result.conditioning_angle_max_deg = angles.max_deg;
  MPI_Allreduce(MPI_IN_PLACE, &result.conditioning_angle_max_deg, 1, MPI_DOUBLE, MPI_MAX, comm_);
  result.obtuse_conditioning_angles = sum(comm_, angles.not_acute.count);
}

MadeInParts HeldMesh::summary(ImplicitFunctionRef psi) const {
  MadeInParts made;
  made.n_tets = sum(comm_, mesh_.mesh.C.size());
  made.n_chosen_tets = mesh_.n_chosen_tets;
  made.certificate = certify_parts(comm_, mesh_, places_.h, psi, places_.rounding);
  made.result.manifold_flips = mesh_.manifold_flips;
  made.result.n_stepped_back = mesh_.n_stepped_back;
  made.result.n_psi_evaluations = mesh_.n_psi_evaluations;
  gather_boundary(made.result);
  measure_assumptions(made.result);
  return made;
}

CurvedInParts HeldMesh::curve(ImplicitFunctionRef psi, const ClosestPointParams& params) {
  begin_phase("curve");
  const VertexOwners owners(comm_, mesh_);
  SecondOrderParams second;
  second.closest_point = params;
  PartEdges edges(comm_, mesh_, owners);
  CurvedParts parts = curved_parts(comm_, mesh_, edges, psi, places_.h, second);
  for (std::size_t i = mesh_.mesh.V.size(); i < parts.mesh.V.size(); ++i) {
    Vec3& x = parts.mesh.V[i];
    x = (x + places_.shift) - places_.shift;
  }
  curved_.emplace(Curved{std::move(edges), std::move(parts), {}, {}});
  CurvedInParts made;
  const CurvedParts& curved = curved_->parts;
  made.report = {certify_curved_parts(comm_, mesh_, owners, curved_->edges, curved, psi, places_.h, places_.rounding),
                 SecondOrderReport::Repairs{.n_mid_sides_put_back = curved.n_off_surface,
                                            .n_mid_sides_unprojected = curved.n_unprojected,
                                            .n_mid_sides_slid = curved.n_slid,
                                            .n_mid_sides_relaxed = curved.n_relaxed}};
  gather_mid_sides(made.mid_sides);
  return made;
}

/// Gathers the mid-sides of boundary edges on rank 0, in the order of ranks.
void HeldMesh::gather_mid_sides(std::vector<Vec3>& mid_sides) {
  struct Said {
    char is_curved;
    std::array<double, 3> place;
  };
  std::vector<char> is_curved(curved_->edges.owned().size(), 0);
  std::vector<std::array<double, 3>> owned(is_curved.size()), sent;
  curved_->edges.exchange().ask(
      [&](std::size_t e) {
        const Vec3& x = curved_->parts.mesh.V[mesh_.mesh.V.size() + e];
        return Said{curved_->parts.is_curved[e], {x.x(), x.y(), x.z()}};
      },
      [&](std::size_t k, const Said& said) {
        is_curved[k] = said.is_curved;
        owned[k] = said.place;
      });
  for (std::size_t k = 0; k < owned.size(); ++k) {
    if (!is_curved[k]) continue;
    curved_->on_boundary.push_back(k);
    sent.push_back(owned[k]);
  }
  curved_->n_of_rank = gathered(comm_, std::vector<std::size_t>{sent.size()});
  for (const auto& x : gathered(comm_, sent)) mid_sides.emplace_back(x[0], x[1], x[2]);
}

CurvedPiece HeldMesh::curved_piece() const { return {mesh_, curved_->edges, curved_->parts, places_.shift}; }

void HeldMesh::write_curved(const fs::path& file, const BoundaryData& data) {
  write_whole_vtu(comm_, file, curved_piece(), boundary_, shared_values(comm_, mesh_, data), mid_side_values(data));
}

MidSideValues HeldMesh::mid_side_values(const BoundaryData& data) const {
  return shared_mid_side_values(comm_, curved_->on_boundary, curved_->n_of_rank, data);
}

/// Calls write() while the mesh has the positions V, in model coordinates.
template <class Write>
auto HeldMesh::with_places(std::vector<Vec3>& V, const Write& write) {
  for (Vec3& x : V) x += places_.shift;
  V.swap(mesh_.mesh.V);
  const auto swap_back = [&](DistributedMesh* mesh) { V.swap(mesh->mesh.V); };
  const std::unique_ptr<DistributedMesh, decltype(swap_back)> guard(&mesh_, swap_back);
  return write();
}

void HeldMesh::write(const fs::path& file, MeshState state, bool moving_alone, const BoundaryData& data) {
  begin_phase("files");
  std::vector<Vec3> V = state == MeshState::Projected ? mesh_.projected : mesh_.mesh.V;
  std::vector<std::size_t> moving;
  if (moving_alone || state == MeshState::Chosen) {
    const std::vector<Vec3> before = chosen();
    std::vector<char> moves(before.size());
    for (std::size_t v = 0; v < before.size(); ++v)
      moves[v] = before[v] != mesh_.projected[v] || before[v] != mesh_.mesh.V[v];
    for (std::size_t t = 0; moving_alone && t < mesh_.mesh.C.size(); ++t) {
      const Tet& tet = mesh_.mesh.C[t];
      if (std::any_of(tet.begin(), tet.end(), [&](int v) { return moves[v]; })) moving.push_back(t);
    }
    if (state == MeshState::Chosen) V = before;
  }
  if (!knows_boundary_) boundary_ = on_boundary(comm_, mesh_);
  knows_boundary_ = true;
  with_places(V, [&] {
    if (curved_ && state == MeshState::Final) return write_curved(file, data);
    if (sum(comm_, moving.size()) == 0)
      return write_whole_vtu(comm_, file, mesh_, &boundary_, shared_values(comm_, mesh_, data));
    const DistributedMesh some = some_of(mesh_, moving);
    std::vector<std::uint8_t> of_some;
    std::size_t v = 0;
    for (const std::int64_t id : some.background_vertex) {
      while (mesh_.background_vertex[v] != id) ++v;
      of_some.push_back(boundary_[v]);
    }
    write_whole_vtu(comm_, file, some, &of_some);
  });
}

std::vector<fs::path> HeldMesh::write_pieces(const fs::path& file, PieceFormat format, const PieceData* data) {
  begin_phase("pieces");
  std::vector<Vec3> V = mesh_.mesh.V;
  return with_places(V, [&] {
    if (format == PieceFormat::Xdmf) return write_whole_xdmf(comm_, file, mesh_);
    PieceExtras extras = data ? piece_extras(comm_, mesh_, *data) : PieceExtras();
    if (format == PieceFormat::Msh) {
      std::erase_if(extras.values.arrays, [](const VertexValues::Array& a) { return !is_of_scan(a.name); });
      return write_msh_pieces(comm_, file, mesh_, extras);
    }
    if (!curved_) return write_pvtu(comm_, file, mesh_, extras);
    const MidSideValues of_mid_sides = data ? mid_side_values(data->of_vertices) : MidSideValues();
    return write_curved_pvtu(comm_, file, curved_piece(), extras, of_mid_sides);
  });
}

TakenMesh HeldMesh::release() && {
  for (Vec3& x : mesh_.mesh.V) x += places_.shift;
  if (!curved_) return {std::move(mesh_), std::nullopt};
  for (Vec3& x : curved_->parts.mesh.V) x += places_.shift;
  return {std::move(mesh_), TakenMesh::Curved{std::move(curved_->edges), std::move(curved_->parts)}};
}

void HeldMesh::write_quality(const fs::path& file) {
  begin_phase("files");
  std::vector<Vec3> before = chosen(), between = mesh_.projected, last = mesh_.mesh.V;
  for (auto* V : {&before, &between, &last}) {
    for (Vec3& x : *V) x += places_.shift;
  }
  const QualitySamples made =
      quality_samples(comm_, mesh_, {{"omega_h", &before}, {"projected", &between}, {"final", &last}});
  write_together(comm_, file, rank_in(comm_) == 0, [&] { write_quality_csv(file, made.indices, made.curves); });
}

}  // namespace umtet
