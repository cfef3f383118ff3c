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

/// A vertex or a face of a boundary that is not on psi = 0, or that lies on it the wrong way round.
struct BoundaryFault {
  enum class Kind : std::uint8_t {
    Off,     ///< a vertex farther than kVertexTolerance h, or a face without a point of psi = 0 near its centroid
    Folded,  ///< a face whose normal has no part along grad psi: cos <= 0
  };
  Kind kind;
  Vec3 where;       ///< the vertex, or the centroid
  double distance;  ///< from psi = 0, model units; of a face without such a point h, which is the least it can be
};

/// What is true of a tet mesh, measured without trust in how it was made. Lengths are in model units, ratios in h.
struct MeshCertificate {
  std::size_t n_tets = 0;
  std::size_t n_vertices = 0;        ///< vertices that a tet uses
  std::size_t n_positive_faces = 0;  ///< 0 when none were given
  std::size_t n_wall_faces = 0;      ///< 0 when none were given
  double volume = 0;                 ///< sum over tets, model units^3
  struct Quality {
    double min = 0, p001 = 0, p01 = 0, mean = 0;  ///< mean ratio, eq. (6); 0.1 % and 1 % quantiles; -1 = not a number
    double dihedral_min_deg = 0, dihedral_max_deg = 0;
    std::size_t n_inverted = 0;  ///< exact sign of the volume <= 0
  } quality;
  /// All of it, walls included; what is about psi leaves the faces and vertices of the walls out.
  struct Boundary {
    std::size_t n_faces = 0;            ///< faces of exactly one tet
    std::size_t n_overused_faces = 0;   ///< faces of more than two tets
    std::size_t n_same_side_faces = 0;  ///< faces with two tets on one side: overlap or inversion
    std::size_t n_nonmanifold_edges = 0, n_nonmanifold_vertices = 0;
    bool closed_manifold = false;
    /// Pairs of faces that meet elsewhere than in what they share, by exact predicates (self_intersections.h).
    std::size_t n_self_intersections = 0;
    /// Of closed_manifold without self-intersections: components within a body, or cavities without one.
    std::size_t n_wrongly_nested = 0;
    std::optional<bool> equals_positive_faces;  ///< and wall faces; together, as a set
    std::size_t n_moved_wall_vertices = 0;      ///< not at CertificateInput::background_V, to the bit
    int components = 0;
    long euler_characteristic = 0;
    long genus = 0;  ///< sum over components; meaningful if closed_manifold
    double area = 0;
    std::optional<double> max_vertex_distance_over_h;    ///< |psi| / |grad psi| at boundary vertices
    std::optional<double> max_centroid_distance_over_h;  ///< from face centroids to their closest points
    double max_centroid_distance = 0;                    ///< the same, model units
    std::optional<double> min_cos_normal;                ///< cos(face normal, grad psi) at projected centroids
    /// Volume between the flat faces and psi = 0, both sides counted, over the volume of the mesh or, where that is
    /// less, of the body that it has walls around.
    std::optional<double> gap_over_volume;
    std::size_t n_cos_below_half = 0;     ///< faces with cos < .5
    std::size_t n_unprojected_faces = 0;  ///< faces whose centroid found no point of psi = 0
    std::vector<BoundaryFault> faults{};  ///< vertices before faces, in their order
    /// Points of psi = 0 nearest to the centroids of faces farther than kFarFace h from it: faces that cut a corner
    /// off.
    std::vector<Vec3> far_feet{};
  } boundary;
  /// Tets positive, boundary a closed manifold that does not meet itself, one within the other as those of a solid: the
  /// mesh is embedded, no two tets overlap (docs/method.md, Section 9).
  bool is_embedded() const {
    return quality.n_inverted == 0 && boundary.closed_manifold && boundary.n_self_intersections == 0 &&
           boundary.n_wrongly_nested == 0;
  }
  double h = 0;                    ///< edge length the ratios refer to where CertificateInput::local_h is not given
  double coordinate_rounding = 0;  ///< CertificateInput::coordinate_rounding
};

/// A mesh and what backs it. The referenced objects must outlive the call.
struct CertificateInput {
  const TetMesh* mesh = nullptr;
  double h = 0;  ///< <= 0: the mean over tets of the root mean square edge length is used
  const std::vector<Triangle>* positive_faces = nullptr;  ///< optional: compared with the boundary as a set
  std::optional<ImplicitFunctionRef> psi;                 ///< optional: distances and normals
  double coordinate_rounding = 0;  ///< how far the file's rounding of coordinates may move a vertex, model units
  Context context = {};
  const std::vector<Triangle>* wall_faces = nullptr;  ///< optional: boundary that is not of psi = 0
  const std::vector<Vec3>* background_V = nullptr;  ///< by vertex: where those of the walls are to be; with wall_faces
  /// Optional, by vertex, > 0: the edge length that ratios at this vertex, and at faces with it, refer to, instead of
  /// h.
  const std::vector<double>* local_h = nullptr;
};

/// A boundary vertex may be this far from psi = 0, in h, besides the rounding of its coordinates: what the projection
/// leaves is a hundred times less.
inline constexpr double kVertexTolerance = 1e-8;

/// The centroid of a face with edges of h is r - sqrt(r^2 - h^2 / 3) from a sphere of radius r through its corners, .15
/// h for r = 1.2 h: under one that is farther, psi = 0 is sharper than that.
inline constexpr double kFarFace = .15;

/// Flat faces may miss this share of the volume, gap_over_volume: a ball with an edge of about its radius misses that
/// much. A mesh that resolves its domain misses a few per cent at most.
inline constexpr double kMostGap = .1;

/// Measures everything above. Does not judge. Not seen here: components of psi = 0 that the mesh lacks (zero_set.h
/// counts them).
///
/// Cost: O(n log n); threads over tets and faces, result independent of them.
/// psi must be thread-safe.
/// \throw std::invalid_argument without a mesh or tets, for an index out of range, or where background_V is wanting;
///        Cancelled
MeshCertificate certify(const CertificateInput&);

class CertificateMemory;
/// The same, to the bit, of a mesh that differs little from the one that was certified with this memory before: tets
/// that are the same to the bit keep what was measured of them, and faces are counted where tets have come or gone. The
/// surface is measured anew. Cost: as the surface and the tets that have changed, and some ns for each of the others.
/// @param vertex_id, tet_id  by which vertices and tets of the two meshes are known, ascending. Not trusted: they only
///                           say where to look
/// @param memory             empty at first; receives what the next call will use
MeshCertificate certify(const CertificateInput&, const std::vector<std::int64_t>& vertex_id,
                        const std::vector<std::int64_t>& tet_id, CertificateMemory& memory);

/// The reasons why a mesh is not valid, empty = it is: tets inverted, boundary not a closed manifold, or through
/// itself, or not the positive and wall faces, a wall that has moved.
std::vector<std::string> invalidities(const MeshCertificate&);

/// Empty, or the reason why h is too large for the shape as a whole: flat faces miss more than kMostGap of the volume.
std::vector<std::string> coarseness(const MeshCertificate&);

/// The reasons why a certificate fails, empty = pass: invalidities(), coarseness(), and the faults of the boundary:
/// a vertex farther than kVertexTolerance h from psi = 0, a face without a point of psi = 0 near it, a face that is
/// folded over.
std::vector<std::string> failures(const MeshCertificate&);

}  // namespace umtet
