#include "distributed/program/held_mesh.h"

#include <algorithm>
#include <cstdint>
#include <system_error>
#include <utility>
#include <vector>

#include "distributed/collect.h"
#include "distributed/io/part_quality.h"
#include "distributed/io/shared_file.h"
#include "distributed/io/standard_data.h"
#include "distributed/part_boundary.h"
#include "distributed/part_certificate.h"
#include "mesh/io/quality_csv.h"
#include "mesh/submesh/assumptions.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

/// A positive face on its way to rank 0.
struct SentFace {
  std::int64_t id;
  std::int64_t corner[3];
  double place[3][3];
};

std::size_t sum(MPI_Comm comm, std::size_t n) {
  std::uint64_t all = n;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_UINT64_T, MPI_SUM, comm);
  return all;
}

}  // namespace

HeldMesh::HeldMesh(MPI_Comm comm, const BackgroundMesh& background, ImplicitFunctionRef psi, const FastParams& params,
                   const RoundedPlaces& places)
    : comm_(comm), background_(background), places_(places), mesh_(distributed_mesh(comm, background, psi, params)) {
  for (auto* V : {&mesh_.mesh.V, &mesh_.projected}) {
    for (Vec3& x : *V) x = (x + places_.shift) - places_.shift;
  }
}

/// Places before anything moves, rounded as the others are.
std::vector<Vec3> HeldMesh::chosen() const {
  std::vector<Vec3> V;
  for (const std::int64_t v : mesh_.background_vertex)
    V.push_back((background_.position(v) + places_.shift) - places_.shift);
  return V;
}

/// Faces in the order of their tets, and their vertices in that of their ids, as in the whole mesh.
void HeldMesh::gather_boundary(UmResult& result) const {
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

/// Conditioning angles, by positive faces of own tets.
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
  gather_boundary(made.result);
  measure_assumptions(made.result);
  return made;
}

void HeldMesh::write(const fs::path& file, MeshState state, bool moving_alone) {
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
  for (Vec3& x : V) x += places_.shift;
  V.swap(mesh_.mesh.V);  // until it is written
  try {
    if (sum(comm_, moving.size()) == 0) {
      write_whole_vtu(comm_, file, mesh_, &boundary_);
    } else {
      const DistributedMesh some = some_of(mesh_, moving);
      std::vector<std::uint8_t> of_some;
      std::size_t v = 0;
      for (const std::int64_t id : some.background_vertex) {
        while (mesh_.background_vertex[v] != id) ++v;
        of_some.push_back(boundary_[v]);
      }
      write_whole_vtu(comm_, file, some, &of_some);
    }
  } catch (...) {
    V.swap(mesh_.mesh.V);
    throw;
  }
  V.swap(mesh_.mesh.V);
}

void HeldMesh::write_quality(const fs::path& file) {
  std::vector<Vec3> before = chosen(), between = mesh_.projected, last = mesh_.mesh.V;
  for (auto* V : {&before, &between, &last}) {
    for (Vec3& x : *V) x += places_.shift;
  }
  const QualitySamples made =
      quality_samples(comm_, mesh_, {{"omega_h", &before}, {"projected", &between}, {"final", &last}});
  int error = 0;
  try {
    if (rank_in(comm_) == 0) write_quality_csv(file, made.indices, made.curves);
  } catch (const std::system_error& e) {
    error = e.code().value();
  }
  MPI_Allreduce(MPI_IN_PLACE, &error, 1, MPI_INT, MPI_MAX, comm_);
  if (error != 0) throw KnownToAll(error, std::generic_category(), "cannot write " + file.string());
}

}  // namespace umtet
