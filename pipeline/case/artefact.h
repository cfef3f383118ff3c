#pragma once

#include <sys/stat.h>

#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace umtet {

class InputFile;

/// Size and XXH3-128 of a file. They detect damage, not manipulation.
struct FileStamp {
  std::uintmax_t size = 0;
  std::string xxh3;  ///< 32 hexadecimal digits
  bool operator==(const FileStamp&) const = default;
};

/// Returns the XXH3-128 of a text in the digits of FileStamp.
std::string checksum(std::string_view text);

/// Reads the whole file once, in blocks of 1 MiB. Devices and pipes are refused because some of them never end.
/// \throw std::system_error  names the file
FileStamp stamp(const std::filesystem::path& file);

/// Cache of the stamps of the files that a run uses: each file is read once. A file counts as unchanged while its
/// inode, size and time of change stay the same, even if it is renamed. Not thread-safe.
class FileStamps {
 public:
  /// \throw the exceptions of stamp()
  FileStamp of(const std::filesystem::path& file) { return of(std::vector{file}).front(); }
  /// Returns the stamp of the file as it was opened: of the bytes of its head(), and of those after them.
  /// \throw std::system_error
  FileStamp of(const InputFile& file);
  /// Returns the stamps of several files, which all threads read in parallel. \throw the exception of stamp() for
  /// the first file that fails
  std::vector<FileStamp> of(const std::vector<std::filesystem::path>& files);
  /// Returns whether the file has a stamp, which was made from the same state as the file had when it was opened.
  bool knows(const InputFile& file) const;
  /// Returns how often each file was read, by its path at that time.
  const std::map<std::filesystem::path, int>& n_read() const { return n_read_; }

 private:
  /// The identity of a file in one state.
  struct Identity {
    std::uintmax_t device = 0, inode = 0, size = 0;
    std::int64_t seconds = 0, nanoseconds = 0;  ///< time of the last change
    auto operator<=>(const Identity&) const = default;
  };
  static Identity identity_of(const struct stat& status);
  static std::optional<Identity> identity_of(const std::filesystem::path& file);

  std::map<Identity, FileStamp> known_;
  std::map<std::filesystem::path, int> n_read_;
};

/// Creates or replaces `file` atomically: at any moment, and after any crash, it is either the old file or the
/// complete new one. `writer` fills a temporary file in the same folder. Then the size is checked to be > 0, the
/// file is flushed by fsync and renamed, and the folder is flushed by fsync.
///
/// @param writer  receives the path of the temporary file (same extension); reports its own failures by exceptions
/// \throw std::system_error  names `file`, whatever failed; the temporary file has then been removed
void write_artefact(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& writer);

/// A file to write, and the function that fills a temporary file for it.
struct PendingFile {
  std::filesystem::path path;
  std::function<void(const std::filesystem::path&)> write;
};

/// Writes files that belong together: no file is renamed into place before all of them are written and flushed.
void write_artefacts(const std::vector<PendingFile>& files);

/// Writes files whose names only the writer knows. The writer fills a temporary folder and returns its files in the
/// order in which they are moved to `folder`: data before the files that refer to them. @return the files in
/// `folder`
std::vector<std::filesystem::path> write_artefacts_in(
    const std::filesystem::path& folder,
    const std::function<std::vector<std::filesystem::path>(const std::filesystem::path& temporary)>& writer);

/// Writes a text in the same way; every write is checked.
void write_text_artefact(const std::filesystem::path& file, std::string_view text);

/// Removes temporary files of write_artefact() that a killed run left in `folder`.
void remove_stale_temporaries(const std::filesystem::path& folder);

/// Returns the contents of a file. \throw std::system_error  names the file; also thrown if it is not a regular
/// file
std::string read_text(const std::filesystem::path& file);

/// Maximum size of lists, parameters and viewpoints, bytes. They are written by hand or by a line of shell; a
/// larger file has been given by mistake and is not read into memory.
inline constexpr std::uintmax_t kLargestText = 16 << 20;
bool is_too_large_a_text(const std::filesystem::path& file);

}  // namespace umtet
