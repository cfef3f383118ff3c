#include "distributed/io/part_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <system_error>

#include "distributed/exchange/collect.h"
#include "distributed/solver/ghost_tets.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/universal_mesh.h"
#include "tests/distributed/ranks.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;
using testing::AnalyticDomain;
using testing::rank;

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A folder that all ranks know, gone at the end.
class PartFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    int id = ::getpid();
    MPI_Bcast(&id, 1, MPI_INT, 0, MPI_COMM_WORLD);
    folder_ = fs::temp_directory_path() / ("umtet_part_files_" + std::to_string(id));
    fs::create_directories(folder_);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  void TearDown() override {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0) fs::remove_all(folder_);
    MPI_Barrier(MPI_COMM_WORLD);
  }

  fs::path folder_;
};

BackgroundMesh lattice_for(const AnalyticDomain& domain, double h) {
  const Vec3 more = Vec3::Constant(3 * h);
  return {a15(), Box(domain.box.min() - more, domain.box.max() + more), h};
}

MeshFile whole_mesh(const BackgroundMesh& background, const AnalyticDomain& domain) {
  const UmResult one = universal_mesh(background, domain, {});
  return with_standard_data({one.final, one.submesh.mesh.C}, one.submesh.background_vertex, one.submesh.background_tet);
}

TEST_F(PartFiles, TheWholeFileIsThatOfOneProcess) {
  // Sizes that leave other remainders of three, and pieces that end elsewhere: 46 tets to 200,000.
  for (const double h : {.9, .5, .31, .2, .11, .06}) {
    SCOPED_TRACE(h);
    const AnalyticDomain domain = testing::sphere();
    const BackgroundMesh background = lattice_for(domain, h);
    const DistributedMesh part = distributed_mesh(MPI_COMM_WORLD, background, domain);
    ASSERT_EQ(part.status, PartsStatus::Success);
    write_whole_vtu(MPI_COMM_WORLD, folder_ / "parts.vtu", part);
    if (rank() != 0) continue;
    write_vtu(folder_ / "one.vtu", whole_mesh(background, domain));
    EXPECT_TRUE(bytes_of(folder_ / "parts.vtu") == bytes_of(folder_ / "one.vtu"));
  }
}

TEST_F(PartFiles, ValuesOfSomeVerticesAreInTheFileOfOneProcess) {
  const AnalyticDomain domain = testing::torus();
  for (const double h : {.31, .1}) {
    const BackgroundMesh background = lattice_for(domain, h);
    const DistributedMesh part = distributed_mesh(MPI_COMM_WORLD, background, domain);
    // Of vertices with positive faces here; others may have them without.
    VertexValues values{{{"scan_rgb", 3, -2, {}}, {"support", 1, -1, {}}}, std::vector<char>(part.mesh.V.size(), 0)};
    for (const Triangle& f : part.positive_faces)
      for (const int v : f) values.has[v] = 1;
    for (const Vec3& x : part.mesh.V) {
      values.arrays[0].values.insert(values.arrays[0].values.end(), x.begin(), x.end());
      values.arrays[1].values.push_back(x.norm());
    }
    write_whole_vtu(MPI_COMM_WORLD, folder_ / "parts.vtu", part, nullptr, values);
    if (rank() != 0) continue;
    const UmResult one = universal_mesh(background, domain, {});
    MeshFile whole = whole_mesh(background, domain);
    std::vector<Vec3> places(whole.mesh.V.size(), Vec3::Constant(-2));
    std::vector<double> norms(whole.mesh.V.size(), -1);
    for (const int v : one.submesh.positive_vertices) places[v] = whole.mesh.V[v], norms[v] = whole.mesh.V[v].norm();
    whole.point_data["scan_rgb"] = places;
    whole.point_data["support"] = norms;
    write_vtu(folder_ / "one.vtu", whole);
    EXPECT_TRUE(bytes_of(folder_ / "parts.vtu") == bytes_of(folder_ / "one.vtu"));
  }
}

TEST_F(PartFiles, ALongerFileThatWasThereIsCut) {
  const AnalyticDomain domain = testing::sphere();
  const BackgroundMesh background = lattice_for(domain, .4);
  if (rank() == 0) std::ofstream(folder_ / "parts.vtu") << std::string(10'000'000, 'x');
  MPI_Barrier(MPI_COMM_WORLD);
  write_whole_vtu(MPI_COMM_WORLD, folder_ / "parts.vtu", distributed_mesh(MPI_COMM_WORLD, background, domain));
  if (rank() != 0) return;
  write_vtu(folder_ / "one.vtu", whole_mesh(background, domain));
  EXPECT_TRUE(bytes_of(folder_ / "parts.vtu") == bytes_of(folder_ / "one.vtu"));
}

TEST_F(PartFiles, PiecesAreTheWholeTogether) {
  AnalyticDomain domain = testing::torus();
  domain.box = Box(domain.box.min(), domain.box.max() + Vec3::Constant(4));  // leaves ranks without tets
  const BackgroundMesh background = lattice_for(domain, .15);
  const DistributedMesh part = distributed_mesh(MPI_COMM_WORLD, background, domain);
  const std::vector<fs::path> files = write_pvtu(MPI_COMM_WORLD, folder_ / "mesh.pvtu", part);
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() != 0) return;
  const MeshFile whole = whole_mesh(background, domain);
  const auto ids = [](const std::map<std::string, FieldValues>& data, const char* name) {
    return std::get<std::vector<std::int64_t>>(data.at(name));
  };
  const auto& vertex_ids = std::get<std::vector<std::int64_t>>(whole.point_data.at("background_vertex"));
  std::set<std::int64_t> tets;
  std::map<std::int64_t, std::int64_t> owners;
  const std::string list = bytes_of(files.back());
  for (std::size_t f = 0; f + 1 < files.size(); ++f) {
    EXPECT_NE(list.find("Source=\"" + files[f].filename().string() + "\""), std::string::npos);
    const MeshFile piece = read_tet_mesh(files[f]);
    const auto vertex = ids(piece.point_data, "global_vertex"), tet = ids(piece.cell_data, "global_tet");
    const auto background_vertex = ids(piece.point_data, "background_vertex"), owner = ids(piece.point_data, "owner");
    for (std::size_t v = 0; v < vertex.size(); ++v) {
      ASSERT_LT(static_cast<std::size_t>(vertex[v]), whole.mesh.V.size());
      EXPECT_EQ(piece.mesh.V[v], whole.mesh.V[static_cast<std::size_t>(vertex[v])]);
      EXPECT_EQ(background_vertex[v], vertex_ids[static_cast<std::size_t>(vertex[v])]);
      EXPECT_EQ(owners.emplace(vertex[v], owner[v]).first->second, owner[v]);
    }
    for (std::size_t t = 0; t < tet.size(); ++t) {
      EXPECT_TRUE(tets.insert(tet[t]).second);
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_EQ(vertex[static_cast<std::size_t>(piece.mesh.C[t][k])],
                  whole.mesh.C[static_cast<std::size_t>(tet[t])][k]);
    }
  }
  EXPECT_EQ(tets.size(), whole.mesh.C.size());
  EXPECT_EQ(owners.size(), whole.mesh.V.size());
}

TEST_F(PartFiles, PartsForGmshAreTheWholeTogether) {
  AnalyticDomain domain = testing::torus();
  domain.box = Box(domain.box.min(), domain.box.max() + Vec3::Constant(4));  // leaves ranks without tets
  const BackgroundMesh background = lattice_for(domain, .15);
  const DistributedMesh part = distributed_mesh(MPI_COMM_WORLD, background, domain);
  const std::vector<fs::path> files = write_msh_pieces(MPI_COMM_WORLD, folder_ / "part.msh", part);
  const std::size_t n_ghosts = ghost_tets(MPI_COMM_WORLD, part, solver_part(MPI_COMM_WORLD, part)).size();
  std::vector<std::size_t> sizes;
  if (!part.mesh.C.empty()) sizes.push_back(part.mesh.C.size() + n_ghosts);
  sizes = gathered(MPI_COMM_WORLD, sizes);
  if (rank() != 0) return;
  const MeshFile whole = whole_mesh(background, domain);
  ASSERT_EQ(files.size(), sizes.size());
  std::set<std::array<double, 3>> places;
  for (std::size_t f = 0; f < files.size(); ++f) {
    EXPECT_EQ(files[f].filename(), "part_" + std::to_string(f + 1) + ".msh");
    const MeshFile piece = read_tet_mesh(files[f]);  // ghosts among its tets
    EXPECT_EQ(piece.mesh.C.size(), sizes[f]);
    for (const Vec3& x : piece.mesh.V) places.insert({x.x(), x.y(), x.z()});
  }
  EXPECT_EQ(places.size(), whole.mesh.V.size());
}

TEST_F(PartFiles, AFileThatCannotBeWrittenIsKnownToAll) {
  const AnalyticDomain domain = testing::sphere();
  const DistributedMesh part = distributed_mesh(MPI_COMM_WORLD, lattice_for(domain, .4), domain);
  EXPECT_THROW(write_whole_vtu(MPI_COMM_WORLD, folder_ / "nowhere" / "mesh.vtu", part), std::system_error);
  EXPECT_THROW(write_pvtu(MPI_COMM_WORLD, folder_ / "nowhere" / "mesh.pvtu", part), std::system_error);
  EXPECT_THROW(write_msh_pieces(MPI_COMM_WORLD, folder_ / "nowhere" / "mesh.msh", part), std::system_error);
}

}  // namespace
}  // namespace umtet
