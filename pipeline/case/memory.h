#pragma once

#include <filesystem>

#include "pipeline/case/parameters.h"

namespace umtet {

/// Bytes that a stage may take: output.max_memory, or what the system says it can give.
double allowed_bytes(const Parameters& parameters);

/// From now on, no more than `bytes` can be allocated: beyond that there is std::bad_alloc.
/// @param threads  whose stacks are not counted
void limit_memory(double bytes, int threads);

/// To call before a mesh is made: is there room for its files?
/// @param folder  that exists
/// @param n_tets  about how many tets all files together have
/// \throw ResourceLimit with the estimate, when it is more than the disk has
void require_disk(const std::filesystem::path& folder, double n_tets);

}  // namespace umtet
