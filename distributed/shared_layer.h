#pragma once

#include <cstdint>
#include <vector>

#include "distributed/lattice_part.h"
#include "distributed/neighbourhood.h"
#include "mesh/base/id_set.h"
#include "mesh/fast/layer_exchange.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// Places of vertices between ranks, while each moves its own.
class SharedLayer final : public LayerExchange {
 public:
  /// Collective.
  /// @param layer    layer_part() of own vertices
  /// @param movable  all that move, as far as the layer reaches
  /// \throw std::logic_error where two ranks are not of one mind about which vertices move
  SharedLayer(const LatticePart& part, Neighbourhood& ranks, const BackgroundLayer& layer, const IdSet& movable);

  int n_colours() const override { return n_colours_; }
  void after(int colour, std::vector<Vec3>& V, std::vector<unsigned char>& queued) override;
  std::size_t sum(std::size_t n) override { return ranks_.sum(n); }

 private:
  /// Vertices of the layer, in an order that both sides have: by colour, ascending within one.
  struct List {
    std::vector<int> vertices;
    std::vector<std::size_t> begin;  ///< of each colour
  };
  /// What is shared with one neighbour.
  struct Shared {
    List own, theirs;
  };
  List by_colour(const std::vector<int>& vertices, const std::vector<int>& colour) const;

  Neighbourhood& ranks_;
  int n_colours_ = 0;
  std::vector<Shared> shared_;  ///< by neighbour
};

}  // namespace umtet
