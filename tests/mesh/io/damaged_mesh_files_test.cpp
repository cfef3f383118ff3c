// Mesh files that are damaged, lie or cannot be written.

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <random>
#include <system_error>

#include "tests/support/file_size_limit.h"
#include "tests/support/mesh_files.h"

namespace umtet {
namespace {

using namespace test;

// As ParaView writes them. VTK divides by the size of a part before it is compressed.
TEST(TetMeshIo, AppendedBlocksAreReadAndTheirHeadersChecked) {
  const fs::path seeds = fs::path(UMTET_SOURCE_DIR) / "tests/fuzz/seeds/mesh_vtu";
  for (const char* name : {"appended_raw.vtu", "appended_base64.vtu"}) {
    const MeshFile file = read_tet_mesh(seeds / name);
    EXPECT_EQ(file.mesh.C, std::vector<Tet>({{0, 1, 2, 3}})) << name;
    EXPECT_EQ(file.mesh.V.at(3), Vec3(0, 0, 1)) << name;
  }
  for (const char* name :
       {"appended_no_bytes.vtu", "parts_of_no_bytes.vtu", "no_parts_of_no_bytes.vtu", "offset_without_format.vtu"}) {
    const std::string message = refusal(seeds / name);
    EXPECT_NE(message.find("parts of 0 bytes"), std::string::npos) << message;
  }
  const std::string beyond = refusal(seeds / "last_offset.vtu");
  EXPECT_NE(beyond.find("more than the file can hold"), std::string::npos) << beyond;
  const std::string damaged = refusal(seeds / "damaged_cell_data.vtu");  // and has no point data
  EXPECT_NE(damaged.find("VTK cannot read it"), std::string::npos) << damaged;
  const std::string text = bytes_of(seeds / "appended_raw.vtu");
  // What the parser behind VTK sees otherwise than a search for letters would.
  const std::vector<std::array<std::string, 3>> hidden = {
      {"offset=\"96\"", "Note=\"a offset='96'\" offset=\"97\"", "more parts than bytes"},
      {"offset=\"96\"", "offset=\"&#57;7\"", "references to characters"},
      {"<Cells>", "<Cells a=\"b>\">", "attributes"},
      {"<Cells>", "<!-- <AppendedData encoding=\"raw\"> --><Cells>", "in a comment"},
      {"<Cells>", "<?x ><AppendedData>_?><Cells>", "in a comment"}};
  for (const auto& [from, to, reason] : hidden) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    const fs::path file = with_bytes("hidden.vtu", changed);
    EXPECT_NE(refusal(file).find(reason), std::string::npos) << to << ": " << refusal(file);
    fs::remove(file);
  }
  // VTK would count offsets from the first byte behind the tag, find other headers there, and believe them: 8 GB.
  const std::string message = refusal(seeds / "appended_beside_underscore.vtu");
  EXPECT_NE(message.find("appended data without a beginning"), std::string::npos) << message;
}

TEST(TetMeshIo, LyingFilesAreRefusedWithPathPlaceAndReason) {
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  const std::string vtu =
      "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4000000000\" NumberOfCells=\"1\">"
      "</Piece></UnstructuredGrid></VTKFile>";
  const std::vector<std::array<std::string, 3>> cases = {
      {"empty.msh", "", "no $MeshFormat"},
      {"empty.mesh", "", "empty"},
      {"empty.vtu", "", "not a VTK XML file"},
      {"huge.msh", head + "$Nodes\n4000000000\n", "more than the file can hold"},
      {"negative.msh", head + "$Nodes\n-5\n", "not a number"},
      {"word.msh", head + "$Nodes\n1\n1 0 zero 0\n", "line 6"},
      {"version.msh", "$MeshFormat\n4 0 8\n$EndMeshFormat\n", "only 2.2 and 4.1"},
      {"missing.msh", head + "$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 4 2 0 0 1 2 3 4\n$EndElements\n",
       "node 2 does not exist"},
      {"twice.msh", head + "$Nodes\n2\n1 0 0 0\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 4 2 0 0 1 1 1 1\n$EndElements\n",
       "given twice"},
      {"huge.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n123456789012\n", "more than the file can hold"},
      {"flat.mesh", "MeshVersionFormatted 2\nDimension 2\n", "must be 3"},
      {"none.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nEnd\n", "no tets"},
      {"huge.vtu", vtu, "more than the file can hold"},
      {"nest.vtu", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid></VTKFile>", "do not nest"},
      {"other.vtu", "<VTKFile type=\"PolyData\"></VTKFile>", "UnstructuredGrid"},
      {"what.stl", "solid", "unknown extension"}};
  for (const auto& [name, bytes, reason] : cases) {
    const fs::path path = with_bytes(name, bytes);
    const std::string message = refusal(path);
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_NE(message.find(path.string()), std::string::npos) << message;
    fs::remove(path);
  }
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

TEST(ReadTetMesh, ATetWithANodeTwiceAndANodeWithoutAPlaceAreNamed) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("umtet_broken_" + std::to_string(::getpid()) + ".mesh");
  const auto refusal = [&](const std::string& third, const std::string& tet) {
    std::ofstream(file) << "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n9 9 nan 0\n0 0 0 0\n1 0 0 0\n"
                        << third << " 0\n0 0 1 0\nTetrahedra\n1\n"
                        << tet << " 1\nEnd\n";
    try {
      read_tet_mesh(file);
    } catch (const MeshFileRefused& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal("0 1 0", "2 3 4 5"), "accepted");  // node 1 is no number, but in no tet
  EXPECT_NE(refusal("0 1 0", "2 3 4 4").find("tet 1: it has its node 4 twice"), std::string::npos);
  EXPECT_NE(refusal("0 inf 0", "2 3 4 5").find("node 4: a coordinate is not"), std::string::npos);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace umtet
