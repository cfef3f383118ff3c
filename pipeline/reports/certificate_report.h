#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/certify/certificate.h"
#include "mesh/certify/second_order_certificate.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"
#include "pipeline/case/version.h"
#include "body/fidelity/closed_hole.h"
#include "pipeline/reports/label_report.h"
#include "body/fidelity/mesh_place.h"
#include "body/fidelity/missed_place.h"
#include "body/sizing/thin_place.h"
#include "reconstruct/triangles/triangle_body.h"

// What certificate.json, the record of 3-mesh and the answers of `umtet check` say about a mesh. Lengths in model units
// unless a name says otherwise; certificate_json.h writes and reads them.
namespace umtet {

/// Whether the boundary of a mesh has the pieces and the Euler characteristic of psi = 0.
enum class TopologyProof {
  Same,
  Differs,
  /// The counts differ, and the grid of that of psi = 0 is coarser than the mesh; or they are the same, and psi = 0 is
  /// thinner somewhere than that grid can see.
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

/// What was done to a cloud, or guessed, before psi was fitted: where a wrong body may come from. Shares of its points.
struct InputFacts {
  bool normals_given = false;  ///< they came with the cloud; else they were estimated
  double turned = 0;           ///< given normals that were turned, or estimated ones that something else overruled
  std::string turned_by;       ///< "neighbours", "winding number", "psi"; empty where none were turned
  double doubtful = 0;         ///< normals whose outward side is a guess
  double opposed = 0;          ///< normals that point against grad psi
  double consistency = 1;      ///< share of neighbouring pairs whose signs agree in the end
  std::optional<double> off_a_half;  ///< share of patches that bound no body by the winding number; none: not asked
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
  PlaceReport places;    ///< where it is not psi = 0
  std::vector<std::string> reasons;  ///< what is wrong with it besides
};

/// The second of the three judgements: the mesh is psi = 0 as far as h can show it, on it, not folded, nothing lost, of
/// its topology. Small places do not count.
bool fits_psi(const MeshMeasures& measured);
/// Whether something else than psi was given: samples, triangles or labels.
bool has_input(const MeshMeasures& measured);

/// The stage to blame for a mesh that fails, and what helps.
struct Blame {
  std::string stage;   ///< "input", "normals", "labels", "level set", "h", "max_tets", "mesh"
  std::string number;  ///< what was measured there, in words
  std::string remedy;  ///< what to try, with its flag
};

/// What a mesh is held against, and what came of it.
struct Verdict {
  std::optional<double> min_quality_gate;  ///< the least mean ratio that passes, if the user set one
  double volume_gap_gate = kMostGap;       ///< the largest gap_over_volume that passes
  bool strict = false;                     ///< a named defect fails, too
  std::string accept;                      ///< the kinds of defects that pass, as the user gave them
  bool is_valid = true;                    ///< first judgement: proved
  bool fits_psi = true;                    ///< second: fits_psi()
  bool fits_input = true;                  ///< third: input_judgement.h
  std::vector<std::string> accepted;       ///< what passes because of `accept`
  std::vector<std::string> defects;        ///< what is small, and passes
  std::size_t n_defects = 0;               ///< how many places and numbers these are
  std::vector<std::string> reasons;        ///< why it fails

  bool passes() const { return reasons.empty(); }
  /// "pass", "pass with N defects named" or "fail".
  std::string word() const;
};

/// Times of all stages that made a mesh.
struct CertificateRun {
  std::vector<std::pair<std::string, double>> seconds;  ///< by section of the parameters, in the order of the stages
  std::optional<double> points_per_s;                   ///< of the fit; none for a formula
  std::optional<double> tets_per_s;                     ///< of the mesher
  double peak_memory_MB = 0;
  int threads = 0;
  std::string host, date;  ///< of the mesh
  std::string checksum;    ///< seal of the certificate
};

/// certificate.json: what is true of a mesh, and whether that will do. (What is measured of the tets alone is
/// MeshCertificate of mesh/certify/certificate.h.)
struct Certificate {
  std::string version = kVersion;    ///< of the program that made it
  std::optional<std::string> units;  ///< of lengths, for the reader
  MeshMeasures measured;
  std::optional<std::int64_t> n_tets_asked;
  Verdict verdict;
  std::optional<Blame> blame;         ///< none where it passes
  std::optional<CertificateRun> run;  ///< none for a mesh that never was in a case
};

/// What is true of a mesh from a file: a Certificate without the parts that a mesh alone does not have.
struct MeshCheck {
  std::string file;                  ///< as the user gave it
  std::optional<std::string> units;  ///< of lengths, for the reader
  MeshCertificate mesh;
  std::optional<SecondOrderReport> second_order;  ///< of tets with 10 nodes
  std::optional<SupportReport> support;           ///< by the samples of a case
  bool is_valid = true;
  std::optional<PlaceReport> places;  ///< none without a case to compare with
  Verdict verdict;
};

/// output.units; none where none were given.
std::optional<std::string> units_of(const Parameters& parameters);

/// The three judgements. It fails by the reasons of what was measured, by places and differences from the input that
/// are neither small nor accepted (output.strict, output.accept), and by a broken output.min_quality.
Verdict judge(const MeshMeasures& measured, const Parameters& parameters);
/// The first two judgements: whether the mesh is what h can show of psi. @param accept  as output.accept has it
Verdict judge_shape(const MeshMeasures& measured, bool strict = false, const std::string& accept = "");

/// What was measured with its gates and verdict; without `run`.
Certificate verdict_on(MeshMeasures measured, const Parameters& parameters);

/// Sealed, with times. A function of the records and the parameters alone, so it can be made again at any time.
/// \pre the stage 3-mesh is done \throw ArtefactDamaged  a record lacks something
Certificate certificate(const CasePaths& paths, const StageRecord& mesh, const Parameters& parameters);

}  // namespace umtet
