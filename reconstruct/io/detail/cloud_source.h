#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "reconstruct/io/point_cloud_io.h"

namespace umtet::detail {

class FileBytes;

/// A cloud file in memory, or its beginning, and its name for messages. The bytes outlive every reader.
struct CloudSource {
  std::string name;
  std::string_view bytes;
  bool needs_normals = true;  ///< false: points without normals make a cloud without normals
  /// Of the file, behind `bytes`. The readers need all of it, check_ply_head() and the like do not.
  std::size_t bytes_left_out = 0;
  FileBytes* rest =
      nullptr;  ///< what reads them block by block (ByteWindow); null: there are none, or all are in memory
  std::string_view columns = {};  ///< what the user says of the columns of a text; empty: nothing

  std::size_t size() const { return bytes.size() + bytes_left_out; }  ///< of the file
};

/// \throw CloudRefused  always: "NAME: what"
[[noreturn]] void refuse(const CloudSource& source, const std::string& what);

/// A piece of a file as it may be shown on a terminal: quoted, clipped to 40 characters, unprintable bytes as '?'.
std::string in_quotes(std::string_view text);

/// \throw CloudRefused  anything but blanks and NUL padding from `offset` on: then a count of the header is wrong
void refuse_surplus(const CloudSource& source, std::size_t offset);
/// The same of some bytes of the file. @param offset  where they begin
void refuse_surplus(const CloudSource& source, std::string_view bytes, std::size_t offset);

}  // namespace umtet::detail
