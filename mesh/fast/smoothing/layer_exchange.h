#pragma once

#include <cstddef>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Exchange between processes that move the vertices of one layer, each its own vertices (layer_part()).
///
/// The move of a vertex depends on its ring only, and vertices of one colour share no tet. If positions are exchanged
/// after each colour, the parts together make the same mesh as one process, however far a change spreads.
class LayerExchange {
 public:
  /// Number of colours, the same in all processes.
  virtual int n_colours() const = 0;
  /// Exchanges positions and queue marks after a colour. Collective, as sum().
  ///
  /// Own vertices of this colour that are in the layer of another process are where V says: their positions are sent,
  /// and the positions of vertices of other processes are received into V. Marks in `queued` at vertices of other
  /// processes are sent and cleared; marks received for own vertices are set.
  virtual void after(int colour, std::vector<Vec3>& V, std::vector<unsigned char>& queued) = 0;
  /// Sum over all processes.
  virtual std::size_t sum(std::size_t n) = 0;

 protected:
  ~LayerExchange() = default;
};

}  // namespace umtet
