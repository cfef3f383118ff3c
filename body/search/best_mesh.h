#pragma once

#include "body/body.h"
#include "body/options.h"
#include "body/search/mesh_attempts.h"
#include "body/search/part_maker.h"
#include "common/context.h"

namespace umtet {

/// Meshes a domain with the background, edge lengths and attempts that the options ask for: BackgroundChoice and
/// MeshMaker::best(). The vertices are in working coordinates.
/// @param domain   takes MeshOptions::complement from the options
/// @param allowed  bytes that the mesh may take
/// @param ranks    make the mesh, where several processes do; null: this one does
/// @return the best attempt. A mesh whose certificate fails is a result; so is none.
/// \throw MeshingImpossible, ResourceLimit, UsageError, Cancelled, and what the functions of the options throw
/// Reports "size" and the steps of MeshMaker.
MeshAttempt best_mesh(Domain& domain, const BodyOptions& options, double allowed, const Context& context = {},
                      PartMaker* ranks = nullptr);

}  // namespace umtet
