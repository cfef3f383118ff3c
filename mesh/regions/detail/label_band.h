#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"
#include "mesh/base/id_set.h"
#include "mesh/regions/detail/periodic_cells.h"
#include "mesh/regions/region_domain.h"

namespace umtet::detail {

/// The region of every background vertex; 0 for ids without a vertex. @param n_evaluations  is increased
std::vector<std::uint8_t> regions_of_vertices(const RegionDomain& domain, const BackgroundMesh& background,
                                              std::size_t& n_evaluations, const Context& context);

/// The background vertices within four rings of an edge between two regions, by rank.
class LabelBand {
 public:
  /// @param of_vertex  regions_of_vertices()
  /// @param reach      in edges: only vertices this near to a sheet may change
  /// @param cells      null, or the cells of a torus: the band then consists of representatives
  LabelBand(const RegionDomain& domain, const BackgroundMesh& background, const VertexLinks& links,
            const std::vector<std::uint8_t>& of_vertex, double reach, const PeriodicCells* cells,
            const Context& context);

  std::size_t size() const { return ids_.size(); }
  std::int64_t id(std::size_t v) const { return ids_[v]; }
  Vec3 position(int v) const { return background_.position(ids_[static_cast<std::size_t>(v)]); }
  /// From the representative of link vertex k of v to the link vertex itself; 0 but on a torus.
  Vec3 to_copy(int v, int k) const;
  double h(int v) const { return background_.h(ids_[static_cast<std::size_t>(v)]); }
  const LinkTopology& topology(int v) const { return links_.of_type(type_[v]); }
  /// The neighbours of v: their rank, or a code for label_beyond() of one that is not in the band.
  std::span<const int> link(int v) const {
    return {codes_.data() + first_[v], static_cast<std::size_t>(first_[v + 1] - first_[v])};
  }
  static std::uint8_t label_beyond(int code) { return static_cast<std::uint8_t>(-1 - code); }
  std::uint8_t label_at(int code) const { return code >= 0 ? label[code] : label_beyond(code); }
  /// Distance of v from the sheet between two regions, in edges, negative in the greater one; far away where one of
  /// them is not near v.
  double distance(int v, int a, int b) const;
  /// Sets the labels to those of shrunk regions: a greater region begins this distance inside its sheet.
  void shrink(double shift);

  std::size_t n_psi_evaluations() const { return n_evaluations_; }
  bool leaves_background() const { return leaves_background_; }

  std::vector<std::uint8_t> label;
  std::vector<std::uint8_t> is_movable;

 private:
  struct PatchDistance {
    int patch;
    double distance;
  };
  std::int64_t representative(std::int64_t v) const { return cells_ ? cells_->representative(v) : v; }
  void gather(const std::vector<std::uint8_t>& of_vertex);
  void list_links(const std::vector<std::uint8_t>& of_vertex);
  void find_near();
  void measure(double reach, const Context& context);

  const RegionDomain& domain_;
  const BackgroundMesh& background_;
  const VertexLinks& links_;
  const PeriodicCells* cells_;
  IdSet band_;
  std::vector<std::int64_t> ids_;
  std::vector<int> type_, codes_;
  std::vector<std::size_t> first_;
  std::vector<std::uint8_t> is_complete_;  ///< the whole link consists of vertices
  std::vector<RegionSet> near_;            ///< regions of the vertices within two rings
  std::vector<std::vector<PatchDistance>> distances_;
  std::size_t n_evaluations_ = 0;
  bool leaves_background_ = false;
};

}  // namespace umtet::detail
