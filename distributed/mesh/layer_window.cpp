#include "distributed/mesh/layer_window.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "distributed/exchange/collect.h"

namespace umtet {
namespace {

constexpr std::int64_t kCells = BlockCurve::kCells;

/// Index of a cell in its block.
std::int64_t number_in_block(const BackgroundMesh::Cell& cell) {
  return (cell[0] + 1) % kCells + kCells * ((cell[1] + 1) % kCells + kCells * ((cell[2] + 1) % kCells));
}

}  // namespace

template <class T>
LayerWindow::Open<T> LayerWindow::opened(std::vector<T> list) const {
  Open<T> open;
  if (partition_.n_ranks() == 1) {  // Open MPI does not support a window of a single rank
    open.alone = std::move(list);
    open.own = open.alone.data();
    return open;
  }
  // MPI allocates the window, which is shared memory on one machine.
  MPI_Win_allocate(static_cast<MPI_Aint>(list.size() * sizeof(T)), sizeof(T), MPI_INFO_NULL, comm_, &open.own,
                   &open.window);
  std::copy(list.begin(), list.end(), open.own);
  MPI_Barrier(comm_);  // before any rank reads
  MPI_Win_lock_all(0, open.window);
  return open;
}

template <class T>
void LayerWindow::close(Open<T>& open) const {
  if (open.window == MPI_WIN_NULL) return;
  MPI_Win_unlock_all(open.window);
  MPI_Win_free(&open.window);
}

LayerWindow::LayerWindow(MPI_Comm comm, const LatticePart& part, const Partition& partition, const IdSet& inside,
                         const Places& places)
    : comm_(comm), part_(part), partition_(partition), rank_(rank_in(comm)) {
  std::vector<std::uint64_t> headers;
  std::vector<Entry> entries;
  list_own(inside, places, headers, entries);
  headers_ = opened(std::move(headers));
  entries_ = opened(std::move(entries));
}

LayerWindow::~LayerWindow() {
  if (unwinding_) return;
  close(headers_);
  close(entries_);
}

void LayerWindow::list_own(const IdSet& inside, const Places& places, std::vector<std::uint64_t>& headers,
                           std::vector<Entry>& entries) const {
  const std::uint64_t begin = partition_.begin(rank_);
  headers.assign((partition_.end(rank_) - begin) * n_words(), 0);
  const auto header_of = [&](const BackgroundMesh::Cell& cell) {
    return &headers[(BlockCurve::place(BlockCurve::block_of(cell)) - begin) * n_words()];
  };
  part_.own().for_each([&](std::int64_t v) {
    if (!inside.test(v)) return;
    const std::int64_t there = part_.to_whole(v);
    const BackgroundMesh::Cell cell = part_.whole().cell(there);
    header_of(cell)[2 + part_.whole().type(there)] |= std::uint64_t{1} << number_in_block(cell);
  });
  for (const auto& [v, x] : places) entries.push_back({part_.to_whole(v), {x[0], x[1], x[2]}});
  const auto block_of = [&](const Entry& e) {
    return BlockCurve::place(BlockCurve::block_of(part_.whole().cell(e.vertex)));
  };
  std::stable_sort(entries.begin(), entries.end(),
                   [&](const Entry& a, const Entry& b) { return block_of(a) < block_of(b); });
  for (std::size_t k = 0; k < entries.size(); ++k) {
    std::uint64_t* header = header_of(part_.whole().cell(entries[k].vertex));
    if (header[1]++ == 0) header[0] = k;
  }
}

/// Reads pieces into consecutive memory.
template <class T>
std::vector<T> LayerWindow::read(const Open<T>& open, const std::vector<Piece>& pieces) {
  std::size_t n = 0;
  for (const Piece& piece : pieces) n += piece.n;
  std::vector<T> list(n);
  T* to = list.data();
  for (const Piece& piece : pieces) {
    const std::size_t size = piece.n * sizeof(T);
    if (piece.rank == rank_) {
      std::copy_n(open.own + piece.first, piece.n, to);
    } else if (piece.n > 0) {
      MPI_Get(to, static_cast<int>(size), MPI_BYTE, piece.rank, static_cast<MPI_Aint>(piece.first),
              static_cast<int>(size), MPI_BYTE, open.window);
      ++n_gets_;
      bytes_ += size;
    }
    to += piece.n;
  }
  if (open.window != MPI_WIN_NULL) MPI_Win_flush_all(open.window);
  return list;
}

/// Appends the vertices that a header and its entries describe.
void LayerWindow::add(const BlockCurve::Block& block, const std::uint64_t* header, const Entry* entries,
                      std::vector<LayerVertex>& list) const {
  const BackgroundMesh& whole = part_.whole();
  const auto before = static_cast<std::ptrdiff_t>(list.size());
  for (int type = 0; type < whole.n_types(); ++type) {
    for (std::uint64_t bits = header[2 + type]; bits != 0; bits &= bits - 1) {
      const std::int64_t c = std::countr_zero(bits);
      const std::int64_t v =
          whole.vertex_id(type, {block[0] * kCells - 1 + c % kCells, block[1] * kCells - 1 + c / kCells % kCells,
                                 block[2] * kCells - 1 + c / (kCells * kCells)});
      list.push_back({v, true, whole.position(v)});
    }
  }
  const auto is_less = [](const LayerVertex& a, const LayerVertex& b) { return a.vertex < b.vertex; };
  std::sort(list.begin() + before, list.end(), is_less);
  const auto n_inside = static_cast<std::ptrdiff_t>(list.size());
  for (const Entry* e = entries; e != entries + header[1]; ++e) {
    const LayerVertex vertex{e->vertex, false, Vec3(e->place[0], e->place[1], e->place[2])};
    const auto end = list.begin() + n_inside, found = std::lower_bound(list.begin() + before, end, vertex, is_less);
    if (found != end && found->vertex == vertex.vertex) {
      found->place = vertex.place;
    } else {
      list.push_back(vertex);
    }
  }
}

std::vector<LayerVertex> LayerWindow::get(const std::vector<BlockCurve::Block>& blocks) {
  std::vector<Piece> pieces;
  for (const BlockCurve::Block& block : blocks) {
    const int owner = partition_.owner(block);
    const std::uint64_t place = BlockCurve::place(block) - partition_.begin(owner);
    pieces.push_back({owner, place * n_words(), n_words()});
  }
  const std::vector<std::uint64_t> headers = read(headers_, pieces);
  for (std::size_t k = 0; k < blocks.size(); ++k)
    pieces[k] = {pieces[k].rank, headers[k * n_words()], headers[k * n_words() + 1]};
  const std::vector<Entry> entries = read(entries_, pieces);
  std::vector<LayerVertex> list;
  const Entry* at = entries.data();
  for (std::size_t k = 0; k < blocks.size(); at += pieces[k++].n) add(blocks[k], &headers[k * n_words()], at, list);
  return list;
}

template <class F>
void BlocksAround::for_each_block(std::int64_t vertex, const F& f) const {
  const BackgroundMesh::Cell cell = whole_.cell(vertex);
  BackgroundMesh::Cell low = cell, high = cell;
  for (int a = 0; a < 3; ++a) {
    low[a] = std::max<std::int64_t>(-1, cell[a] - cells_);
    high[a] = std::min(whole_.n_cells()[a], cell[a] + cells_);
  }
  const BlockCurve::Block first = BlockCurve::block_of(low), last = BlockCurve::block_of(high);
  for (std::int64_t k = first[2]; k <= last[2]; ++k) {
    for (std::int64_t j = first[1]; j <= last[1]; ++j) {
      for (std::int64_t i = first[0]; i <= last[0]; ++i) f(BlockCurve::Block{i, j, k});
    }
  }
}

std::vector<LayerVertex> BlocksAround::operator()(std::int64_t vertex) {
  std::vector<BlockCurve::Block> blocks;
  for_each_block(vertex, [&](const BlockCurve::Block& block) {
    if (given_.insert(BlockCurve::place(block)).second) blocks.push_back(block);
  });
  return window_.get(blocks);
}

bool BlocksAround::has_given(std::int64_t vertex) const {
  bool all = true;
  for_each_block(vertex, [&](const BlockCurve::Block& block) { all &= given_.count(BlockCurve::place(block)) != 0; });
  return all;
}

}  // namespace umtet
