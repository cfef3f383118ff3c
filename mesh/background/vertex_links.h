#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/background/link_steps.h"
#include "mesh/background/link_topology.h"
#include "mesh/base/id_set.h"

namespace umtet {

/// The links of all vertices of a background mesh: their vertices, and their topology as bit masks.
///
/// In a lattice every vertex is of one of a few types, and nothing is stored per vertex. The links of any other
/// background are listed, in about 70 bytes per vertex. Two vertices are there of one type if their links are the same,
/// in the same order and with the same edge length within a percent. Regular parts of a mesh have one type per edge
/// length.
class VertexLinks {
 public:
  /// Links of a lattice. @param of_types  one per vertex type; stored by reference
  VertexLinks(const BackgroundMesh& lattice, const std::vector<LinkTopology>& of_types);
  /// Links of a background that is not a lattice. Cost: some microseconds per vertex, by all threads.
  /// @return null if a vertex has more than kMaxLink neighbours, which do not fit into a mask
  static std::shared_ptr<const VertexLinks> listed(const BackgroundMesh& background);

  bool is_lattice() const { return listed_.type.empty(); }
  int type(std::int64_t v) const { return is_lattice() ? steps_.type(v) : listed_.type[v]; }
  /// The topologies, one per type.
  const std::vector<LinkTopology>& topologies() const { return *topologies_; }
  const LinkTopology& of_type(int type) const { return (*topologies_)[type]; }
  const LinkTopology& at(std::int64_t v) const { return of_type(type(v)); }

  /// Link vertex k of v. In the outermost layer of cells of a lattice it may not be a valid id
  /// (BackgroundMesh::id_step()).
  std::int64_t neighbour(std::int64_t v, int k) const {
    return is_lattice() ? v + steps_.at(v)[k] : listed_.vertices[listed_.begin[v] + static_cast<std::size_t>(k)];
  }
  /// Calls f(w) for the link vertices w of v, in the order of the topology.
  template <class F>
  void for_each(std::int64_t v, const F& f) const {
    if (is_lattice()) {
      for (const std::int64_t step : steps_.at(v)) f(v + step);
    } else {
      for (std::size_t k = listed_.begin[v]; k < listed_.begin[v + 1]; ++k) f(std::int64_t{listed_.vertices[k]});
    }
  }
  /// Bit k is set if link vertex k is inside. Inside vertices are off the background boundary, so a step that leaves
  /// the range of ids of a lattice, or leads to a wrong id in its outermost layer of cells, does not find an inside
  /// vertex.
  LinkMask mask(std::int64_t v, const IdSet& inside) const {
    if (is_lattice()) return steps_.mask(v, inside);
    LinkMask mask = 0;
    int k = 0;
    for_each(v, [&](std::int64_t w) { mask |= static_cast<LinkMask>(inside.test(w)) << k++; });
    return mask;
  }

 private:
  struct Listed {
    std::vector<int> type;           ///< per vertex
    std::vector<std::size_t> begin;  ///< per vertex, into vertices
    std::vector<int> vertices;
    std::vector<LinkTopology> topologies;
  };
  explicit VertexLinks(Listed listed) : listed_(std::move(listed)), topologies_(&listed_.topologies) {}

  LinkSteps steps_;
  Listed listed_;
  const std::vector<LinkTopology>* topologies_;  ///< the caller's, or those in listed_: the object is not movable
 public:
  VertexLinks(const VertexLinks&) = delete;
  VertexLinks& operator=(const VertexLinks&) = delete;
};

}  // namespace umtet
