#include "distributed/io/part_files.h"

#include <array>
#include <system_error>
#include <utility>
#include <vector>

#include "distributed/collect.h"
#include "distributed/id_order.h"
#include "distributed/io/shared_arrays.h"
#include "distributed/io/shared_file.h"
#include "distributed/io/standard_data.h"
#include "mesh/certify/quality_report.h"
#include "mesh/io/checked_file.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/io/vtu_shape.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kPerPiece = 1 << 16;  // some megabytes
constexpr std::uint8_t kTetra = 10;         // VTK_TETRA
using Field = VtuField::Type;

struct OrderedVertex {
  std::int64_t id;
  double place[3];
  std::uint8_t boundary;
};

struct OrderedTet {
  std::int64_t id;
  std::int64_t corner[4];  ///< numbers in the whole mesh
  double quality;
};

/// Places of vertices that are owned.
std::vector<Vec3> places_of_owned(const VertexOwners& owners, const DistributedMesh& mesh) {
  std::vector<Vec3> V(owners.ids().size());
  owners.ask(
      [&](std::size_t v) {
        return std::array{mesh.mesh.V[v].x(), mesh.mesh.V[v].y(), mesh.mesh.V[v].z()};
      },
      [&](std::size_t k, const std::array<double, 3>& x) { V[k] = Vec3(x[0], x[1], x[2]); });
  return V;
}

void write_vertices(MPI_Comm comm, const DistributedMesh& mesh, const StandardData& data, const VtuShape& shape,
                    SharedFile& file) {
  const std::vector<std::int64_t>& ids = data.owners.ids();
  const std::vector<Vec3> V = places_of_owned(data.owners, mesh);
  const IdOrder order(comm, ids, kPerPiece);
  SharedArrays arrays(comm, file, {&shape.arrays[0], &shape.arrays[1], &shape.arrays[4]});
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    const auto piece = order.piece<OrderedVertex>(round, [&](std::size_t k) {
      return OrderedVertex{ids[k], {V[k].x(), V[k].y(), V[k].z()}, data.boundary[k]};
    });
    std::vector<std::int64_t> id;
    std::vector<std::uint8_t> boundary;
    std::vector<double> places;
    for (const OrderedVertex& v : piece) {
      id.push_back(v.id);
      boundary.push_back(v.boundary);
      places.insert(places.end(), v.place, v.place + 3);
    }
    const std::size_t first = order.first(round);
    arrays.put(0, 8 * first, id);
    arrays.put(1, first, boundary);
    arrays.put(2, 24 * first, places);
    arrays.write();
  }
}

template <class Index>
void write_tets(MPI_Comm comm, const DistributedMesh& mesh, const StandardData& data, const VtuShape& shape,
                SharedFile& file) {
  const IdOrder order(comm, mesh.background_tet, kPerPiece);
  SharedArrays arrays(comm, file,
                      {&shape.arrays[2], &shape.arrays[3], &shape.arrays[5], &shape.arrays[6], &shape.arrays[7]});
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    const std::size_t begin = order.begin(round);
    std::vector<double> Q(order.begin(round + 1) - begin);
    measure_mean_ratios(mesh.mesh, Q, begin);
    const auto piece = order.piece<OrderedTet>(round, [&](std::size_t t) {
      OrderedTet tet{mesh.background_tet[t], {}, Q[t - begin]};
      for (std::size_t k = 0; k < 4; ++k) tet.corner[k] = data.own_number[mesh.mesh.C[t][k]];
      return tet;
    });
    std::vector<std::int64_t> id;
    std::vector<double> quality;
    std::vector<Index> corners, ends;
    const std::size_t first = order.first(round);
    for (const OrderedTet& t : piece) {
      id.push_back(t.id);
      quality.push_back(t.quality);
      for (const std::int64_t v : t.corner) corners.push_back(static_cast<Index>(v));
      ends.push_back(static_cast<Index>(4 * (first + id.size())));
    }
    arrays.put(0, 8 * first, id);
    arrays.put(1, 8 * first, quality);
    arrays.put(2, sizeof(Index) * 4 * first, corners);
    arrays.put(3, sizeof(Index) * first, ends);
    arrays.put(4, first, std::vector<std::uint8_t>(piece.size(), kTetra));
    arrays.write();
  }
}

/// What went wrong on any rank, on all. Collective.
void throw_first(MPI_Comm comm, int error, const fs::path& file) {
  MPI_Allreduce(MPI_IN_PLACE, &error, 1, MPI_INT, MPI_MAX, comm);
  if (error != 0) throw KnownToAll(error, std::generic_category(), "cannot write " + file.string());
}

std::string list_of(const std::vector<fs::path>& pieces) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<PUnstructuredGrid GhostLevel=\"0\">\n<PPointData>\n";
  const auto array = [&](const std::string& type, const std::string& name, const std::string& more = "") {
    text += "<PDataArray type=\"" + type + "\" Name=\"" + name + "\"" + more + "/>\n";
  };
  array("Int64", "background_vertex");
  array("UInt8", "boundary");
  array("Int64", "global_vertex");
  array("Int64", "owner");
  text += "</PPointData>\n<PCellData>\n";
  array("Int64", "background_tet");
  array("Int64", "global_tet");
  array("Float64", "mean_ratio");
  text += "</PCellData>\n<PPoints>\n";
  array("Float64", "Points", " NumberOfComponents=\"3\"");
  text += "</PPoints>\n";
  for (const fs::path& piece : pieces) text += "<Piece Source=\"" + piece.filename().string() + "\"/>\n";
  return text + "</PUnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace

DistributedMesh some_of(const DistributedMesh& mesh, const std::vector<std::size_t>& tets) {
  DistributedMesh some;
  std::vector<int> number(mesh.mesh.V.size(), -1);
  for (const std::size_t t : tets) {
    some.background_tet.push_back(mesh.background_tet[t]);
    some.mesh.C.push_back(mesh.mesh.C[t]);
    for (const int v : mesh.mesh.C[t]) number[v] = 0;
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(some.mesh.V.size());
    some.mesh.V.push_back(mesh.mesh.V[v]);
    some.background_vertex.push_back(mesh.background_vertex[v]);
    some.owner.push_back(mesh.owner[v]);
  }
  for (Tet& t : some.mesh.C)
    for (int& v : t) v = number[v];
  return some;
}

void write_whole_vtu(MPI_Comm comm, const fs::path& path, const DistributedMesh& mesh,
                     const std::vector<std::uint8_t>* on_boundary) {
  const StandardData data = standard_data(comm, mesh, on_boundary);
  std::uint64_t n[2] = {data.owners.ids().size(), mesh.mesh.C.size()};
  MPI_Allreduce(MPI_IN_PLACE, n, 2, MPI_UINT64_T, MPI_SUM, comm);
  const VtuShape shape = vtu_shape(n[0], n[1], {{"background_vertex", Field::Int64}, {"boundary", Field::UInt8}},
                                   {{"background_tet", Field::Int64}, {"mean_ratio", Field::Float64}});
  SharedFile file(comm, path);
  if (rank_in(comm) == 0) {
    for (const auto& [at, text] : shape.texts) file.write(at, text);
  }
  write_vertices(comm, mesh, data, shape, file);
  if (shape.has_wide_ids) {
    write_tets<std::int64_t>(comm, mesh, data, shape, file);
  } else {
    write_tets<std::int32_t>(comm, mesh, data, shape, file);
  }
  file.close(shape.texts.back().first + shape.texts.back().second.size());
}

std::vector<fs::path> write_pvtu(MPI_Comm comm, const fs::path& pvtu, const DistributedMesh& mesh) {
  const StandardData data = standard_data(comm, mesh);
  const auto name_of = [&](int rank) {
    return pvtu.parent_path() / (pvtu.stem().string() + "_" + std::to_string(rank) + ".vtu");
  };
  std::vector<std::uint8_t> boundary = data.owners.tell(data.boundary);
  MeshFile piece;
  piece.mesh = mesh.mesh;
  piece.point_data = {{"background_vertex", mesh.background_vertex},
                      {"boundary", std::move(boundary)},
                      {"global_vertex", data.own_number},
                      {"owner", std::vector<std::int64_t>(mesh.owner.begin(), mesh.owner.end())}};
  piece.cell_data = {{"background_tet", mesh.background_tet},
                     {"global_tet", IdOrder(comm, mesh.background_tet, kPerPiece).numbers()},
                     {"mean_ratio", mean_ratios(mesh.mesh)}};
  int error = 0;
  const fs::path own = name_of(rank_in(comm));
  try {
    if (!mesh.mesh.C.empty()) write_vtu(own, piece);
  } catch (const std::system_error& e) {
    error = e.code().value();
  }
  throw_first(comm, error, own);
  std::vector<int> with_tets = gathered(comm, std::vector<int>(mesh.mesh.C.empty() ? 0 : 1, rank_in(comm)));
  broadcast(comm, with_tets);
  std::vector<fs::path> pieces;
  for (const int rank : with_tets) pieces.push_back(name_of(rank));
  try {
    if (rank_in(comm) == 0) CheckedFile(pvtu).text(list_of(pieces)).close();
  } catch (const std::system_error& e) {
    error = e.code().value();
  }
  throw_first(comm, error, pvtu);
  pieces.insert(pieces.begin(), pvtu);
  return pieces;
}

}  // namespace umtet
