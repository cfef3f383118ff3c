#include "distributed/mesh/shared_layer.h"

#include <algorithm>
#include <stdexcept>

namespace umtet {

SharedLayer::SharedLayer(const LatticePart& part, Neighbourhood& ranks, const BackgroundLayer& layer,
                         const IdSet& movable)
    : ranks_(ranks), shared_(ranks.ranks().size()) {
  const auto& ids = layer.background_vertex;
  const auto& colour = layer.layer.colour;
  std::size_t most = 0;
  std::vector<std::vector<int>> theirs(shared_.size());
  std::vector<Neighbourhood::Bytes> asked(shared_.size());
  for (std::size_t v = 0; v < ids.size(); ++v) {
    if (!movable.test(ids[v])) continue;
    most = std::max(most, static_cast<std::size_t>(colour[v]) + 1);
    if (part.own().test(ids[v])) continue;
    const std::size_t neighbour = ranks.number(part.owner(ids[v]));
    theirs[neighbour].push_back(static_cast<int>(v));
    put(asked[neighbour], part.to_whole(ids[v]));
  }
  n_colours_ = static_cast<int>(ranks.max(most));
  const std::vector<Neighbourhood::Bytes> wanted = ranks.exchange(asked);
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    std::vector<int> own;
    for (std::size_t at = 0; at < wanted[k].size();) {
      const std::int64_t v = part.from_whole(take<std::int64_t>(wanted[k], at));
      const auto found = std::lower_bound(ids.begin(), ids.end(), v);
      if (found == ids.end() || *found != v || layer.layer.role[found - ids.begin()] == ActiveLayer::Role::Fixed)
        throw std::logic_error("a vertex that moves for one rank does not for the one that has it");
      own.push_back(static_cast<int>(found - ids.begin()));
    }
    shared_[k] = {by_colour(own, colour), by_colour(theirs[k], colour)};
  }
}

SharedLayer::List SharedLayer::by_colour(const std::vector<int>& vertices, const std::vector<int>& colour) const {
  List list{vertices, {0}};
  std::stable_sort(list.vertices.begin(), list.vertices.end(), [&](int v, int w) { return colour[v] < colour[w]; });
  for (int c = 0; c < n_colours_; ++c) {
    list.begin.push_back(list.begin.back() +
                         static_cast<std::size_t>(
                             std::count_if(vertices.begin(), vertices.end(), [&](int v) { return colour[v] == c; })));
  }
  return list;
}

void SharedLayer::after(int colour, std::vector<Vec3>& V, std::vector<unsigned char>& queued) {
  const auto c = static_cast<std::size_t>(colour);
  std::vector<Neighbourhood::Bytes> out(shared_.size()), in(shared_.size());
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    const auto& [own, theirs] = shared_[k];
    for (std::size_t i = own.begin[c]; i < own.begin[c + 1]; ++i) {
      for (int a = 0; a < 3; ++a) put(out[k], V[own.vertices[i]][a]);
    }
    for (const int v : theirs.vertices) {
      put(out[k], queued[v]);
      queued[v] = 0;
    }
    in[k].resize(3 * sizeof(double) * (theirs.begin[c + 1] - theirs.begin[c]) + own.vertices.size());
  }
  ranks_.exchange(out, in);
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    const auto& [own, theirs] = shared_[k];
    std::size_t at = 0;
    for (std::size_t i = theirs.begin[c]; i < theirs.begin[c + 1]; ++i) {
      for (int a = 0; a < 3; ++a) V[theirs.vertices[i]][a] = take<double>(in[k], at);
    }
    for (const int v : own.vertices) queued[v] |= take<unsigned char>(in[k], at);
  }
}

}  // namespace umtet
