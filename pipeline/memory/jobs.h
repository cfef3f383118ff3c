#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "pipeline/case/parameters.h"
#include "body/body.h"
#include "pipeline/memory/watch.h"
#include "body/search/mesh_attempts.h"
#include "pipeline/meshing/part_mesher.h"
#include "pipeline/reports/certificate_report.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/io/point_cloud_io.h"

// What `umtet run` does, from memory to memory: no case folder, no signal handlers, nothing printed.
namespace umtet {

/// No mesh of this domain at this h. The evidence is a status, places and lengths.
struct MeshingFailed : std::runtime_error {
  MeshingFailed(const std::string& message, Json evidence)
      : std::runtime_error(message), evidence(std::move(evidence)) {}
  Json evidence;
};

/// psi of a cloud with its samples, and how it was made.
struct Reconstruction {
  LevelSet psi;              ///< near the origin, as the report's shift says
  OrientedPointCloud cloud;  ///< the samples, model coordinates
  LevelSetReport report;
  InputFacts facts;                  ///< of its normals
  std::vector<std::string> notices;  ///< what was changed or guessed, for the user
};

/// Cleans the cloud, orients its normals and fits psi, as the sections `cloud` and `reconstruct` of the parameters say.
/// @param file  of given_cloud(); a zero normal is a missing one, none at all are estimated
/// \throw UsageError, CloudRefused, SolveError, SolveTooLarge, and what `watch` throws
Reconstruction reconstruct(CloudFile file, const Parameters& parameters, const Watch& watch);

/// What make_mesh() takes. @param box  what the background mesh has to cover, model coordinates; none: that of psi
Domain domain_of(const Reconstruction& reconstruction, const std::optional<Box>& box);

/// Meshes {psi < 0} and measures the mesh, with smaller h where the choice of h is left to us and the mesh asks for it.
/// The vertices are in working coordinates (Domain::shift); a mesh whose certificate fails is returned all the same.
/// With mesh.order = 2 it has `second`, and the certificate is about that, too.
/// @param ranks  make the mesh, where several processes do; the result then has `parts`
/// \throw MeshingFailed (also for what is too thin to have a vertex inside), MeshingImpossible, ResourceLimit,
///        UsageError, and what `watch` throws
MeshAttempt make_mesh(Domain& domain, const Parameters& parameters, const Watch& watch, PartMesher* ranks = nullptr);

/// What is true of a mesh of the domain: measure() with its verdict. \throw what `watch` throws
Certificate certificate_of(const Domain& domain, const UmResult& result, double h, const Parameters& parameters,
                           const Watch& watch);

/// What a status other than Success is evidence of.
MeshingFailed failure(const UmResult& result, double h, const Vec3& shift);

}  // namespace umtet
