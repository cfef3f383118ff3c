#pragma once

#include <cstdint>
#include <vector>

#include "distributed/exchange/neighbourhood.h"
#include "distributed/partition/lattice_part.h"
#include "mesh/base/id_set.h"
#include "mesh/fast/smoothing/layer_exchange.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// Exchange of vertex positions between ranks, each of which moves its own vertices.
class SharedLayer final : public LayerExchange {
 public:
  /// Collective.
  /// @param layer    layer_part() of own vertices
  /// @param movable  all vertices that move, within the extent of the layer
  /// \throw std::logic_error if two ranks disagree about which vertices move
  SharedLayer(const LatticePart& part, Neighbourhood& ranks, const BackgroundLayer& layer, const IdSet& movable);

  int n_colours() const override { return n_colours_; }
  void after(int colour, std::vector<Vec3>& V, std::vector<unsigned char>& queued) override;
  std::size_t sum(std::size_t n) override { return ranks_.sum(n); }

 private:
  /// Vertices of the layer in an order common to both sides: by colour, ascending within a colour.
  struct List {
    std::vector<int> vertices;
    std::vector<std::size_t> begin;  ///< begin of each colour
  };
  /// Vertices shared with a neighbour.
  struct Shared {
    List own, theirs;
  };
  List by_colour(const std::vector<int>& vertices, const std::vector<int>& colour) const;

  Neighbourhood& ranks_;
  int n_colours_ = 0;
  std::vector<Shared> shared_;  ///< by neighbour
};

}  // namespace umtet
