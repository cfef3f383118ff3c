#include "distributed/mesh/part_classification.h"

namespace umtet {

std::vector<VertexState> PartClassification::exchange(const std::vector<VertexState>& changed) {
  std::vector<Neighbourhood::Bytes> out(ranks_.ranks().size());
  for (const VertexState& state : changed) {
    for (const int rank : part_.knowers(state.vertex)) {
      Neighbourhood::Bytes& message = out[ranks_.number(rank)];
      put(message, part_.to_whole(state.vertex));
      put(message, state.is_inside);
      put(message, state.open);
    }
  }
  std::vector<VertexState> received;
  for (const Neighbourhood::Bytes& message : ranks_.exchange(out)) {
    for (std::size_t at = 0; at < message.size();) {
      const std::int64_t v = part_.from_whole(take<std::int64_t>(message, at));
      const auto is_inside = take<std::uint8_t>(message, at), open = take<std::uint8_t>(message, at);
      if (v >= 0) received.push_back({v, is_inside, open});
    }
  }
  return received;
}

}  // namespace umtet
