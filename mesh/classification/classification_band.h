#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/background/link_topology.h"
#include "mesh/background/vertex_links.h"
#include "mesh/base/id_set.h"
#include "mesh/classification/classification.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/psi_values.h"

namespace umtet {

/// Narrow band of vertices within three edges of an edge between inside and outside, with all data of
/// classify_vertices() about them, by rank.
class ClassificationBand {
 public:
  struct Block {
    std::uint32_t begin, end;  ///< into order
  };

  /// @param inside  the vertices with psi < 0
  /// @param known   psi at all vertices with a neighbour on the other side, or null
  /// @param part    restricts the band to a part of the vertices; null: all
  /// \throw Cancelled
  ClassificationBand(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                     const ClassificationParams& params, const IdSet& inside, const Context& context,
                     const PsiValues* known = nullptr, const ClassificationPart* part = nullptr);

  std::size_t size() const { return id.size(); }

  std::vector<std::int64_t> id;  ///< ascending
  /// Ranks of the neighbours of v; -1 for neighbours that are not in the band.
  std::span<const int> link(std::size_t v) const { return {ranks_.data() + first_[v], first_[v + 1] - first_[v]}; }
  /// The rank of a vertex; -1 if it is not in the band.
  int find(std::int64_t v) const { return band_.test_any(v) ? band_.rank(v) : -1; }
  std::vector<int> type;
  std::vector<std::uint8_t> is_inside;
  std::vector<std::uint8_t> movable;  ///< may be flipped
  std::vector<std::uint8_t> held;     ///< may not be flipped because of most_stretch
  std::vector<LinkMask> mask;
  std::vector<float> phi;            ///< signed distance in LinkTopology::unit
  std::vector<Vec3> foot, normal;    ///< foot point on psi = 0 and normal there; not set at the band's edge
  std::vector<std::uint32_t> order;  ///< vertices that may be flipped, block by block
  /// Per colour. Vertices of two blocks of one colour are nine rings apart. Without cells there is one block.
  std::array<std::vector<Block>, 8> blocks;
  std::size_t psi_evaluations = 0;

 private:
  void gather();
  void gather_around(std::vector<std::int64_t> front);
  bool find_link(std::size_t v);
  double value_at(std::size_t v, const Vec3& x, Vec3& gradient, std::size_t& n_evaluations);
  void find_foot(std::size_t v, std::size_t& n_evaluations);
  void measure(const Context& context);
  bool has_foot(int v) const;
  void hold_where_stretched(const Context& context);
  void make_blocks();
  bool is_outermost(std::int64_t id) const;
  bool is_visited(std::size_t v) const { return movable[v] != 0 && (!part_ || part_->owns(id[v])); }
  double unit(std::size_t v) const { return links_.of_type(type[v]).unit * background_.h(); }
  /// An upper bound on the distance of any vertex that may change, in units.
  float far() const { return static_cast<float>(params_.reach_in + params_.reach_out + 1); }

  const BackgroundMesh& background_;
  const VertexLinks& links_;
  ImplicitFunctionRef psi_;
  const ClassificationParams& params_;
  const IdSet& inside_;
  const PsiValues* known_;
  const ClassificationPart* part_;
  IdSet band_;
  std::vector<int> known_at_;       ///< index of each vertex in known_, or -1; empty without known_
  std::vector<std::size_t> first_;  ///< offsets into ranks_
  std::vector<int> ranks_;
};

}  // namespace umtet
