#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "reconstruct/cloud/cloud_file.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Reads PLY and PCD, known by their first line, and tables of numbers in text, whatever their extension. Double
/// precision throughout.
///
/// PLY: ascii, binary little and big endian, any scalar type and property order, extra and list properties, other
/// elements before and after `vertex`, comments, CRLF headers. PCD: ascii, binary, binary_compressed. Normals are
/// nx ny nz or normal_x normal_y normal_z.
///
/// Text: a row of numbers for each point, separated by blanks, tabs, commas or semicolons, also with decimal commas
/// where no comma separates columns. '#', '//' and '%' begin comments. Before the rows there may be a number of points
/// (.pts), which is checked, and lines of a header. A header (also in a comment) with a name for each column, x, y and
/// z among them, says what the columns are (column_name()); else their values say it (columns_by_value()), and
/// CloudFileReport::columns says what was guessed. `columns` overrules both.
///
/// Labels, where there are any, are the property or field `label` (or `patch`), or a last column of text with at most
/// 64 different whole numbers: whole numbers of 32 bits.
/// Where the scanner stood, where that is known of each point, are the properties or fields sx sy sz, or origin_x
/// origin_y origin_z.
/// Colours are red, green and blue, bytes, 16 bits or 0..1, or rgb or rgba of PCD, four bytes in a number.
/// Every other property, field or column of one number a point is a field of the samples, up to kMostFields. Normals
/// are made unit. At least 10 points; duplicates stay.
///
/// No count of a header is believed before it was compared with the size of the file: memory stays below a small
/// multiple of it.
///
/// @param columns  of text: a word for each column, with commas between them; "-" or "skip" leaves one out, and so do
///                 words that are missing at the end; empty: as above. See problem_of_columns()
/// \throw CloudRefused         malformed, empty, non-finite or beyond 1e50, without normals, or all within 1e-50; of a
///                             text names line and column; `columns` that do not fit, or given for another format
/// \throw std::system_error    the file cannot be opened or read; names it
CloudFile read_point_cloud(const std::filesystem::path& file, const std::string& columns = {});

/// Reads the same files for clean(), estimate_normals() and survey(): points without normals give a cloud with none,
/// unusable normals become zero, and points that are no numbers are dropped and counted. Counts and spreads are left
/// out: to a scan, merged samples are samples.
///
/// \throw CloudRefused         malformed, empty, more than half of the points unusable, or not as many different ones
/// as
///                             survey() needs
/// \throw std::system_error    the file cannot be opened or read; names it
CloudFile read_scan(const std::filesystem::path& file, const std::string& columns = {});

/// Refuses by its first megabyte what read_scan() would refuse by its header, its first rows, or a count that cannot
/// be: at once, however large the file is. \throw CloudRefused, std::system_error  as read_scan()
void check_scan_head(const std::filesystem::path& file, const std::string& columns = {});

/// A sentence that says why read_scan() takes no such columns of any file; empty if it may take them.
std::string problem_of_columns(const std::string& columns);

/// Binary little-endian PLY, double x y z nx ny nz and, where there are any, int label, uchar red green blue, int
/// umtet_count, double umtet_spread and the fields as double; read_point_cloud gives the same bits back. Origins are
/// not written. The caller owns the stream and checks it. \throw std::invalid_argument  not as many normals as points,
/// or of what else there is
void write_ply(std::ostream&, const OrientedPointCloud&);

}  // namespace umtet
