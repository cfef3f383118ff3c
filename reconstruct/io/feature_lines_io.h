#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "reconstruct/io/input_file.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/triangles/feature_lines.h"

namespace umtet {

/// Polylines read from a file.
struct FeatureLinesFile {
  FeatureLines lines;
  std::vector<std::size_t> line_of_point;  ///< line of the file, from 1, that contains a point or first uses it
  std::string format;                      ///< "feat", "eMesh" or "obj"
};

/// Reads the edges that a mesh shall have.
///
/// - quartet's .feat: the word feat and the number of polylines; for each one the number of its points and a line x y z
///   for each point. Lines that begin with # are comments. A polyline of one point has no segment.
/// - OpenFOAM's .eMesh in ascii: featureEdgeMesh and edgeMesh are a list of points and a list of edges. Of an
///   extendedFeatureEdgeMesh only these two are read.
/// - OBJ: the points v and the polylines l; all other statements are skipped.
///
/// The first word decides on the format. Every count is compared with what is there, and every index with the number of
/// points.
///
/// \throw CloudRefused  a file that is none of these, has more than 2^30 bytes, is malformed or truncated, without a
/// polyline, with an invalid index,
///        or with a coordinate that is no number or beyond 1e50
/// \throw std::system_error naming the file, if it cannot be opened or read
FeatureLinesFile read_feature_lines(const InputFile& file);
FeatureLinesFile read_feature_lines(const std::filesystem::path& file);

/// Follows the lines along the edges of triangles, and adds these edges to TriangleMesh::lines.
/// @param file  path of the lines, for the message
/// @return the number of edges
/// \throw CloudRefused  a place of the lines that is not on an edge, with its line in the file
std::size_t add_lines(TriangleMesh& mesh, const FeatureLinesFile& lines, const std::filesystem::path& file);

}  // namespace umtet
