// Large blocks of the program's memory are in huge pages, where the system has them (madvise(2), Linux): the arrays of
// a mesh of millions of tets are touched for the first time in a few faults instead of thousands. docs/performance.md
// has what that is worth. This is the program's own business, so it is no part of a library.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#include <sys/mman.h>

#ifdef MADV_HUGEPAGE

namespace {

constexpr std::uintptr_t kHugePage = std::uintptr_t{1} << 21;
// At most half of a block of this size, its ends, is in small pages.
constexpr std::size_t kLeast = 2 * kHugePage;

void* block_of(std::size_t size) {
  void* block = std::malloc(size > 0 ? size : 1);
  if (!block || size < kLeast) return block;
  const auto begin = reinterpret_cast<std::uintptr_t>(block), first = (begin + kHugePage - 1) / kHugePage * kHugePage;
  const std::uintptr_t end = (begin + size) / kHugePage * kHugePage;
  madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);  // a wish: without it the pages are small ones
  return block;
}

}  // namespace

void* operator new(std::size_t size) {
  while (true) {
    if (void* block = block_of(size)) return block;
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }

#endif
#endif
