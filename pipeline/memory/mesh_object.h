#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/body.h"
#include "body/search/mesh_attempts.h"
#include "mesh/second_order/quadratic_tets.h"
#include "mesh/universal_mesh.h"
#include "pipeline/case/parameters.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// A mesh with the data that are needed to write and to judge it.
struct MeshObject {
  Domain domain;  ///< its shift and samples, without psi
  UmResult result;
  std::optional<SecondOrder> second;  ///< the mesh with mid-sides, if mesh.order = 2
  double h = 0;
  std::optional<Certificate> certificate;  ///< none if it was not requested

  const std::vector<Vec3>& nodes() const { return second ? second->mesh.V : result.final; }
  /// Returns the nodes on psi = 0, ascending.
  std::vector<int> boundary_nodes() const;
  /// Returns the background vertex of each node; -1 for mid-sides.
  std::vector<std::int64_t> background_vertices() const;
  /// Returns the faces on psi = 0, counter-clockwise from outside. \pre second
  std::vector<QuadraticTriangle> curved_boundary() const;
  /// Returns the nodes of the boundary faces by patch, 3 or 6 per face, with the patches of `umtet export`
  /// (divide_boundary()).
  /// \throw UsageError
  std::vector<std::pair<std::string, std::vector<int>>> patches(const Parameters& parameters) const;
  /// \throw std::invalid_argument  unknown suffix; std::system_error  names the file
  void save(const std::filesystem::path& file) const;
};

/// Returns the part of the domain that a mesh object keeps.
Domain without_psi(Domain&& domain);

/// Makes a mesh object from the result of make_mesh() and its domain.
MeshObject mesh_object(Domain&& domain, MeshAttempt&& made, const Parameters& parameters);

}  // namespace umtet
