#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace umtet {

/// State of a vertex during a classification.
struct VertexState {
  std::int64_t vertex;
  std::uint8_t is_inside;
  std::uint8_t open;  ///< moves still to be tried there
};

/// Interface for classify_vertices() when several processes classify the vertices of one background, each in its own
/// blocks of 4^3 cells.
///
/// Blocks of one colour are nine rings apart, and a block reads and writes three rings around it. If states are
/// exchanged after each colour, the parts together make the same classification as one process.
class ClassificationPart {
 public:
  /// True if the state of the vertex is valid here. An unknown vertex implies nothing, in particular no change of sign
  /// of psi.
  virtual bool knows(std::int64_t vertex) const = 0;
  /// True if the vertex may be tried here: it is known, and so are eight rings around it.
  virtual bool owns(std::int64_t vertex) const = 0;
  /// True if another process knows the vertex, too.
  virtual bool shares(std::int64_t vertex) const = 0;
  /// Sends states that have changed here since the last call, and returns those that have changed elsewhere.
  /// Collective, as sum().
  virtual std::vector<VertexState> exchange(const std::vector<VertexState>& changed) = 0;
  /// Sum over all processes.
  virtual std::size_t sum(std::size_t n) = 0;

 protected:
  ~ClassificationPart() = default;
};

}  // namespace umtet
