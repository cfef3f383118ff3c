#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace umtet {

/// The state of a vertex while a classification is sought.
struct VertexState {
  std::int64_t vertex;
  std::uint8_t is_inside;
  std::uint8_t open;  ///< what is still to be tried there
};

/// What classify_vertices() needs to know where several processes classify the vertices of one background, each those
/// of its own blocks of 4^3 cells. Blocks of one colour are nine rings apart and a block reads and writes three rings
/// around it: so states that are passed on after each colour make of all parts what one process makes.
class ClassificationPart {
 public:
  /// Its state is true here. Of vertices that are not known nothing follows, least of all that psi changes sign.
  virtual bool knows(std::int64_t vertex) const = 0;
  /// Only these are tried here: known, with eight rings of known vertices around.
  virtual bool owns(std::int64_t vertex) const = 0;
  /// Another process knows it, too.
  virtual bool shares(std::int64_t vertex) const = 0;
  /// Gives away states that have changed here since the last call and returns those that have changed elsewhere. Called
  /// by all processes, as sum().
  virtual std::vector<VertexState> exchange(const std::vector<VertexState>& changed) = 0;
  /// Over all processes.
  virtual std::size_t sum(std::size_t n) = 0;

 protected:
  ~ClassificationPart() = default;
};

}  // namespace umtet
