// Mesh files that are damaged or cannot be written; tests/corpus has those that lie.

#include <gtest/gtest.h>

#include <random>
#include <system_error>

#include "tests/support/file_size_limit.h"
#include "tests/support/mesh_files.h"

namespace umtet {
namespace {

using namespace test;

TEST(TetMeshIo, AppendedBlocksAreRead) {
  for (const char* name : {"appended_raw.vtu", "appended_base64.vtu"}) {
    const MeshFile file = read_tet_mesh(fs::path(UMTET_SOURCE_DIR) / "tests/corpus/files/mesh_vtu" / name);
    EXPECT_EQ(file.mesh.C, std::vector<Tet>({{0, 1, 2, 3}})) << name;
    EXPECT_EQ(file.mesh.V.at(3), Vec3(0, 0, 1)) << name;
  }
}

TEST(TetMeshIo, AFileThatIsNotThereIsASystemError) {
  EXPECT_THROW(read_tet_mesh("/nowhere/a.msh"), std::system_error);
  EXPECT_THROW(read_tet_mesh("/nowhere/a.vtu"), std::system_error);
}

TEST(TetMeshIo, ACutFileIsRefusedAndADamagedOneNeverCrashes) {
  const Shape shape = sample(1);
  std::mt19937 random(11);
  ::testing::internal::CaptureStderr();
  for (const Format& format : formats()) {
    const fs::path path = scratch(format.name);
    format.write(path, shape);
    const std::string whole = bytes_of(path);
    for (int cut = 0; cut < 24; ++cut) {
      // A MEDIT file that lacks only the closing keyword is complete.
      std::ofstream(path, std::ios::binary) << whole.substr(0, (whole.size() - 8) * cut / 24);
      EXPECT_NE(refusal(path), "accepted") << format.name << " cut " << cut;
    }
    for (int trial = 0; trial < 60; ++trial) {
      std::string damaged = whole;
      for (int hit = 0; hit < 3; ++hit) damaged[random() % damaged.size()] = static_cast<char>(random());
      std::ofstream(path, std::ios::binary) << damaged;
      refusal(path);  // read or refused; anything else would escape or end the program
    }
    fs::remove(path);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "a library does not print";
}

TEST(TetMeshIo, AFullDiskIsAnErrorThatNamesThePath) {
  const Shape shape = sample();
  for (const Format& format : formats()) {
    const fs::path path = scratch(format.name);
    format.write(path, shape);
    // Also one byte short: what is lost then is lost at the close.
    for (const std::uintmax_t limit : {std::uintmax_t{1000}, fs::file_size(path) - 1}) {
      std::string message;
      {
        const test::FileSizeLimit full(limit);
        try {
          format.write(path, shape);
        } catch (const std::runtime_error& e) {
          message = e.what();
        }
      }
      EXPECT_NE(message.find(path.string()), std::string::npos) << format.name << ": '" << message << "'";
    }
    fs::remove(path);
  }
  EXPECT_THROW(write_vtu("/nowhere/a.vtu", {shape.mesh, {}, {}, 0}), std::runtime_error);
}

}  // namespace
}  // namespace umtet
