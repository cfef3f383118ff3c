#include "distributed/io/ordered_vtu.h"

#include "distributed/exchange/collect.h"
#include "distributed/io/ordered_rows.h"
#include "distributed/io/shared_arrays.h"
#include "distributed/io/shared_file.h"
#include "mesh/io/vtu_shape.h"

namespace umtet {
namespace {

using Field = VtuField::Type;

constexpr std::size_t kStandard = 2;  // arrays of nodes that all meshes have

/// Writes the arrays of a mesh at the positions that its shape determines.
class Writer {
 public:
  Writer(MPI_Comm comm, const std::filesystem::path& path, const VtuRows& rows);
  void write();

 private:
  void nodes();
  void field(std::size_t a);
  template <std::size_t n, class Index>
  void tets();
  /// The last arrays of the shape are background_tet, mean_ratio, Points, connectivity, offsets and types.
  const VtuShape::Array* from_end(std::size_t k) const { return &shape_.arrays[shape_.arrays.size() - k]; }

  MPI_Comm comm_;
  const VtuRows& rows_;
  const VtuShape shape_;
  SharedFile file_;
};

VtuShape shape_of(MPI_Comm comm, const VtuRows& rows) {
  std::uint64_t n[2] = {rows.ids.size(), rows.mesh.mesh.C.size()};
  MPI_Allreduce(MPI_IN_PLACE, n, 2, MPI_UINT64_T, MPI_SUM, comm);
  std::vector<VtuField> of_nodes = {{"background_vertex", Field::Int64}, {"boundary", Field::UInt8}};
  for (const VertexValues::Array& a : rows.fields.arrays)
    of_nodes.push_back({a.name, a.n_components == 3 ? Field::ThreeFloat64 : Field::Float64});
  return vtu_shape(n[0], n[1], of_nodes, {{"background_tet", Field::Int64}, {"mean_ratio", Field::Float64}},
                   rows.nodes_per_tet);
}

Writer::Writer(MPI_Comm comm, const std::filesystem::path& path, const VtuRows& rows)
    : comm_(comm), rows_(rows), shape_(shape_of(comm, rows)), file_(comm, path) {}

void Writer::write() {
  if (rank_in(comm_) == 0) {
    for (const auto& [at, text] : shape_.texts) file_.write(at, text);
  }
  nodes();
  for (std::size_t a = 0; a < rows_.fields.arrays.size(); ++a) field(a);
  if (rows_.nodes_per_tet == 4) {
    shape_.has_wide_ids ? tets<4, std::int64_t>() : tets<4, std::int32_t>();
  } else {
    shape_.has_wide_ids ? tets<10, std::int64_t>() : tets<10, std::int32_t>();
  }
  file_.close(shape_.texts.back().first + shape_.texts.back().second.size());
}

void Writer::nodes() {
  constexpr std::int64_t kNoVertex = -1;  // the background vertex of a mid-side
  SharedArrays arrays(file_, {&shape_.arrays[0], &shape_.arrays[1], from_end(4)});
  put_nodes(comm_, rows_.ids, rows_.places, rows_.boundary, [&](NodeColumns& columns) {
    for (std::int64_t& id : columns.id)
      if (id >= rows_.first_mid_side) id = kNoVertex;
    arrays.put(0, 8 * columns.first, columns.id);
    arrays.put(1, columns.first, columns.boundary);
    arrays.put(2, 24 * columns.first, columns.places);
    arrays.write();
  });
}

void Writer::field(std::size_t a) {
  const std::vector<double> values = rows_.values(a);
  SharedArrays arrays(file_, {&shape_.arrays[kStandard + a]});
  const bool is_vector = rows_.fields.arrays[a].n_components == 3;
  const auto put = [&](std::size_t first, const std::vector<double>& column) {
    arrays.put(0, (is_vector ? 24 : 8) * first, column);
    arrays.write();
  };
  is_vector ? put_values<3>(comm_, rows_.ids, values, put) : put_values<1>(comm_, rows_.ids, values, put);
}

template <std::size_t n, class Index>
void Writer::tets() {
  constexpr std::uint8_t kType = n == 4 ? 10 : 24;  // VTK_TETRA, VTK_QUADRATIC_TETRA
  SharedArrays arrays(file_, {from_end(6), from_end(5), from_end(3), from_end(2), from_end(1)});
  put_tets<n, Index>(comm_, rows_.mesh, rows_.node, [&](const TetColumns<Index>& columns) {
    const std::size_t first = columns.first;
    std::vector<Index> ends;
    for (std::size_t t = 1; t <= columns.id.size(); ++t) ends.push_back(static_cast<Index>(n * (first + t)));
    arrays.put(0, 8 * first, columns.id);
    arrays.put(1, 8 * first, columns.quality);
    arrays.put(2, sizeof(Index) * n * first, columns.nodes);
    arrays.put(3, sizeof(Index) * first, ends);
    arrays.put(4, first, std::vector<std::uint8_t>(ends.size(), kType));
    arrays.write();
  });
}

}  // namespace

void write_ordered_vtu(MPI_Comm comm, const std::filesystem::path& file, const VtuRows& rows) {
  Writer(comm, file, rows).write();
}

}  // namespace umtet
