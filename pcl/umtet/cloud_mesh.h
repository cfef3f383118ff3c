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

// From samples of a surface to tets, in memory: the interface exported by umtet_pcl. Only plain types cross it, because
// the layout and deallocation of Eigen's and PCL's types depend on the compiler flags of each side. C++17.
namespace umtet {

struct MeshObject;

using Coordinates = std::vector<std::array<double, 3>>;

/// Samples of a surface. All lengths are in the unit of the model.
struct ScannedCloud {
  Coordinates points;
  /// Outward normals of any length; empty if there are none, zero or NaN where a normal is missing.
  Coordinates normals;
  /// Position of the sensor that saw each point; empty if all are unknown, NaN if one is unknown.
  Coordinates viewpoints;
  std::size_t n_not_finite = 0;  ///< points dropped because they are not finite

  /// Appends another view of the same surface, in the same coordinates.
  ScannedCloud& operator+=(const ScannedCloud& view);
};

/// Options of mesh_cloud().
struct CloudMeshOptions {
  double h = 0;  ///< edge length, model units; 0: chosen from size, thin parts and noise of the samples
  /// Additional parameters with their values, as for `umtet run --set`, such as {"mesh.tets", "20000"} or
  /// {"cloud.normals", "estimate"}: docs/reference.md.
  std::vector<std::pair<std::string, std::string>> set{};
  int threads = 0;  ///< 0: all hardware threads. The mesh does not depend on it
  /// Called by the calling thread with the step and its completed fraction in [0, 1]; false ends the call.
  std::function<bool(const char* step, double fraction)> progress{};
};

/// A tet mesh whose boundary is psi = 0, with its certificate.
struct CloudMesh {
  Coordinates points;                        ///< vertices; the corners of a ten-node mesh
  std::vector<std::array<int, 4>> tets;      ///< indices into points; positive volumes
  std::vector<std::array<int, 3>> boundary;  ///< triangles, indices into points, counter-clockwise from outside
  std::vector<int> boundary_vertices;        ///< ascending
  Coordinates boundary_normals;              ///< at boundary_vertices: grad psi, unit, outward
  ScannedCloud samples;     ///< the samples of the fit: cleaned, sorted in space, with unit normals; no viewpoints
  double h = 0;             ///< edge length of the background mesh, model units
  double min_quality = 0;   ///< least mean ratio of a tet, in (0, 1]; 1 is regular
  bool is_valid = false;    ///< positive tets, and a boundary that is a closed manifold without self-intersections
  bool fits_psi = false;    ///< the boundary is psi = 0 within the resolution of h
  bool fits_input = false;  ///< the boundary fits the cloud
  bool passes = false;      ///< the verdict of the certificate
  std::string certificate;  ///< JSON, as certificate.json: docs/reference.md
  std::vector<std::string> notices;        ///< changes and guesses
  std::shared_ptr<const MeshObject> made;  ///< for save()

  /// Saves the mesh. @param file  .vtu, .msh, .mesh, or .stl for the boundary
  /// \throw std::invalid_argument for another suffix; std::system_error naming the file
  UMTET_PCL_API void save(const std::string& file) const;
};

/// Error for a cloud that cannot be meshed.
struct UMTET_PCL_API CloudMeshError : std::runtime_error {
  CloudMeshError(const std::string& message, std::string evidence)
      : std::runtime_error(message), evidence(std::move(evidence)) {}
  std::string evidence;  ///< JSON: "status", with the relevant positions and lengths
};

/// Meshes the body of a point cloud: cleans the cloud, gives each sample an outward normal, fits psi and meshes {psi <
/// 0}. The mesh equals the one that `umtet run` makes of a file with these samples.
///
/// Given normals take precedence over viewpoints, and a minority that is turned over is corrected. Missing normals are
/// estimated and oriented towards the viewpoints of their points. A mesh whose certificate fails is returned, too.
///
/// \throw CloudMeshError if the samples are not a surface or bound no body, there is no mesh at this h, there is too
///        little memory, or options.progress has ended the call
/// \throw std::invalid_argument for a parameter that is unknown or out of range, if the numbers of points and normals
///        or viewpoints differ, or for a point that is not finite
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
