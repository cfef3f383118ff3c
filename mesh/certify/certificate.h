#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// A defect of a boundary: a vertex or a face that is not on psi = 0, or a face that is folded over.
struct BoundaryFault {
  enum class Kind : std::uint8_t {
    Off,  ///< a vertex farther than kVertexTolerance h from psi = 0, or a face without a foot point near its centroid
    Folded,  ///< a face with cos(normal, grad psi) <= 0
  };
  Kind kind;
  Vec3 where;       ///< position of the vertex, or centroid of the face
  double distance;  ///< distance from psi = 0, model units; the lower bound h for a face without a foot point
};

/// Measured properties of a tet mesh, independent of how the mesh was made. Lengths are in model units, ratios in h.
struct MeshCertificate {
  std::size_t n_tets = 0;
  std::size_t n_vertices = 0;        ///< vertices used by a tet
  std::size_t n_positive_faces = 0;  ///< 0 if none were given
  std::size_t n_wall_faces = 0;      ///< 0 if none were given
  double volume = 0;                 ///< sum over tets, model units^3
  struct Quality {
    double min = 0, p001 = 0, p01 = 0, mean = 0;  ///< mean ratio, eq. (6); 0.1 % and 1 % quantiles; -1 = not a number
    double dihedral_min_deg = 0, dihedral_max_deg = 0;
    std::size_t n_inverted = 0;  ///< tets whose volume has exact sign <= 0
  } quality;
  /// The whole boundary, walls included. Measures that refer to psi exclude the faces and vertices of the walls.
  struct Boundary {
    std::size_t n_faces = 0;            ///< faces of exactly one tet
    std::size_t n_overused_faces = 0;   ///< faces of more than two tets
    std::size_t n_same_side_faces = 0;  ///< faces with both tets on one side: overlap or inversion
    std::size_t n_nonmanifold_edges = 0, n_nonmanifold_vertices = 0;
    bool closed_manifold = false;
    /// Pairs of faces that intersect outside of their common vertices and edges, by exact predicates
    /// (self_intersections.h).
    std::size_t n_self_intersections = 0;
    /// If closed_manifold without self-intersections: components inside a body, or cavities outside of any body.
    std::size_t n_wrongly_nested = 0;
    std::optional<bool> equals_positive_faces;  ///< the boundary equals the positive and wall faces together, as a set
    std::size_t n_moved_wall_vertices = 0;      ///< wall vertices not at CertificateInput::background_V, to the bit
    int components = 0;
    long euler_characteristic = 0;
    long genus = 0;  ///< sum over components; meaningful if closed_manifold
    double area = 0;
    std::optional<double> max_vertex_distance_over_h;  ///< |psi| / |grad psi| at boundary vertices
    /// Largest distance from a face centroid to its closest point, in h.
    std::optional<double> max_centroid_distance_over_h;
    double max_centroid_distance = 0;      ///< the same in model units
    std::optional<double> min_cos_normal;  ///< cos(face normal, grad psi) at projected centroids
    /// Volume between the flat faces and psi = 0, counted on both sides, divided by the volume of the mesh. In a mesh
    /// with walls it is divided by the volume that the other faces enclose if this is smaller.
    std::optional<double> gap_over_volume;
    std::size_t n_cos_below_half = 0;     ///< faces with cos < .5
    std::size_t n_unprojected_faces = 0;  ///< faces without a point of psi = 0 found from their centroid
    std::vector<BoundaryFault> faults{};  ///< vertices before faces, in ascending order
    /// Points of psi = 0 nearest to the centroids of faces farther than kFarFace h from it; such faces cut off a
    /// corner.
    std::vector<Vec3> far_feet{};
  } boundary;
  /// True if all tets are positive and the boundary is a closed manifold without self-intersections whose components
  /// are nested as in a solid. The mesh is then embedded: no two tets overlap (docs/method.md, Section 9).
  bool is_embedded() const {
    return quality.n_inverted == 0 && boundary.closed_manifold && boundary.n_self_intersections == 0 &&
           boundary.n_wrongly_nested == 0;
  }
  double h = 0;                    ///< edge length of the ratios, if CertificateInput::local_h is not given
  double coordinate_rounding = 0;  ///< CertificateInput::coordinate_rounding
};

/// A mesh and the data it is checked against. The referenced objects must outlive the call.
struct CertificateInput {
  const TetMesh* mesh = nullptr;
  double h = 0;  ///< edge length; <= 0: the mean over tets of the root mean square edge length is used
  const std::vector<Triangle>* positive_faces = nullptr;  ///< optional: compared with the boundary as a set
  std::optional<ImplicitFunctionRef> psi;                 ///< optional: distances and normals
  double coordinate_rounding = 0;  ///< bound on the displacement of a vertex by rounding in the file, model units
  Context context = {};
  const std::vector<Triangle>* wall_faces = nullptr;  ///< optional: boundary faces that are not on psi = 0
  const std::vector<Vec3>* background_V = nullptr;    ///< required positions by vertex, used at walls; with wall_faces
  /// Optional, by vertex, > 0: the edge length of the ratios at this vertex and at its faces, instead of h.
  const std::vector<double>* local_h = nullptr;
};

/// Maximum distance of a boundary vertex from psi = 0, in h, in addition to the rounding of its coordinates. The
/// projection leaves a hundredth of it.
inline constexpr double kVertexTolerance = 1e-8;

/// The centroid of a face with edges of length h is r - sqrt(r^2 - h^2 / 3) from a sphere of radius r through its
/// corners, which is .15 h for r = 1.2 h. If a face is farther away, psi = 0 is sharper than that sphere.
inline constexpr double kFarFace = .15;

/// Maximum gap_over_volume: flat faces may miss this share of the volume. A ball meshed with an edge of about its
/// radius misses that much; a mesh that resolves its domain misses a few per cent at most.
inline constexpr double kMostGap = .1;

/// Measures all fields of a certificate, without a verdict. Components of psi = 0 that the mesh lacks are not detected
/// (zero_set.h counts them).
///
/// psi must be thread-safe. Cost: O(n log n). Uses threads over tets and faces; the result does not depend on them.
/// \throw std::invalid_argument without a mesh or tets, for an index out of range, or if background_V is missing;
///        Cancelled
MeshCertificate certify(const CertificateInput&);

class CertificateMemory;
/// Certificate of a mesh that differs little from the mesh last certified with this memory; equal to certify() to the
/// bit.
///
/// Tets that are unchanged to the bit keep their measured values, and faces are counted where tets were added or
/// removed. The surface is always measured again. Cost: proportional to the surface and the changed tets, plus some ns
/// for each of the other tets.
/// @param vertex_id, tet_id  ids that identify vertices and tets of the two meshes, ascending. A wrong id makes the
///   call slower, but the result stays correct
/// @param memory             empty at first; receives the data that the next call uses
MeshCertificate certify(const CertificateInput&, const std::vector<std::int64_t>& vertex_id,
                        const std::vector<std::int64_t>& tet_id, CertificateMemory& memory);

/// The reasons why a mesh is invalid; empty if it is valid. A mesh is invalid if tets are inverted; if the boundary is
/// not a closed manifold, intersects itself, or differs from the positive and wall faces; or if a wall has moved.
std::vector<std::string> invalidities(const MeshCertificate&);

/// The reason why h is too large for the shape as a whole: flat faces miss more than kMostGap of the volume. Else
/// empty.
std::vector<std::string> coarseness(const MeshCertificate&);

/// The reasons why a certificate fails; empty if it passes. They include the reasons of invalidities() and
/// coarseness(), and the faults of the boundary:
/// - a vertex farther than kVertexTolerance h from psi = 0,
/// - a face without a point of psi = 0 near it,
/// - a face that is folded over.
std::vector<std::string> failures(const MeshCertificate&);

}  // namespace umtet
