#pragma once

#include <cstddef>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Where several processes move the vertices of one layer, each its own (layer_part()). A vertex is moved by what its
/// ring is, and those of one colour share no tet: so places that are passed on after each colour make of all parts what
/// one process makes, however far a change spreads.
class LayerExchange {
 public:
  /// The same in all processes.
  virtual int n_colours() const = 0;
  /// After a colour. Own vertices of this colour that another process has in its layer are where V says: their places
  /// go there, and the places of those of others come into V. Marks in `queued` of vertices of others go to them and
  /// are cleared, marks for own ones are set. Called by all processes, as sum().
  virtual void after(int colour, std::vector<Vec3>& V, std::vector<unsigned char>& queued) = 0;
  /// Over all processes.
  virtual std::size_t sum(std::size_t n) = 0;

 protected:
  ~LayerExchange() = default;
};

}  // namespace umtet
