#pragma once

#include <cstdlib>  // __GLIBC__
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace umtet {

/// Returns unused heap pages to the system. The program normally keeps them, because touching them again costs time
/// (keep_freed_memory()). But several ranks share a machine, and one rank may need the memory that another has freed.
inline void give_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace umtet
