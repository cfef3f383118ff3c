#pragma once

#include <cstdlib>  // __GLIBC__
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace umtet {

/// Pages of the heap that nothing is in go back to the system. The program keeps them, because to touch them again
/// costs time (keep_freed_memory()); but several ranks share a machine, and what one has freed another needs.
inline void give_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace umtet
