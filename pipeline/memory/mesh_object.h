#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/certify/quadratic_tets.h"
#include "mesh/universal_mesh.h"
#include "pipeline/case/parameters.h"
#include "body/body.h"
#include "body/search/mesh_attempts.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// A mesh with what it takes to write and to judge it.
struct MeshObject {
  Domain domain;  ///< its shift and samples; no psi
  UmResult result;
  std::optional<SecondOrder> second;  ///< the same with mid-sides, if mesh.order = 2
  double h = 0;
  std::optional<Certificate> certificate;  ///< none where it was not asked for

  const std::vector<Vec3>& nodes() const { return second ? second->mesh.V : result.final; }
  /// Those on psi = 0, ascending.
  std::vector<int> boundary_nodes() const;
  /// By node; -1 of mid-sides.
  std::vector<std::int64_t> background_vertices() const;
  /// The faces on psi = 0, counter-clockwise from outside. \pre second
  std::vector<QuadraticTriangle> curved_boundary() const;
  /// Nodes of the boundary faces by patch, 3 or 6 a face, as `umtet export` divides them (divide_boundary()).
  /// \throw UsageError
  std::vector<std::pair<std::string, std::vector<int>>> patches(const Parameters& parameters) const;
  /// \throw std::invalid_argument for a suffix that is not known; std::system_error naming the file
  void save(const std::filesystem::path& file) const;
};

/// What a mesh object keeps of the domain.
Domain without_psi(Domain&& domain);

/// Of make_mesh() and the same domain.
MeshObject mesh_object(Domain&& domain, MeshAttempt&& made, const Parameters& parameters);

}  // namespace umtet
