#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// The content of a cloud file was refused. what() is one sentence: file, place (line, byte or point number), remedy.
struct CloudRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// More of them are left out.
inline constexpr std::size_t kMostFields = 16;

/// What was found in a cloud file besides the points.
struct CloudFileReport {
  std::string format;  ///< "ply ascii", "ply binary little endian", "pcd compressed", "xyz" ...
  std::size_t n_points = 0;
  std::size_t n_normals_rescaled = 0;  ///< normals that were not unit to 1e-3 and have been made so
  std::size_t n_points_dropped = 0;    ///< read_scan: coordinates NaN, infinite or beyond 1e50
  std::size_t n_normals_missing = 0;   ///< read_scan: zero, NaN or infinite; they are zero in the cloud
  bool of_triangles = false;           ///< samples of triangles: their normals are sure, and there is no outlier
  std::optional<Vec3> viewpoint = {};  ///< where the scanner stood: VIEWPOINT of a .pcd, unless it is 0 0 0 1 0 0 0
  std::vector<std::string> fields_left_out = {};  ///< beyond the first kMostFields, or of a name that is there twice
};

struct CloudFile {
  OrientedPointCloud cloud;
  CloudFileReport report;
};

/// Reads .ply, .pcd, .xyz/.txt/.pts by content, then by extension. Double precision throughout.
///
/// PLY: ascii, binary little and big endian, any scalar type and property order, extra and list properties, other
/// elements before and after `vertex`, comments, CRLF headers. PCD: ascii, binary, binary_compressed. XYZ: 6 columns
/// x y z nx ny nz separated by blanks, tabs or commas, '#' and '//' comments; a first line with the number of points
/// (.pts) is checked. Normals are nx ny nz or normal_x normal_y normal_z.
/// Labels, where there are any, are the property or field `label` (or `patch`), or a column of XYZ behind the others:
/// whole numbers of 32 bits. A .pts file, or an XYZ file with more than 64 different ones, is refused there: its last
/// column is an intensity or a colour.
/// Where the scanner stood, where that is known of each point, are the properties or fields sx sy sz, or origin_x
/// origin_y origin_z.
/// Colours are red, green and blue, bytes or 0..1 in floating point, or rgb or rgba of PCD, four bytes in a number.
/// Every other property, field or column of one number a point that has a name is a field of the samples, up to
/// kMostFields. The columns of XYZ have names if a comment before them has one for each, x, y and z among them; r g b
/// are colours there. Normals are made unit. At least 10 points; duplicates stay.
///
/// No count of a header is believed before it was compared with the size of the file: memory stays below a small
/// multiple of it.
///
/// \throw CloudRefused         malformed, empty, non-finite or beyond 1e50, without normals,
///                             or all within 1e-50
/// \throw std::system_error    the file cannot be opened or read; names it
CloudFile read_point_cloud(const std::filesystem::path& file);

/// Reads the same files for clean(), estimate_normals() and survey(): points without normals give a cloud with none,
/// unusable normals become zero, and points that are no numbers are dropped and counted. Counts and spreads are left
/// out: to a scan, merged samples are samples.
///
/// \throw CloudRefused         malformed, empty, more than half of the points unusable, or not as many different ones
/// as
///                             survey() needs
/// \throw std::system_error    the file cannot be opened or read; names it
CloudFile read_scan(const std::filesystem::path& file);

/// Refuses by its first megabyte what read_scan() would refuse by its header, its first rows, or a count that cannot
/// be: at once, however large the file is. \throw CloudRefused, std::system_error  as read_scan()
void check_scan_head(const std::filesystem::path& file);

/// Binary little-endian PLY, double x y z nx ny nz and, where there are any, int label, uchar red green blue, int
/// umtet_count, double umtet_spread and the fields as double; read_point_cloud gives the same bits back. Origins are
/// not written. The caller owns the stream and checks it. \throw std::invalid_argument  not as many normals as points,
/// or of what else there is
void write_ply(std::ostream&, const OrientedPointCloud&);

}  // namespace umtet
