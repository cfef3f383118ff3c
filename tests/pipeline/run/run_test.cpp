// Runs of a case inside this process.

#include "pipeline/run/run.h"

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "tests/support/data_files.h"

namespace umtet {
namespace {
namespace fs = std::filesystem;

struct FilesOfARun : testing::Test {
  FilesOfARun() {
    fs::create_directories(folder);
    fs::copy_file(test::committed_cloud("duck.ply"), cloud);
  }
  ~FilesOfARun() override { fs::remove_all(folder); }

  /// Runs the duck with edges of length h. @return how often each file was read for its checksum, by its name
  std::map<std::string, int> read_by_run(double h) {
    RunRequest request;
    request.case_folder = folder / "case";
    request.source = cloud;
    request.parameters.set("mesh.h", std::to_string(h), ParamSource::Flag, "--h");
    request.parameters.set("cloud.file", cloud.string(), ParamSource::Flag, "test");
    Progress progress(ProgressMode::None, Verbosity::Quiet);
    stages_run = run_case(request, progress).stages_run.size();
    std::map<std::string, int> n_read;
    for (const auto& [file, n] : request.stamps->n_read()) n_read[fs::relative(file, folder).string()] = n;
    return n_read;
  }
  const fs::path folder = fs::temp_directory_path() / ("umtet_run_" + std::to_string(::getpid()));
  const fs::path cloud = folder / "duck.ply";
  std::size_t stages_run = 0;
};

TEST_F(FilesOfARun, AreReadOnceForTheirChecksum) {
  const std::map<std::string, int> files = read_by_run(.16);
  EXPECT_EQ(stages_run, 3u);
  for (const char* file : {"case/1-cloud/cloud.ply", "case/2-level-set/level_set.vti", "case/3-mesh/mesh.vtu",
                           "case/3-mesh/omega_h.vtu", "case/3-mesh/quality.csv"}) {
    EXPECT_EQ(files.count(file), 1u) << file;
  }
  EXPECT_EQ(files.count("duck.ply"), 1u);
  for (const auto& [file, n] : files) EXPECT_EQ(n, 1) << file;
}

/// Counts how often a file is opened while the object lives.
class Opened {
 public:
  explicit Opened(const fs::path& file) : descriptor_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    // Equal events in a row are one, so the events between two openings are watched, too.
    watches_ = ::inotify_add_watch(descriptor_, file.c_str(), IN_OPEN | IN_ACCESS | IN_CLOSE) >= 0;
  }
  ~Opened() { ::close(descriptor_); }
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  bool watches() const { return watches_; }
  int count() const {
    int n = 0;
    inotify_event event = {};  // those of a file have no name behind them
    while (::read(descriptor_, &event, sizeof event) == sizeof event) n += (event.mask & IN_OPEN) != 0 ? 1 : 0;
    return n;
  }

 private:
  int descriptor_;
  bool watches_ = false;
};

TEST_F(FilesOfARun, TheGivenOneIsOpenedOnce) {
  for (const double h : {.16, .14}) {
    const Opened opened(cloud);
    if (!opened.watches()) GTEST_SKIP() << "no inotify";
    read_by_run(h);
    EXPECT_GE(stages_run, 1u);
    EXPECT_EQ(opened.count(), 1) << h;
  }
  const Opened opened(cloud);
  const InputFile input(cloud);
  FileStamps stamps;
  EXPECT_EQ(stamps.of(input), stamp(cloud));
  EXPECT_TRUE(stamps.knows(input));
  EXPECT_EQ(opened.count(), 2) << "the test counts every opening";
}

TEST_F(FilesOfARun, AreReadOnceWhereAMeshIsMadeBesideTheFormerOne) {
  read_by_run(.16);
  const std::map<std::string, int> files = read_by_run(.14);
  EXPECT_EQ(stages_run, 1u);
  EXPECT_EQ(files.count("case/3-mesh/mesh.vtu"), 1u);
  EXPECT_EQ(files.count("case/.next/3-mesh/mesh.vtu"), 1u);
  for (const auto& [file, n] : files) EXPECT_EQ(n, 1) << file;
}

TEST_F(FilesOfARun, ThatChangedSinceTheFormerOneAreNoticed) {
  read_by_run(.16);
  read_by_run(.16);
  EXPECT_EQ(stages_run, 0u);
  const fs::path level_set = folder / "case/2-level-set/level_set.vti";
  const fs::file_time_type time = fs::last_write_time(level_set);
  std::fstream(level_set, std::ios::in | std::ios::out | std::ios::binary).seekp(1000).put('!');
  fs::last_write_time(level_set, time);
  read_by_run(.16);
  EXPECT_GE(stages_run, 1u);
}

TEST_F(FilesOfARun, AreReadAgainWhenTheyChange) {
  FileStamps stamps;
  const FileStamp before = stamps.of(cloud);
  EXPECT_EQ(stamps.of(cloud), before);
  fs::rename(cloud, folder / "other.ply");
  EXPECT_EQ(stamps.of(folder / "other.ply"), before);
  EXPECT_EQ(stamps.n_read().size(), 1u);
  std::ofstream(folder / "other.ply", std::ios::app) << "1 2 3 4 5 6\n";
  EXPECT_NE(stamps.of(folder / "other.ply"), before);
  fs::remove(folder / "other.ply");
  EXPECT_THROW(stamps.of(folder / "other.ply"), std::system_error);
}

}  // namespace
}  // namespace umtet
