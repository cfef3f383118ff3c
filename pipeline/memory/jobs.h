#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "body/body.h"
#include "body/search/mesh_attempts.h"
#include "pipeline/case/parameters.h"
#include "pipeline/memory/watch.h"
#include "pipeline/meshing/part_mesher.h"
#include "pipeline/reports/certificate_report.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/io/point_cloud_io.h"

// The steps of `umtet run` in memory: without a case folder, signal handlers or output.
namespace umtet {

/// There is no mesh of this domain at this h. The evidence consists of a status, positions and lengths.
struct MeshingFailed : std::runtime_error {
  MeshingFailed(const std::string& message, Json evidence)
      : std::runtime_error(message), evidence(std::move(evidence)) {}
  Json evidence;
};

/// psi of a cloud, with its samples and a report on the fit.
struct Reconstruction {
  LevelSet psi;              ///< near the origin: coordinates of the model minus the shift of the report
  OrientedPointCloud cloud;  ///< the samples, model coordinates
  LevelSetReport report;
  InputFacts facts;              ///< facts about the normals
  std::vector<Message> notices;  ///< changes and guesses that the user should know about
};

/// Cleans the cloud, orients its normals and fits psi, with the sections `cloud` and `reconstruct` of the parameters.
/// @param file  result of given_cloud(). Zero normals count as missing. Without normals, all are estimated.
/// \throw UsageError, CloudRefused, SolveError, SolveTooLarge, and the exceptions of `watch`
Reconstruction reconstruct(CloudFile file, const Parameters& parameters, const Watch& watch);

/// Returns the domain for make_mesh(). @param box  box that the background mesh must cover, model coordinates; none:
/// the box of psi
Domain domain_of(const Reconstruction& reconstruction, const std::optional<Box>& box);

/// Meshes {psi < 0} and measures the mesh. If h is chosen automatically, h is reduced where the mesh requires it. The
/// vertices are in working coordinates (Domain::shift). A mesh whose certificate fails is also returned. With
/// mesh.order = 2, the result contains `second`, and the certificate covers it, too.
/// @param ranks  several processes that make the mesh; the result then contains `parts`
/// \throw MeshingFailed (also if the body is too thin to have a vertex inside), MeshingImpossible, ResourceLimit,
///   UsageError, and the exceptions of `watch`
MeshAttempt make_mesh(Domain& domain, const Parameters& parameters, const Watch& watch, PartMesher* ranks = nullptr);

/// Returns the measurements of a mesh of the domain, by measure(), with their verdict. \throw the exceptions of `watch`
Certificate certificate_of(const Domain& domain, const UmResult& result, double h, const Parameters& parameters,
                           const Watch& watch);

/// Returns the error for a status other than Success.
MeshingFailed failure(const UmResult& result, double h, const Vec3& shift);

}  // namespace umtet
