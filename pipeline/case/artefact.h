#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace umtet {

/// Size and XXH3-128 of a file: enough to notice damage, not meant against an adversary.
struct FileStamp {
  std::uintmax_t size = 0;
  std::string xxh3;  ///< 32 hexadecimal digits
  bool operator==(const FileStamp&) const = default;
};

/// XXH3-128 of a text, in the digits of FileStamp.
std::string checksum(std::string_view text);

/// Reads the whole file once, in pieces of 1 MiB. Devices and pipes are refused: some of them have no end.
/// \throw std::system_error naming the file
FileStamp stamp(const std::filesystem::path& file);

/// The stamps of the files that one run deals with: each file is read once, however often its stamp is needed. A file
/// is taken for unchanged while its inode, size and time of change are what they were; it may be renamed meanwhile. Not
/// for several threads at a time.
class FileStamps {
 public:
  /// \throw as stamp()
  FileStamp of(const std::filesystem::path& file) { return of(std::vector{file}).front(); }
  /// Those of several files, which are read at once by all threads. \throw as stamp(), of the first
  std::vector<FileStamp> of(const std::vector<std::filesystem::path>& files);
  /// How often a file was read, by the path at which it was.
  const std::map<std::filesystem::path, int>& n_read() const { return n_read_; }

 private:
  /// One state of one file.
  struct Identity {
    std::uintmax_t device = 0, inode = 0, size = 0;
    std::int64_t seconds = 0, nanoseconds = 0;  ///< of its last change
    auto operator<=>(const Identity&) const = default;
  };
  std::map<Identity, FileStamp> known_;
  std::map<std::filesystem::path, int> n_read_;
};

/// Creates or replaces `file` so that it is, at any moment and after any crash, the old one or the whole new one:
/// `writer` fills a temporary file in the same folder; then size > 0, fsync, rename, fsync of the folder.
///
/// @param writer  gets the path of the temporary file (same extension); reports its own failures by exceptions.
/// \throw std::system_error naming `file`, whatever went wrong on the way; the temporary file is then gone
void write_artefact(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& writer);

/// A file that is to be written, and what fills a temporary file for it.
struct PendingFile {
  std::filesystem::path path;
  std::function<void(const std::filesystem::path&)> write;
};

/// The same for files that belong together: none takes its place before all of them are written and flushed.
void write_artefacts(const std::vector<PendingFile>& files);

/// The same for files that only their writer knows: it fills a temporary folder, and returns the files there in the
/// order in which they take their places in `folder`: data before what refers to it. @return the files in `folder`
std::vector<std::filesystem::path> write_artefacts_in(
    const std::filesystem::path& folder,
    const std::function<std::vector<std::filesystem::path>(const std::filesystem::path& temporary)>& writer);

/// The same for text held in memory; every write is checked.
void write_text_artefact(const std::filesystem::path& file, std::string_view text);

/// Removes what a killed run left in `folder`: the temporary files of write_artefact().
void remove_stale_temporaries(const std::filesystem::path& folder);

/// \throw std::system_error naming the file; also for what is not a regular file
std::string read_text(const std::filesystem::path& file);

/// Lists, parameters and viewpoints are written by hand or by a line of shell: what is larger is something else, given
/// by mistake, and not worth its memory.
inline constexpr std::uintmax_t kLargestText = 16 << 20;
bool is_too_large_a_text(const std::filesystem::path& file);

}  // namespace umtet
