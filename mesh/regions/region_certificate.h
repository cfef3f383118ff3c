#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/regions/region_domain.h"

namespace umtet {

/// Measures of one region of a mesh. A region without a tet has a certificate without numbers.
struct RegionMeasures {
  int region = 0;
  /// The certificate of the tets of this region alone, without psi. Its boundary may touch itself in an edge or a
  /// vertex where another region does.
  MeshCertificate certificate;
  int n_pieces = 0;  ///< tets that are connected by faces
  /// Least mean ratio of its tets without a vertex on the boundary of the mesh, such as the walls of a box; 1 if there
  /// is none.
  double min_quality_off_boundary = 1;
};

/// Measures of the faces between two regions, against their sheet f_ab = 0.
struct InterfaceMeasures {
  int region = 0, other = 0;  ///< the greater region, and the lesser one
  std::size_t n_faces = 0;
  double area = 0;                   ///< model units^2
  double max_vertex_distance = 0;    ///< greatest distance of a corner from the sheet, in h
  double max_centroid_distance = 0;  ///< greatest distance of a centroid from the sheet, in h
  double min_cos_normal = 1;         ///< cos(face normal, grad f_ab) at the foot of the centroid
  std::size_t n_off = 0;             ///< corners of faces farther than kVertexTolerance h from the sheet
  std::size_t n_folded = 0;          ///< faces with cos <= 0, or without a foot point near their centroid
};

/// The certificate of a mesh of several regions.
struct RegionCertificate {
  MeshCertificate whole;  ///< all tets, without psi: if they are embedded, no two tets of any region overlap
  std::vector<RegionMeasures> regions;        ///< ascending, region 0 included where it has tets
  std::vector<InterfaceMeasures> interfaces;  ///< ascending by region and other; without a domain only n_faces and area
  /// Boundary faces of the mesh that lie on another one with the same corners, but other vertices: two regions touch
  /// there, and are not connected.
  std::size_t n_unshared_faces = 0;
};

/// Certifies a mesh of several regions, however it was made.
///
/// Each face between two regions belongs to one tet on either side, because no face of `whole` has more than two tets.
/// Without tets of region 0, the boundary faces of the mesh are interfaces of region 0.
/// @param region  per tet, >= 0; with a domain less than kMostRegions
/// @param domain  null: the interfaces are not compared with sheets
/// @param h       edge length of the ratios; <= 0: as in CertificateInput
/// @param sides   boundary faces that are no interfaces although there is no region 0, such as those of
///   PeriodicMatch; corners ascending in each, and the list ascending
/// \throw std::invalid_argument as certify(), or if there is not one region per tet; Cancelled
RegionCertificate certify_regions(const TetMesh& mesh, const std::vector<int>& region,
                                  const RegionDomain* domain = nullptr, double h = 0, const Context& context = {},
                                  const std::vector<Triangle>& sides = {});

/// The reasons why the certificate fails; empty if it passes: those of invalidities() of the whole mesh, vertices off
/// their sheets, folded faces, and regions without a tet.
/// @param n_regions  of the domain
/// @param names      one per region; empty: regions are called by their numbers
std::vector<std::string> failures(const RegionCertificate& certificate, int n_regions,
                                  const std::vector<std::string>& names = {});

}  // namespace umtet
