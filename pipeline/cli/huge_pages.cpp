// Places large blocks of the program's memory in huge pages if the system supports them (madvise(2), Linux): the
// first access to the arrays of a mesh with millions of tets then causes a few page faults instead of thousands.
// docs/performance.md shows the gain. This concerns only the program, so it is not part of a library.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#include <sys/mman.h>

#ifdef MADV_HUGEPAGE

namespace {

constexpr std::uintptr_t kHugePage = std::uintptr_t{1} << 21;
// In a block of this size, at most half of the memory, at both ends, is in small pages.
constexpr std::size_t kLeast = 2 * kHugePage;

void* block_of(std::size_t size) {
  void* block = std::malloc(size > 0 ? size : 1);
  if (!block || size < kLeast) return block;
  const auto begin = reinterpret_cast<std::uintptr_t>(block), first = (begin + kHugePage - 1) / kHugePage * kHugePage;
  const std::uintptr_t end = (begin + size) / kHugePage * kHugePage;
  madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);  // a hint that the system may ignore
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
