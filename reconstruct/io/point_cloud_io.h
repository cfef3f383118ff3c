#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "reconstruct/cloud/cloud_file.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/io/input_file.h"

namespace umtet {

/// Reads an oriented point cloud in PLY or PCD, identified by the first line, or as a table of numbers in text,
/// whatever the extension. All numbers are in double precision.
///
/// PLY: ascii, binary little and big endian, any scalar type and property order, additional and list properties, other
/// elements before and after `vertex`, comments, CRLF headers. PCD: ascii, binary, binary_compressed. Normals are nx ny
/// nz or normal_x normal_y normal_z.
///
/// Text: a row of numbers per point, separated by blanks, tabs, commas or semicolons, also with decimal commas if no
/// comma separates columns. '#', '//' and '%' begin comments. The rows may be preceded by a number of points (.pts),
/// which is checked, and by lines of a header. A header (also in a comment) with a name for each column, including x, y
/// and z, defines the columns (column_name()). Otherwise they are guessed from their values (columns_by_value()), and
/// CloudFileReport::columns states the guess. `columns` overrides both.
///
/// Other properties:
/// - Labels are the property or field `label` (or `patch`), or a last column of text with at most 64 different whole
///   numbers; they are whole numbers of 32 bits.
/// - The scanner position of each point is given by the properties or fields sx sy sz, or origin_x origin_y origin_z.
/// - Colours are red, green and blue, as bytes, 16 bits or 0..1, or rgb or rgba of PCD, four bytes in a number.
/// - Every other property, field or column with one number per point is a field of the samples, up to kMostFields.
///
/// Normals are normalised. The file must contain at least 10 points; duplicates are kept.
///
/// Every count of a header is compared with the size of the file before it is used, so memory stays below a small
/// multiple of that size.
///
/// @param columns  for text: a word per column, separated by commas. "-" or "skip" drops a column, and so do missing
///                 words at the end. Empty: as above. See problem_of_columns()
/// \throw CloudRefused for a cloud that is malformed, empty, not finite or beyond 1e50, without normals, or all within
///        1e-50 (for a text, with line and column); for `columns` that do not fit, or given for another format
/// \throw std::system_error naming the file, if it cannot be opened or read
CloudFile read_point_cloud(const std::filesystem::path& file, const std::string& columns = {});

/// Reads the same files as an unprocessed scan for clean(), estimate_normals() and survey(). Points without normals
/// give a cloud without normals, unusable normals become zero, and points that are not numbers are dropped and counted.
/// Counts and spreads are ignored: in a scan, merged samples are samples.
///
/// \throw CloudRefused for a file that is malformed or empty, if more than half of the points are unusable, or if there
///        are fewer different points than survey() requires
/// \throw std::system_error naming the file, if it cannot be opened or read
CloudFile read_scan(const InputFile& file, const std::string& columns = {});
CloudFile read_scan(const std::filesystem::path& file, const std::string& columns = {});

/// Checks the first megabyte of a file, independent of its size: rejects what read_scan() would reject because of the
/// header, the first rows, or an impossible count. \throw CloudRefused
void check_scan_head(const InputFile& file, const std::string& columns = {});

/// The reason why read_scan() accepts these columns for no file; empty if it may accept them.
std::string problem_of_columns(const std::string& columns);

/// Writes binary little-endian PLY: double x y z nx ny nz and, if present, int label, uchar red green blue, int
/// umtet_count, double umtet_spread and the fields as double. read_point_cloud() returns the same bits. Origins are not
/// written. The caller owns the stream and checks it.
/// \throw std::invalid_argument if the numbers of points, normals or other data differ
void write_ply(std::ostream&, const OrientedPointCloud&);

}  // namespace umtet
