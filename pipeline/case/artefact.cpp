#include "pipeline/case/artefact.h"

#include <fcntl.h>
#include <oneapi/tbb/parallel_for.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <cerrno>
#include <exception>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "reconstruct/io/input_file.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kTemporaryPrefix = ".tmp-";

[[noreturn]] void fail(int code, const fs::path& file, const std::string& what) {
  // Code 0 would appear as "Success" in the message.
  throw std::system_error(code != 0 ? code : EIO, std::generic_category(), file.string() + ": " + what);
}

/// A file descriptor that names the artefact in its errors.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags, const fs::path& artefact)
      : artefact_(artefact), fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (fd_ < 0) fail(errno, artefact_, "cannot open");
  }
  Descriptor(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }

  std::size_t read(char* buffer, std::size_t n) {
    for (;;) {
      const ssize_t got = ::read(fd_, buffer, n);
      if (got >= 0) return static_cast<std::size_t>(got);
      if (errno != EINTR) fail(errno, artefact_, "cannot read");
    }
  }

  void write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t put = ::write(fd_, text.data(), text.size());
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) fail(put < 0 ? errno : ENOSPC, artefact_, "cannot write");
      text.remove_prefix(static_cast<std::size_t>(put));
    }
  }

  void sync() {
    // EINVAL: the file system does not support fsync (some network and FUSE mounts).
    if (::fsync(fd_) != 0 && errno != EINVAL) fail(errno, artefact_, "cannot flush to disk");
  }

  void close() {
    const int fd = fd_;
    fd_ = -1;
    if (::close(fd) != 0 && errno != EINTR) fail(errno, artefact_, "cannot close");
  }

 private:
  fs::path artefact_;
  int fd_;
};

/// Opens a regular file. Opening a pipe would wait for its writer, and /dev/zero never ends.
Descriptor open_regular(const fs::path& file) {
  std::error_code ignored;
  const fs::file_type type = fs::status(file, ignored).type();
  if (type == fs::file_type::directory) fail(EISDIR, file, "cannot read");
  if (fs::exists(fs::file_status(type)) && type != fs::file_type::regular) {
    fail(EINVAL, file, "is a device or a pipe, not a regular file");
  }
  return Descriptor(file, O_RDONLY, file);
}

std::string digits(XXH128_hash_t hash) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, hash);
  std::string text;
  for (const unsigned char byte : canonical.digest) {
    constexpr char kHex[] = "0123456789abcdef";
    text += kHex[byte >> 4];
    text += kHex[byte & 15];
  }
  return text;
}

/// Returns the stamp of some bytes and of those that follow.
/// @param read  reads up to n bytes from a position on; 0: the end
template <class Read>
FileStamp stamp_of(std::string_view head, const Read& read) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  if (!state) throw std::bad_alloc();
  XXH3_128bits_reset(state.get());
  FileStamp result;
  const auto add = [&](const char* bytes, std::size_t n) {
    XXH3_128bits_update(state.get(), bytes, n);
    result.size += n;
  };
  add(head.data(), head.size());
  std::vector<char> buffer(1 << 20);
  while (const std::size_t n = read(result.size, buffer.data(), buffer.size())) add(buffer.data(), n);
  result.xxh3 = digits(XXH3_128bits_digest(state.get()));
  return result;
}

/// Removes the temporary file unless it has been renamed.
struct TemporaryFile {
  fs::path path;
  ~TemporaryFile() {
    std::error_code ignored;
    if (!path.empty()) fs::remove(path, ignored);
  }
};

fs::path folder_of(const fs::path& file) { return file.parent_path().empty() ? fs::path(".") : file.parent_path(); }

/// Writes a temporary file in the same folder, checks that it is not empty, and flushes it to disk.
std::unique_ptr<TemporaryFile> written_beside(const fs::path& file,
                                              const std::function<void(const fs::path&)>& writer) {
  auto temporary = std::make_unique<TemporaryFile>();
  temporary->path =
      folder_of(file) / (std::string(kTemporaryPrefix) + std::to_string(::getpid()) + "-" + file.filename().string());
  try {
    writer(temporary->path);
  } catch (const std::system_error& e) {
    if (std::string(e.what()).find(file.string()) != std::string::npos) throw;
    const std::error_code code = e.code() ? e.code() : std::make_error_code(std::errc::io_error);
    throw std::system_error(code, file.string() + ": not written: " + e.what());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    fail(EIO, file, std::string("not written: ") + e.what());
  }
  std::error_code status;
  const std::uintmax_t size = fs::file_size(temporary->path, status);
  if (status) fail(status.value(), file, "not written: the temporary file is missing");
  if (size == 0) fail(EIO, file, "not written: the temporary file is empty");
  Descriptor written(temporary->path, O_RDONLY, file);
  written.sync();
  written.close();
  return temporary;
}

void take_place(TemporaryFile& temporary, const fs::path& file) {
  if (::rename(temporary.path.c_str(), file.c_str()) != 0) fail(errno, file, "cannot rename the temporary file");
  temporary.path.clear();
}

/// Flushes the folder of the file to disk, and with it the name of the file.
void sync_folder_of(const fs::path& file) { Descriptor(folder_of(file), O_RDONLY | O_DIRECTORY, file).sync(); }

}  // namespace

std::string checksum(std::string_view text) { return digits(XXH3_128bits(text.data(), text.size())); }

FileStamp stamp(const fs::path& file) {
  Descriptor in = open_regular(file);
  return stamp_of({}, [&in](std::size_t, char* to, std::size_t n) { return in.read(to, n); });
}

FileStamps::Identity FileStamps::identity_of(const struct stat& status) {
  return {status.st_dev, status.st_ino, static_cast<std::uintmax_t>(status.st_size), status.st_mtim.tv_sec,
          status.st_mtim.tv_nsec};
}

std::optional<FileStamps::Identity> FileStamps::identity_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return std::nullopt;
  return identity_of(status);
}

bool FileStamps::knows(const InputFile& file) const { return known_.contains(identity_of(file.status())); }

FileStamp FileStamps::of(const InputFile& file) {
  const Identity identity = identity_of(file.status());
  if (const auto known = known_.find(identity); known != known_.end()) return known->second;
  FileStamp stamp =
      stamp_of(file.head(), [&file](std::size_t at, char* to, std::size_t n) { return file.read(at, to, n); });
  ++n_read_[file.path()];
  return known_[identity] = std::move(stamp);
}

std::vector<FileStamp> FileStamps::of(const std::vector<fs::path>& files) {
  std::vector<FileStamp> stamps(files.size());
  std::vector<Identity> identities(files.size());
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < files.size(); ++i) {
    // The identity before reading: if the file changes meanwhile, it counts as another file the next time.
    const std::optional<Identity> identity = identity_of(files[i]);
    identities[i] = identity.value_or(Identity{});
    const auto known = known_.find(identities[i]);
    if (identity && known != known_.end()) {
      stamps[i] = known->second;
    } else {
      unknown.push_back(i);
    }
  }
  std::vector<std::exception_ptr> thrown(unknown.size());
  tbb::parallel_for(std::size_t{0}, unknown.size(), [&](std::size_t k) {
    try {
      stamps[unknown[k]] = stamp(files[unknown[k]]);
    } catch (...) {
      thrown[k] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : thrown)  // the first of several errors, independent of threads
    if (error) std::rethrow_exception(error);
  for (const std::size_t i : unknown) {
    ++n_read_[files[i]];
    known_[identities[i]] = stamps[i];
  }
  return stamps;
}

void write_artefact(const fs::path& file, const std::function<void(const fs::path&)>& writer) {
  const std::unique_ptr<TemporaryFile> temporary = written_beside(file, writer);
  take_place(*temporary, file);
  sync_folder_of(file);
}

void write_artefacts(const std::vector<PendingFile>& files) {
  std::vector<std::unique_ptr<TemporaryFile>> temporaries;
  temporaries.reserve(files.size());
  for (const PendingFile& file : files) temporaries.push_back(written_beside(file.path, file.write));
  for (std::size_t i = 0; i < files.size(); ++i) take_place(*temporaries[i], files[i].path);
  for (const PendingFile& file : files) sync_folder_of(file.path);
}

std::vector<fs::path> write_artefacts_in(const fs::path& folder,
                                         const std::function<std::vector<fs::path>(const fs::path&)>& writer) {
  const fs::path temporary = folder / (std::string(kTemporaryPrefix) + std::to_string(::getpid()));
  const auto remove = [](const fs::path* f) {
    std::error_code ignored;
    fs::remove_all(*f, ignored);
  };
  const std::unique_ptr<const fs::path, decltype(remove)> guard(&temporary, remove);
  fs::remove_all(temporary);
  fs::create_directories(temporary);
  const std::vector<fs::path> made = writer(temporary);
  for (const fs::path& file : made) {
    Descriptor written(file, O_RDONLY, folder / file.filename());
    written.sync();
    written.close();
  }
  std::vector<fs::path> files;
  for (const fs::path& file : made) {
    files.push_back(folder / file.filename());
    if (::rename(file.c_str(), files.back().c_str()) != 0)
      fail(errno, files.back(), "cannot rename the temporary file");
  }
  if (!files.empty()) sync_folder_of(files.front());
  return files;
}

void write_text_artefact(const fs::path& file, std::string_view text) {
  write_artefact(file, [&](const fs::path& temporary) {
    Descriptor out(temporary, O_WRONLY | O_CREAT | O_TRUNC, file);
    out.write(text);
    out.close();
  });
}

void remove_stale_temporaries(const fs::path& folder) {
  std::error_code missing;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, missing)) {
    if (entry.path().filename().string().starts_with(kTemporaryPrefix)) fs::remove_all(entry.path());
  }
}

bool is_too_large_a_text(const fs::path& file) {
  std::error_code unknown;
  const std::uintmax_t size = fs::file_size(file, unknown);
  return !unknown && size > kLargestText;
}

std::string read_text(const fs::path& file) {
  Descriptor in = open_regular(file);
  std::string text;
  std::array<char, 1 << 16> buffer;
  while (const std::size_t n = in.read(buffer.data(), buffer.size())) text.append(buffer.data(), n);
  return text;
}

}  // namespace umtet
