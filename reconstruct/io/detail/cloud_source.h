#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "common/in_quotes.h"
#include "common/message.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet::detail {

class FileBytes;

/// A cloud file in memory, or its beginning, with its name for messages. The bytes have to outlive every reader.
struct CloudSource {
  std::string name;
  std::string_view bytes;
  bool needs_normals = true;  ///< false: points without normals make a cloud without normals
  /// Number of bytes of the file after `bytes`. The readers need the whole file; check_ply_head() and the like do not.
  std::size_t bytes_left_out = 0;
  FileBytes* rest = nullptr;  ///< reads them block by block (ByteWindow); null: there are none, or all are in memory
  std::string_view columns = {};  ///< the user's description of the columns of a text; empty: none

  std::size_t size() const { return bytes.size() + bytes_left_out; }  ///< size of the file
};

/// The argument `columns` of read_scan(), as messages name it.
inline constexpr Option kColumns{"columns"};

/// Rejects the file. \throw CloudRefused  always: "NAME: what"
[[noreturn]] void refuse(const CloudSource& source, Message what);

/// Checks the end of the data. \throw CloudRefused for anything but blanks and NUL padding from `offset` on: a count of
/// the header is then wrong
void refuse_surplus(const CloudSource& source, std::size_t offset);
/// The same for some bytes of the file. @param offset  their position in the file
void refuse_surplus(const CloudSource& source, std::string_view bytes, std::size_t offset);

}  // namespace umtet::detail
