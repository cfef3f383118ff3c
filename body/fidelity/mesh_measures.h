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
  /// The counts differ, but psi = 0 was counted on a grid coarser than the mesh; or the counts agree, but psi = 0 is in
  /// some place thinner than the grid resolves.
  NotProved,
};

/// Comparison of the boundary of the mesh with psi = 0, whose pieces are counted on a separate grid.
struct ZeroSetReport {
  std::optional<double> level_set_spacing;    ///< spacing of the finest lattice of psi; empty for a formula
  std::size_t components_of_zero_set = 0;     ///< number of pieces that were counted
  long euler_characteristic_of_zero_set = 0;  ///< Euler characteristic of all these pieces together
  long euler_characteristic_of_kept_components = 0;
  std::size_t components_kept = 0;       ///< number of pieces that were selected for the mesh
  int components_meshed = 0;             ///< pieces of the boundary of the mesh, without the walls of a box
  long euler_characteristic_meshed = 0;  ///< Euler characteristic of these pieces
  double counting_spacing = 0;           ///< spacing of the grid, model units
  TopologyProof topology = TopologyProof::Same;
  std::optional<Vec3> topology_at;              ///< position of a difference, if there is one; model coordinates
  std::vector<std::string> components_dropped;  ///< the reason for each piece that is not meshed
  /// It is proved that the count missed no piece; empty if a proof is not possible.
  std::optional<bool> components_proved;
  std::optional<SupportReport> support;  ///< empty for a formula
  double level_shift = 0;  ///< subtracted from psi so that the mesh has the volume of the triangles; model units
};

/// Distances from the samples to the boundary of the mesh. The distance of a merged sample is the rms over the original
/// samples: sqrt(d^2 + spread^2), where d is the distance of the merged sample.
struct SampleDistances {
  std::optional<double> noise;  ///< standard deviation of the samples along the normal
  double rms = 0, max = 0;
  double p99 = 0;            ///< 99 % of the samples have a smaller distance
  double missed_beyond = 0;  ///< neither noise nor flat faces explain a larger distance (missed_samples.h)
  std::optional<std::size_t> n_merged = {};  ///< number of samples before merging
  /// Number of samples whose distance from the mesh is larger than h and larger than noise explains.
  std::size_t n_beyond_h = 0;
  double most_over_h = 0;             ///< largest distance divided by the local h
  Vec3 most_at = Vec3::Zero();        ///< the sample with that distance; model coordinates
  std::size_t n_missed_places = 0;    ///< number of missed defects
  std::vector<MissedPlace> missed{};  ///< the missed defects with the largest distances, in descending order
};

/// Facts about the choice of h.
struct SearchReport {
  int n_attempts = 1;        ///< number of meshes that were made or attempted
  bool h_is_given = false;   ///< the user gave a length or a number of tets
  bool at_max_tets = false;  ///< mesh.max_tets makes h larger than the body requires
};

/// The sharp edges of the triangles, and how far the boundary of the mesh is from them.
struct SharpEdgeReport {
  std::size_t n_curves = 0, n_corners = 0, n_patches = 0;  ///< see SharpEdges
  double length = 0;                                       ///< sum over all curves, model units
  double rounded_length = 0;     ///< part of it that is farther from the boundary than kRounded h
  double max_over_h = 0;         ///< largest distance from a curve to the boundary, divided by the local h
  Vec3 farthest = Vec3::Zero();  ///< position of the largest distance; model coordinates
};

/// Distances between the boundary of the mesh and the triangles of the input that bound the body.
struct TriangleDistances {
  std::size_t n_triangles = 0;
  double rms = 0, p99 = 0, max = 0;                 ///< from vertices and centres of boundary faces to the triangles
  double max_over_h = 0;                            ///< largest distance divided by the local h
  Vec3 farthest = Vec3::Zero();                     ///< position of the largest distance; model coordinates
  double rms_back = 0, p99_back = 0, max_back = 0;  ///< from samples, corners and centres of triangles to the mesh
  double max_back_over_h = 0;
  Vec3 farthest_back = Vec3::Zero();
  /// Size and topology of the body that the triangles bound; empty if a certificate was read that lacks them.
  std::optional<TriangleBody> body = {};
  /// Size and topology of the mesh, from its boundary without walls.
  TriangleBody mesh = {};
  std::optional<SharpEdgeReport> edges = {};  ///< empty if the triangles have no sharp edges
};

/// The sharp edges and corners of a piecewise smooth body, and those of its mesh.
struct FeatureReport {
  std::size_t n_patches = 0;                              ///< patches that have faces in the boundary of the mesh
  std::size_t n_corners = 0, n_curves = 0;                ///< numbers of corners and curves of the body
  std::size_t n_missed_corners = 0, n_missed_curves = 0;  ///< numbers of those that the mesh lacks
  double length = 0, missed_length = 0;  ///< length of all curves, and of the curves that the mesh lacks
  double max_vertex_over_h = 0;          ///< largest distance from a vertex on a curve or a corner to it, in h
  double max_curve_over_h = 0;           ///< largest distance from a curve to the edges on it, in h
  /// Greatest difference of the dihedral angle at an edge on a curve between the mesh and the body, degrees.
  double max_angle_off_deg = 0;
  double min_angle_deg = 180;  ///< least dihedral angle of the body at a curve
  /// The least over all curves of the greatest mean ratio that tets at it can have (best_wedge_quality()); 1 without
  /// curves.
  double wedge_quality = 1;
  double min_cos_normal = 1;              ///< cos(face normal, gradient of the patch of the face)
  std::size_t n_faces_without_patch = 0;  ///< next to curves that the mesh does not have

  bool has_all() const { return n_missed_corners + n_missed_curves + n_faces_without_patch == 0; }
};

/// Comparison of the features of psi with the edge length.
struct ResolutionReport {
  double kappa_h_max = 0;              ///< largest principal curvature of psi = 0 at the boundary vertices, times h
  double feature_size_over_h_min = 0;  ///< least distance along the normal to the opposite sheet, in h; at most 4
  /// Numbers of violations of assumptions of the paper.
  std::size_t obtuse_conditioning_angles = 0, double_positive_faces = 0;
  /// Thin places in model coordinates, worst first; empty if they were not searched.
  std::optional<std::vector<ThinPlace>> too_thin;
};

/// Comparison of the edges of a graded mesh with the sizes for which it was made.
struct SizesReport {
  double least_asked = 0, greatest_asked = 0;  ///< least and greatest size at the vertices
  double p01 = 0, p50 = 0, p99 = 0;            ///< percentiles of (length of an edge) / (mean size at its ends)
  double shortest_boundary_edge = 0, longest_boundary_edge = 0;
};

/// Tets with curved edges.
struct SecondOrderReport {
  /// h and coordinate_rounding are not written to documents; they are 0 after reading.
  SecondOrderCertificate certificate;
  /// Corrections that were made for positive Jacobians; unknown for a mesh from a file.
  struct Repairs {
    std::size_t n_mid_sides_put_back = 0, n_mid_sides_unprojected = 0, n_mid_sides_slid = 0, n_mid_sides_relaxed = 0;
  };
  std::optional<Repairs> repairs;
};

/// Returns the reasons for failure. Mid-sides that were put back may be off psi = 0.
std::vector<std::string> failures(const SecondOrderReport& report);

/// All measurements of a mesh by measure(), without a verdict.
struct MeshMeasures {
  std::optional<std::size_t> n_points;  ///< number of points of the cloud; empty for a formula
  MeshCertificate mesh;                 ///< if it was read from a document, the counts that only failures() uses are 0
  double coordinate_rounding_over_h = 0;
  ZeroSetReport domain;
  std::optional<SampleDistances> cloud;        ///< empty for a formula
  std::optional<TriangleDistances> triangles;  ///< empty if the input has no triangles
  std::optional<LabelVolumeReport> labels;     ///< empty if the input has no voxels
  std::optional<FeatureReport> features;       ///< empty for a smooth body
  ResolutionReport resolution;
  std::optional<SizesReport> sizes;   ///< empty if the mesh has one h
  std::optional<std::int64_t> order;  ///< 1 or 2; empty if only the mesh of the corners was measured
  std::optional<SecondOrderReport> second_order;
  std::optional<InputFacts> input;     ///< empty if psi was not fitted to samples
  std::optional<SearchReport> search;  ///< empty if this library did not make the mesh
  /// All tets are positive, and the boundary is the required closed manifold and does not intersect itself.
  bool is_valid = true;
  DefectReport defects;              ///< differences between the mesh and psi = 0
  std::vector<std::string> reasons;  ///< other reasons why the mesh fails
};

}  // namespace umtet
