#include "pipeline/case/artefact.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

namespace umtet {
namespace {
namespace fs = std::filesystem;

class Artefact : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  std::size_t n_files() const { return std::distance(fs::directory_iterator(folder), {}); }
  const fs::path folder = fs::temp_directory_path() / ("umtet artefact " + std::to_string(::getpid()));
  const fs::path file = folder / "a.txt";
};

TEST_F(Artefact, IsReplacedAsAWhole) {
  write_text_artefact(file, "first");
  write_text_artefact(file, "second");
  EXPECT_EQ(read_text(file), "second");
  EXPECT_EQ(n_files(), 1u);
}

TEST_F(Artefact, DevicesAndPipesAreNotRead) {
  EXPECT_THROW(stamp("/dev/zero"), std::system_error);
  EXPECT_THROW(read_text("/dev/zero"), std::system_error);
  ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);  // opening it would wait for a writer
  EXPECT_THROW(stamp(file), std::system_error);
}

TEST_F(Artefact, FailureOfTheWriterKeepsTheOldFileAndNamesIt) {
  write_text_artefact(file, "old");
  try {
    write_artefact(file, [](const fs::path& temporary) {
      std::ofstream(temporary) << "half of the new";
      throw std::runtime_error("disk on fire");
    });
    FAIL();
  } catch (const std::system_error& e) {
    EXPECT_NE(std::string(e.what()).find(file.string()), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("disk on fire"), std::string::npos) << e.what();
  }
  EXPECT_EQ(read_text(file), "old");
  EXPECT_EQ(n_files(), 1u);
}

TEST_F(Artefact, AnEmptyOrMissingResultIsAFailure) {
  EXPECT_THROW(write_artefact(file, [](const fs::path& t) { std::ofstream empty(t); }), std::system_error);
  EXPECT_THROW(write_artefact(file, [](const fs::path&) {}), std::system_error);
  EXPECT_EQ(n_files(), 0u);
}

TEST_F(Artefact, AFullDiskIsAFailureThatKeepsTheOldFile) {
  write_text_artefact(file, "old");
  // A limit on the file size makes write() fail half-way, as a full disk does.
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 64 << 10;
  setrlimit(RLIMIT_FSIZE, &small);
  std::error_code code;
  try {
    write_text_artefact(file, std::string(1 << 20, 'x'));
  } catch (const std::system_error& e) {
    code = e.code();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(code, std::errc::file_too_large);
  EXPECT_EQ(read_text(file), "old");
  EXPECT_EQ(n_files(), 1u);
}

TEST_F(Artefact, FilesThatBelongTogetherAppearTogether) {
  const auto text = [](const std::string& content) {
    return [content](const fs::path& path) { std::ofstream(path) << content; };
  };
  const fs::path other = folder / "b.txt";
  EXPECT_THROW(write_artefacts({{file, text("x")}, {other, text("")}}), std::system_error);  // empty: not written
  EXPECT_EQ(n_files(), 0u);
  write_artefacts({{file, text("x")}, {other, text("y")}});
  EXPECT_EQ(read_text(file) + read_text(other), "xy");
  EXPECT_EQ(n_files(), 2u);
}

TEST_F(Artefact, FilesThatTheirWriterAloneKnowsAppearTogether) {
  const auto write = [&](bool fails) {
    return write_artefacts_in(folder, [&](const fs::path& temporary) {
      std::ofstream(temporary / "a") << "new";
      if (fails) throw std::runtime_error("no more");
      std::ofstream(temporary / "b") << "new";
      return std::vector<fs::path>{temporary / "a", temporary / "b"};
    });
  };
  std::ofstream(folder / "a") << "old";
  EXPECT_THROW(write(true), std::runtime_error);
  EXPECT_EQ(read_text(folder / "a"), "old");
  EXPECT_EQ(n_files(), 1u);
  EXPECT_EQ(write(false), (std::vector<fs::path>{folder / "a", folder / "b"}));
  EXPECT_EQ(read_text(folder / "a"), "new");
  EXPECT_EQ(n_files(), 2u);
}

TEST_F(Artefact, AMissingFolderIsNamed) {
  try {
    write_text_artefact(folder / "no" / "a.txt", "x");
    FAIL();
  } catch (const std::system_error& e) {
    EXPECT_EQ(e.code(), std::errc::no_such_file_or_directory);
    EXPECT_NE(std::string(e.what()).find("a.txt"), std::string::npos);
  }
}

TEST_F(Artefact, StampIsXxh3OfTheBytes) {
  write_text_artefact(file, "umtet");
  const FileStamp s = stamp(file);
  EXPECT_EQ(s.size, 5u);
  EXPECT_EQ(s.xxh3.size(), 32u);
  write_text_artefact(file, "umtes");
  EXPECT_NE(stamp(file), s);
  write_text_artefact(file, std::string((1 << 20) + 1, 'a'));  // more than one piece
  EXPECT_EQ(stamp(file).size, (1u << 20) + 1);
  EXPECT_THROW(stamp(folder / "none"), std::system_error);
}

TEST_F(Artefact, OfSeveralFilesThatCannotBeReadTheFirstIsNamed) {
  // While one thread reads the file before it, others come to the last ones.
  std::vector<fs::path> files = {folder / "large"};
  std::ofstream(files.front()) << "x";
  fs::resize_file(files.front(), std::uintmax_t{1} << 28);
  for (int k = 0; k < 15; ++k) files.push_back(folder / ("none_" + std::to_string(k)));
  try {
    FileStamps().of(files);
    FAIL();
  } catch (const std::system_error& e) {
    EXPECT_NE(std::string(e.what()).find("none_0:"), std::string::npos) << e.what();
  }
}

TEST_F(Artefact, StaleTemporariesGoAndOtherFilesStay) {
  write_text_artefact(file, "x");
  std::ofstream(folder / ".tmp-1-mesh.vtu") << "cut";
  fs::create_directory(folder / ".tmp-2");
  std::ofstream(folder / ".tmp-2" / "mesh_0.vtu") << "cut";
  remove_stale_temporaries(folder);
  remove_stale_temporaries(folder / "none");
  EXPECT_EQ(n_files(), 1u);
  EXPECT_TRUE(fs::exists(file));
}

}  // namespace
}  // namespace umtet
