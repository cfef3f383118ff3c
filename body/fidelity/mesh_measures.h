#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "body/fidelity/closed_hole.h"
#include "body/fidelity/mesh_defect.h"
#include "body/fidelity/missed_place.h"
#include "body/input_facts.h"
#include "body/label_report.h"
#include "body/thin_place.h"
#include "mesh/certify/certificate.h"
#include "mesh/second_order/second_order_certificate.h"
#include "reconstruct/triangles/triangle_body.h"

// Measurements of a finished mesh. Lengths are in model units unless a name says otherwise.
namespace umtet {

/// Whether the boundary of a mesh has the pieces and the Euler characteristic of psi = 0.
enum class TopologyProof {
  Same,
  Differs,
  /// The counts differ, but psi = 0 was counted on a grid coarser than the mesh; or the counts agree, but psi = 0 is
  /// somewhere thinner than that grid resolves.
  NotProved,
};

/// How the boundary of the mesh compares with psi = 0 as it was counted on a grid of its own.
struct ZeroSetReport {
  std::optional<double> level_set_spacing;    ///< of the finest lattice of psi; none for a formula
  std::size_t components_of_zero_set = 0;     ///< that the count saw
  long euler_characteristic_of_zero_set = 0;  ///< of all of them together
  long euler_characteristic_of_kept_components = 0;
  std::size_t components_kept = 0;       ///< those that were to be meshed
  int components_meshed = 0;             ///< pieces of the boundary of the mesh, without the walls of a box
  long euler_characteristic_meshed = 0;  ///< of them
  double counting_spacing = 0;           ///< of the grid, model units
  TopologyProof topology = TopologyProof::Same;
  std::optional<Vec3> topology_at;  ///< where to look for the difference, if there is one; model coordinates
  std::vector<std::string> components_dropped;  ///< for each that is not meshed, why
  std::optional<bool> components_proved;        ///< no piece is unseen; none where there is no proof to be had
  std::optional<SupportReport> support;         ///< none for a formula
  double level_shift = 0;  ///< taken off psi, so that the mesh has the volume of the triangles; model units
};

/// Distances of the samples to the boundary of the mesh. That of a merged sample is the rms over those that it was
/// merged of: the root of the squares of its own and of their spread.
struct SampleDistances {
  std::optional<double> noise;  ///< standard deviation of the samples along the normal
  double rms = 0, max = 0;
  double p99 = 0;            ///< 99 % of the samples are nearer
  double missed_beyond = 0;  ///< neither noise nor flat faces explain a distance above it: missed_samples.h
  std::optional<std::size_t> n_merged = {};  ///< how many samples the cloud has been merged of
  std::size_t n_beyond_h = 0;                ///< samples farther from the mesh than h, and than noise explains
  double most_over_h = 0;                    ///< largest distance, in the h of its place
  Vec3 most_at = Vec3::Zero();               ///< the sample with that distance; model coordinates
  std::size_t n_missed_places = 0;
  std::vector<MissedPlace> missed{};  ///< the farthest of them, farthest first
};

/// How h was found.
struct SearchReport {
  int n_attempts = 1;        ///< meshes that were made or tried
  bool h_is_given = false;   ///< by the user, as a length or a number of tets
  bool at_max_tets = false;  ///< mesh.max_tets kept h larger than the body needs
};

/// Distances between the boundary of the mesh and the triangles that were given, as far as these bound the body.
struct TriangleDistances {
  std::size_t n_triangles = 0;
  double rms = 0, p99 = 0, max = 0;                 ///< of vertices and centres of boundary faces to the triangles
  double max_over_h = 0;                            ///< the largest in the h of its place
  Vec3 farthest = Vec3::Zero();                     ///< where that is; model coordinates
  double rms_back = 0, p99_back = 0, max_back = 0;  ///< of samples, corners and centres of triangles to the mesh
  double max_back_over_h = 0;
  Vec3 farthest_back = Vec3::Zero();
  /// Size and topology of what the triangles bound: none read from a certificate that lacks it.
  std::optional<TriangleBody> body = {};
  /// The same of the mesh, of its boundary without walls.
  TriangleBody mesh = {};
};

/// What the mesh can resolve at its edge length.
struct ResolutionReport {
  double kappa_h_max = 0;              ///< largest principal curvature of psi = 0 at the boundary vertices, times h
  double feature_size_over_h_min = 0;  ///< least distance along the normal to the opposite sheet, in h; at most 4
  std::size_t obtuse_conditioning_angles = 0, double_positive_faces = 0;  ///< assumptions of the paper that are broken
  /// Model coordinates, worst first; none where thin places were not looked for.
  std::optional<std::vector<ThinPlace>> too_thin;
};

/// The edges of a graded mesh beside the sizes that it was made for.
struct SizesReport {
  double least_asked = 0, greatest_asked = 0;  ///< at the vertices
  double p01 = 0, p50 = 0, p99 = 0;            ///< of length of an edge / mean size at its ends
  double shortest_boundary_edge = 0, longest_boundary_edge = 0;
};

/// Tets with curved edges.
struct SecondOrderReport {
  SecondOrderCertificate certificate;  ///< h and coordinate_rounding are not in the documents: read back, they are 0
  /// What making the mesh had to do for its Jacobians; not known of a file.
  struct Repairs {
    std::size_t n_mid_sides_put_back = 0, n_mid_sides_unprojected = 0, n_mid_sides_slid = 0, n_mid_sides_relaxed = 0;
  };
  std::optional<Repairs> repairs;
};

/// The reasons why it fails; mid-sides that were put back may be off psi = 0.
std::vector<std::string> failures(const SecondOrderReport& report);

/// What measure() finds out about a mesh, without a verdict.
struct MeshMeasures {
  std::optional<std::size_t> n_points;  ///< of the cloud; none for a formula
  MeshCertificate mesh;  ///< read back it has what the documents have: counts that only failures() looks at are 0
  double coordinate_rounding_over_h = 0;
  ZeroSetReport domain;
  std::optional<SampleDistances> cloud;        ///< none for a formula
  std::optional<TriangleDistances> triangles;  ///< none where none were given
  std::optional<LabelVolumeReport> labels;     ///< none where the input has no voxels of a body
  ResolutionReport resolution;
  std::optional<SizesReport> sizes;   ///< none where the mesh has one h
  std::optional<std::int64_t> order;  ///< 1 or 2; none where only the corners were measured
  std::optional<SecondOrderReport> second_order;
  std::optional<InputFacts> input;     ///< none where psi is not fitted to samples
  std::optional<SearchReport> search;  ///< none of a mesh that was made elsewhere
  bool is_valid = true;  ///< tets positive, boundary the closed manifold that it is to be, and not through itself
  DefectReport defects;  ///< where it is not psi = 0
  std::vector<std::string> reasons;  ///< what is wrong with it besides
};

}  // namespace umtet
