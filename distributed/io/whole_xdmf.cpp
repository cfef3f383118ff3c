#include "distributed/io/whole_xdmf.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "distributed/exchange/collect.h"
#include "distributed/exchange/id_order.h"
#include "distributed/io/ordered_rows.h"
#include "distributed/io/shared_file.h"
#include "distributed/io/standard_data.h"
#include "distributed/io/write_together.h"
#include "distributed/solver/solver_part.h"
#include "mesh/io/hdf5_shape.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

struct OrderedFace {
  std::int64_t id;
  std::int64_t corner[3];
  std::int64_t patch;
};

/// The HDF5 file, whose arrays are identified by their positions in a list.
class Arrays {
 public:
  Arrays(MPI_Comm comm, const fs::path& file, const std::vector<Hdf5Array>& arrays) : begin_(arrays.size()) {
    write_together(comm, file, rank_in(comm) == 0, [&] {
      try {
        begin_ = make_hdf5(file, arrays);
        size_ = fs::file_size(file);
      } catch (const std::system_error&) {
        throw;
      } catch (const std::runtime_error&) {  // HDF5 does not give the reason
        throw std::system_error(std::make_error_code(std::errc::io_error));
      }
    });
    MPI_Bcast(begin_.data(), static_cast<int>(begin_.size()), MPI_UINT64_T, 0, comm);
    MPI_Bcast(&size_, 1, MPI_UINT64_T, 0, comm);
    file_.emplace(comm, file);
  }
  /// @param first  number of values before these
  template <class T>
  void put(std::size_t array, std::size_t first, const std::vector<T>& values) {
    file_->write(begin_[array] + first * sizeof(T),
                 {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
  }
  void close() { file_->close(size_); }

 private:
  std::vector<std::uint64_t> begin_;
  std::uint64_t size_ = 0;
  std::optional<SharedFile> file_;
};

// In the order of write_hdf5(). Behind kBoundary come the sets of patches, if they are several, and then arrays of
// tets.
enum Place : std::size_t { kNodes, kTets, kFaces, kPatch, kBackgroundVertex, kBoundary };

std::vector<Hdf5Array> arrays_of(const XdmfShape& shape) {
  const bool wide = shape.has_wide_ids();
  const auto index = [&]() -> decltype(Hdf5Array::type) {
    if (wide) return std::int64_t{};
    return int{};
  };
  std::vector<Hdf5Array> arrays = {{"nodes", 0., shape.n_nodes, 3},
                                   {"tets", index(), shape.n_tets, 4},
                                   {"faces", index(), shape.n_faces, 3},
                                   {"patch", std::int64_t{}, shape.n_faces},
                                   {"point_data/background_vertex", std::int64_t{}, shape.n_nodes}};
  for (const std::string& set : shape.node_sets())
    arrays.push_back({"point_data/" + set, std::uint8_t{}, shape.n_nodes});
  arrays.push_back({"cell_data/background_tet", std::int64_t{}, shape.n_tets});
  arrays.push_back({"cell_data/mean_ratio", 0., shape.n_tets});
  return arrays;
}

class Writer {
 public:
  Writer(MPI_Comm comm, const DistributedMesh& mesh)
      : comm_(comm), mesh_(mesh), data_(standard_data(comm, mesh)), part_(solver_part(comm, mesh, data_.owners)) {
    shape_ = {part_.n_vertices, part_.n_tets, part_.n_faces, {}};
    for (std::size_t p = 0; p < part_.patches.size(); ++p)
      shape_.patches.push_back({part_.patches[p], static_cast<int>(p) + 2});
  }
  const XdmfShape& shape() const { return shape_; }
  void write(const fs::path& hdf5) {
    Arrays arrays(comm_, hdf5, arrays_of(shape_));
    write_vertices(arrays);
    if (shape_.patches.size() > 1) write_sets(arrays);
    if (shape_.has_wide_ids()) {
      write_cells<std::int64_t>(arrays);
    } else {
      write_cells<std::int32_t>(arrays);
    }
    arrays.close();
  }

 private:
  void write_vertices(Arrays& arrays) const;
  void write_sets(Arrays& arrays) const;
  template <class Index>
  void write_cells(Arrays& arrays) const;

  MPI_Comm comm_;
  const DistributedMesh& mesh_;
  const StandardData data_;
  const SolverPart part_;
  XdmfShape shape_;
};

void Writer::write_vertices(Arrays& arrays) const {
  const std::vector<Vec3> places = places_of_owned(data_.owners, mesh_.mesh);
  put_nodes(comm_, data_.owners.ids(), places, data_.boundary, [&](const NodeColumns& columns) {
    arrays.put(kNodes, 3 * columns.first, columns.places);
    arrays.put(kBackgroundVertex, columns.first, columns.id);
    arrays.put(kBoundary, columns.first, columns.boundary);
  });
}

void Writer::write_sets(Arrays& arrays) const {
  const std::vector<std::int64_t>& ids = data_.owners.ids();
  for (std::size_t p = 0; p < part_.patches.size(); ++p) {
    std::vector<std::uint8_t> is_in(mesh_.mesh.V.size(), 0);
    for (std::size_t f = 0; f < part_.boundary.size(); ++f) {
      if (part_.patch[f] != static_cast<int>(p)) continue;
      for (const int v : part_.boundary[f]) is_in[v] = 1;
    }
    const std::vector<std::uint8_t> owned = data_.owners.exchange().any_of_owned(is_in);
    put_values<1>(comm_, ids, owned, [&](std::size_t first, const std::vector<std::uint8_t>& values) {
      arrays.put(kBoundary + 1 + p, first, values);
    });
  }
}

template <class Index>
void Writer::write_cells(Arrays& arrays) const {
  const std::size_t of_tets = kBoundary + shape_.node_sets().size();
  const auto corner = [&](std::size_t t, std::size_t k) { return part_.global_vertex[mesh_.mesh.C[t][k]]; };
  put_tets<4, Index>(comm_, mesh_, corner, [&](const TetColumns<Index>& columns) {
    arrays.put(kTets, 4 * columns.first, columns.nodes);
    arrays.put(of_tets, columns.first, columns.id);
    arrays.put(of_tets + 1, columns.first, columns.quality);
  });
  const IdOrder faces(comm_, part_.global_face, kRowsPerPiece);
  for (std::size_t round = 0; round < faces.n_rounds(); ++round) {
    std::vector<Index> corners;
    std::vector<std::int64_t> patch;
    for (const OrderedFace& f : faces.piece<OrderedFace>(round, [&](std::size_t k) {
           OrderedFace face{part_.global_face[k], {}, shape_.patches[part_.patch[k]].number};
           for (std::size_t c = 0; c < 3; ++c) face.corner[c] = part_.global_vertex[part_.boundary[k][c]];
           return face;
         })) {
      patch.push_back(f.patch);
      for (const std::int64_t v : f.corner) corners.push_back(static_cast<Index>(v));
    }
    arrays.put(kFaces, 3 * faces.first(round), corners);
    arrays.put(kPatch, faces.first(round), patch);
  }
}

}  // namespace

std::vector<fs::path> write_whole_xdmf(MPI_Comm comm, const fs::path& xdmf, const DistributedMesh& mesh) {
  const std::string name = xdmf.stem();
  const fs::path hdf5 = xdmf.parent_path() / (name + ".h5"), boundary = xdmf.parent_path() / (name + "_boundary.xdmf");
  Writer writer(comm, mesh);
  writer.write(hdf5);
  write_together(comm, xdmf, rank_in(comm) == 0, [&] { write_xdmf(xdmf, writer.shape(), hdf5.filename()); });
  write_together(comm, boundary, rank_in(comm) == 0,
                 [&] { write_boundary_xdmf(boundary, writer.shape(), hdf5.filename()); });
  return {hdf5, xdmf, boundary};
}

}  // namespace umtet
