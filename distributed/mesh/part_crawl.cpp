#include "distributed/mesh/part_crawl.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "distributed/exchange/collect.h"
#include "mesh/submesh/assemble_submesh.h"

namespace umtet {

IdSet crawl_part(MPI_Comm comm, const LatticePart& part, ImplicitFunctionRef psi, const std::vector<Vec3>& seeds,
                 std::size_t& n_psi_evaluations) {
  constexpr std::int64_t kWords = 1 << 17;  // a megabyte
  std::optional<IdSet> all;
  if (rank_in(comm) == 0) {
    CrawledVertices crawled = crawl_inside(part.whole(), psi, seeds);
    n_psi_evaluations += crawled.n_psi_evaluations;
    all = std::move(crawled.inside);
  }
  const std::int64_t n_words = (part.whole().n_vertices() + 63) / 64;
  std::vector<std::uint64_t> words;
  std::int64_t begin = 0, end = 0;  // of these words in the whole
  const auto go_on = [&] {
    begin = end;
    end = std::min(begin + kWords, n_words);
    words.resize(static_cast<std::size_t>(end - begin));
    for (std::size_t w = 0; all && w < words.size(); ++w) words[w] = all->word(static_cast<std::size_t>(begin) + w);
    MPI_Bcast(words.data(), static_cast<int>(words.size()), MPI_UINT64_T, 0, comm);
  };
  IdSet inside(part.lattice().n_vertices());
  part.known().for_each([&](std::int64_t v) {  // ids in the whole lattice are also ascending
    const std::int64_t id = part.to_whole(v);
    while (id >= 64 * end) go_on();
    if (words[static_cast<std::size_t>((id >> 6) - begin)] >> (id & 63) & 1) inside.insert(v);
  });
  while (end < n_words) go_on();
  return inside;
}

}  // namespace umtet
