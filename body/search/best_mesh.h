#pragma once

#include "body/body.h"
#include "body/options.h"
#include "body/search/mesh_attempts.h"
#include "body/search/part_maker.h"
#include "common/context.h"

namespace umtet {

/// Meshes a domain with the background, edge lengths and attempts that the options specify (BackgroundChoice,
/// MeshMaker::best()). The vertices are in working coordinates.
/// @param domain   receives MeshOptions::complement from the options
/// @param allowed  bytes of memory that the mesh may use
/// @param ranks    makes the mesh in several processes; null: this process makes the mesh
/// @return the best attempt. A mesh whose certificate fails is also returned, and so is an attempt without a mesh.
/// \throw MeshingImpossible, ResourceLimit, UsageError, Cancelled, and any exception of a function in the options
/// Reports "size" and the steps of MeshMaker.
MeshAttempt best_mesh(Domain& domain, const BodyOptions& options, double allowed, const Context& context = {},
                      PartMaker* ranks = nullptr);

}  // namespace umtet
