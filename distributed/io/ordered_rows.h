#pragma once

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/exchange/id_order.h"
#include "distributed/mesh/distributed_mesh.h"
#include "mesh/certify/quality_report.h"

// Nodes and tets of a whole mesh for files, in the order of their ids, piece by piece, as columns. No rank holds more
// than a piece at a time. All functions are collective.
namespace umtet {

inline constexpr std::size_t kRowsPerPiece = 1 << 16;  // a few megabytes

/// A piece of consecutive nodes.
struct NodeColumns {
  std::size_t first = 0;  ///< number of nodes before it
  std::vector<std::int64_t> id;
  std::vector<std::uint8_t> boundary;
  std::vector<double> places;  ///< three per node
};

/// A piece of consecutive tets with n nodes each.
template <class Index>
struct TetColumns {
  std::size_t first = 0;
  std::vector<std::int64_t> id;
  std::vector<double> quality;  ///< mean ratio
  std::vector<Index> nodes;     ///< n per tet
};

/// Calls put(NodeColumns) for each of this rank's pieces, equally often on all ranks.
/// @param ids  ids of the owned nodes, ascending; `places` and `boundary` are in the same order
template <class Put>
void put_nodes(MPI_Comm comm, const std::vector<std::int64_t>& ids, const std::vector<Vec3>& places,
               const std::vector<std::uint8_t>& boundary, const Put& put) {
  struct Row {
    std::int64_t id;
    double place[3];
    std::uint8_t boundary;
  };
  const IdOrder order(comm, ids, kRowsPerPiece);
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    NodeColumns columns{order.first(round), {}, {}, {}};
    for (const Row& v : order.piece<Row>(round, [&](std::size_t k) {
           return Row{ids[k], {places[k].x(), places[k].y(), places[k].z()}, boundary[k]};
         })) {
      columns.id.push_back(v.id);
      columns.boundary.push_back(v.boundary);
      columns.places.insert(columns.places.end(), v.place, v.place + 3);
    }
    put(columns);
  }
}

/// Calls put(first, values) for each of this rank's pieces, equally often on all ranks. `first` is the number of nodes
/// before the piece, and `values` are n numbers per node.
/// @param values  n numbers per owned node, consecutive
template <std::size_t n, class T, class Put>
void put_values(MPI_Comm comm, const std::vector<std::int64_t>& ids, const std::vector<T>& values, const Put& put) {
  struct Row {
    std::int64_t id;
    std::array<T, n> value;
  };
  const IdOrder order(comm, ids, kRowsPerPiece);
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    std::vector<T> column;
    for (const Row& v : order.piece<Row>(round, [&](std::size_t k) {
           Row row{ids[k], {}};
           std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(n * k), n, row.value.begin());
           return row;
         }))
      column.insert(column.end(), v.value.begin(), v.value.end());
    put(order.first(round), column);
  }
}

/// Calls put(TetColumns<Index>) for each of this rank's pieces, equally often on all ranks.
/// @param node  node(t, k) is the number in the whole mesh of node k of local tet t
template <std::size_t n, class Index, class Node, class Put>
void put_tets(MPI_Comm comm, const DistributedMesh& mesh, const Node& node, const Put& put) {
  struct Row {
    std::int64_t id;
    std::array<std::int64_t, n> node;
    double quality;
  };
  const IdOrder order(comm, mesh.background_tet, kRowsPerPiece);
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    const std::size_t begin = order.begin(round);
    std::vector<double> Q(order.begin(round + 1) - begin);
    measure_mean_ratios(mesh.mesh, Q, begin);
    TetColumns<Index> columns{order.first(round), {}, {}, {}};
    for (const Row& tet : order.piece<Row>(round, [&](std::size_t t) {
           Row row{mesh.background_tet[t], {}, Q[t - begin]};
           for (std::size_t k = 0; k < n; ++k) row.node[k] = node(t, k);
           return row;
         })) {
      columns.id.push_back(tet.id);
      columns.quality.push_back(tet.quality);
      for (const std::int64_t v : tet.node) columns.nodes.push_back(static_cast<Index>(v));
    }
    put(columns);
  }
}

}  // namespace umtet
