#pragma once

#include <filesystem>

#include "pipeline/case/parameters.h"

namespace umtet {

/// Returns the maximum memory of a stage in bytes: output.max_memory, or the amount that the system can provide.
double allowed_bytes(const Parameters& parameters);

/// Limits the memory of the process to `bytes`: larger requests throw std::bad_alloc.
/// @param threads  number of threads whose stacks are not counted
void limit_memory(double bytes, int threads);

/// Checks, before a mesh is made, that the disk has room for its files.
/// @param folder  exists
/// @param n_tets  approximate number of tets in all files together
/// \throw ResourceLimit  the estimate, which the message contains, exceeds the free space
void require_disk(const std::filesystem::path& folder, double n_tets);

}  // namespace umtet
