#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#define UMTET_PCL_API __attribute__((visibility("default")))

// From samples of a surface to tets, in memory: what umtet_pcl exports. Plain types alone cross its border: those of
// Eigen and PCL are laid out and freed as the flags of each side say. C++17.
namespace umtet {

struct MeshObject;

using Coordinates = std::vector<std::array<double, 3>>;

/// Samples of a surface. All lengths are in one unit, the model's.
struct ScannedCloud {
  Coordinates points;
  Coordinates normals;     ///< out of the body, of any length; none where all are missing, zero or NaN where one is
  Coordinates viewpoints;  ///< where the sensor stood that saw a point; none where all are unknown, NaN where one is
  std::size_t n_not_finite = 0;  ///< points that were left out for not being finite

  /// Another view of the same surface, in the same coordinates.
  ScannedCloud& operator+=(const ScannedCloud& view);
};

/// How a mesh is made.
struct CloudMeshOptions {
  double h = 0;  ///< edge length, model units; 0: as size, thin parts and noise of the samples ask for
  /// More parameters with their values as `umtet run --set` takes them, such as {"mesh.tets", "20000"} or
  /// {"cloud.normals", "estimate"}: docs/reference.md.
  std::vector<std::pair<std::string, std::string>> set{};
  int threads = 0;  ///< 0: all that the machine has. The mesh does not depend on it
  /// Called by the thread that made the call with the step and its part in [0, 1] that is done; false ends the call.
  std::function<bool(const char* step, double fraction)> progress{};
};

/// A tet mesh whose boundary is psi = 0, and what is certified of it.
struct CloudMesh {
  Coordinates points;                        ///< vertices; of a mesh of second order the corners
  std::vector<std::array<int, 4>> tets;      ///< of points; positive volumes
  std::vector<std::array<int, 3>> boundary;  ///< triangles of points, counter-clockwise from outside
  std::vector<int> boundary_vertices;        ///< ascending
  Coordinates boundary_normals;              ///< of boundary_vertices: grad psi, unit, outward
  ScannedCloud samples;    ///< what psi was fitted to: cleaned, sorted in space, each with a unit normal; no viewpoints
  double h = 0;            ///< edge length of the background mesh, model units
  double min_quality = 0;  ///< least mean ratio of a tet, in (0, 1]; 1 is regular
  bool is_valid = false;   ///< positive tets, and a boundary that is a closed manifold without self-intersections
  bool fits_psi = false;                   ///< it is psi = 0 as far as h can show it
  bool fits_input = false;                 ///< it fits the cloud
  bool passes = false;                     ///< the verdict of the certificate
  std::string certificate;                 ///< JSON, as certificate.json: docs/reference.md
  std::vector<std::string> notices;        ///< what was changed or guessed
  std::shared_ptr<const MeshObject> made;  ///< for save()

  /// @param file  .vtu, .msh, .mesh, or .stl of the boundary
  /// \throw std::invalid_argument for another suffix; std::system_error naming the file
  UMTET_PCL_API void save(const std::string& file) const;
};

/// No mesh can be made of this cloud.
struct UMTET_PCL_API CloudMeshError : std::runtime_error {
  CloudMeshError(const std::string& message, std::string evidence)
      : std::runtime_error(message), evidence(std::move(evidence)) {}
  std::string evidence;  ///< JSON: "status", and the places and lengths that it is about
};

/// Cleans the cloud, gives each sample an outward normal, fits psi and meshes {psi < 0}: the mesh that `umtet run`
/// makes of a file with these samples.
///
/// Normals that are given win over viewpoints, and a minority that is turned over is turned back. Where there are none,
/// they are estimated and look to the viewpoints of their points. A mesh whose certificate fails is returned, too.
///
/// \throw CloudMeshError  samples that are no surface or bound no body, no mesh at this h, too little memory, or
///        options.progress has ended it
/// \throw std::invalid_argument  a parameter that is not known, or not of its range; normals or viewpoints, but not as
///        many as points; a point that is not finite
UMTET_PCL_API CloudMesh mesh_cloud(const ScannedCloud& cloud, const CloudMeshOptions& options = {});

inline ScannedCloud& ScannedCloud::operator+=(const ScannedCloud& view) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::size_t n = points.size();
  const auto join = [&](Coordinates& ours, const Coordinates& theirs) {
    if (ours.empty() && theirs.empty()) return;
    ours.resize(n, {kNaN, kNaN, kNaN});
    ours.insert(ours.end(), theirs.begin(), theirs.end());
    ours.resize(n + view.points.size(), {kNaN, kNaN, kNaN});
  };
  join(normals, view.normals);
  join(viewpoints, view.viewpoints);
  points.insert(points.end(), view.points.begin(), view.points.end());
  n_not_finite += view.n_not_finite;
  return *this;
}

}  // namespace umtet
