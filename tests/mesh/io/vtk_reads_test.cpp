// VTK reads every kind of file that we write in its formats, and finds the same numbers.

#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPUnstructuredGridReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "mesh/second_order/quadratic_tets.h"
#include "reconstruct/io/image_io.h"
#include "reconstruct/io/level_set_io.h"
#include "tests/support/domains.h"
#include "tests/support/mesh_files.h"

namespace umtet {
namespace {

using namespace test;

/// The output of a reader of VTK.
template <class Reader>
vtkSmartPointer<std::remove_pointer_t<decltype(std::declval<Reader>().GetOutput())>> read(const fs::path& path) {
  vtkNew<Reader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  EXPECT_EQ(reader->GetErrorCode(), 0u) << path;
  return reader->GetOutput();
}

void expect_points(vtkPointSet* grid, const std::vector<Vec3>& V) {
  ASSERT_EQ(grid->GetNumberOfPoints(), static_cast<vtkIdType>(V.size()));
  for (std::size_t i = 0; i < V.size(); ++i) {
    Vec3 x;
    grid->GetPoint(static_cast<vtkIdType>(i), x.data());
    EXPECT_EQ(x, V[i]) << i;
  }
}

template <std::size_t n>
void expect_cells(vtkUnstructuredGrid* grid, const std::vector<std::array<int, n>>& C, int type) {
  ASSERT_EQ(grid->GetNumberOfCells(), static_cast<vtkIdType>(C.size()));
  vtkNew<vtkIdList> ids;
  for (std::size_t t = 0; t < C.size(); ++t) {
    EXPECT_EQ(grid->GetCellType(static_cast<vtkIdType>(t)), type);
    grid->GetCellPoints(static_cast<vtkIdType>(t), ids);
    ASSERT_EQ(ids->GetNumberOfIds(), static_cast<vtkIdType>(n));
    for (std::size_t k = 0; k < n; ++k) EXPECT_EQ(ids->GetId(static_cast<vtkIdType>(k)), C[t][k]);
  }
}

void expect_data(vtkFieldData* data, const std::map<std::string, FieldValues>& expected) {
  for (const auto& [name, any] : expected) {
    vtkDataArray* array = data->GetArray(name.c_str());
    ASSERT_TRUE(array) << name;
    std::visit(
        [&, &name = name](const auto& values) {
          ASSERT_EQ(array->GetNumberOfTuples(), static_cast<vtkIdType>(values.size())) << name;
          for (std::size_t i = 0; i < values.size(); ++i) {
            const auto at = static_cast<vtkIdType>(i);
            if constexpr (std::is_same_v<std::decay_t<decltype(values[i])>, Vec3>) {
              const double* x = array->GetTuple3(at);
              EXPECT_EQ(Vec3(x[0], x[1], x[2]), values[i]) << name;
            } else if constexpr (std::is_same_v<std::decay_t<decltype(values[i])>, std::int64_t>) {
              EXPECT_EQ(array->GetVariantValue(at).ToTypeInt64(), values[i]) << name;
            } else {
              EXPECT_EQ(array->GetTuple1(at), values[i]) << name;
            }
          }
        },
        any);
  }
}

MeshFile with_data() {
  const Shape shape = sample();
  std::vector<std::int64_t> vertex(shape.mesh.V.size()), tet(shape.mesh.C.size());
  for (std::size_t i = 0; i < vertex.size(); ++i) vertex[i] = (std::int64_t{1} << 60) + static_cast<std::int64_t>(i);
  MeshFile file = with_standard_data(shape.mesh, vertex, tet);
  file.point_data["a \"name\" <&>"] = shape.mesh.V;
  return file;
}

TEST(VtkReads, AMeshWithItsData) {
  const MeshFile file = with_data();
  const fs::path path = scratch("vtk.vtu");
  write_vtu(path, file);
  const auto grid = read<vtkXMLUnstructuredGridReader>(path);
  expect_points(grid, file.mesh.V);
  expect_cells(grid.Get(), file.mesh.C, VTK_TETRA);
  expect_data(grid->GetPointData(), file.point_data);
  expect_data(grid->GetCellData(), file.cell_data);
  fs::remove(path);
}

TEST(VtkReads, AMeshOfSecondOrder) {
  const QuadraticTetMesh mesh = quadratic_tets(sample().mesh, {}, testing::sphere(), 1).mesh;
  const std::map<std::string, FieldValues> of_points = {{"place", mesh.V}};
  const fs::path path = scratch("vtk_second.vtu");
  write_vtu(path, mesh, of_points, {});
  const auto grid = read<vtkXMLUnstructuredGridReader>(path);
  expect_points(grid, mesh.V);
  expect_cells(grid.Get(), mesh.C, VTK_QUADRATIC_TETRA);
  expect_data(grid->GetPointData(), of_points);
  fs::remove(path);
}

TEST(VtkReads, ABoundaryWithTheNumbersOfItsPatches) {
  const SolverMesh mesh = solver_mesh(sample().mesh);
  const fs::path path = scratch("vtk_boundary.vtu");
  write_boundary_vtu(path, mesh);
  const auto grid = read<vtkXMLUnstructuredGridReader>(path);
  expect_points(grid, mesh.nodes);
  ASSERT_EQ(grid->GetNumberOfCells(), static_cast<vtkIdType>(mesh.n_faces()));
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> ids = mesh.face(f);
    vtkNew<vtkIdList> found;
    grid->GetCellPoints(static_cast<vtkIdType>(f), found);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(found->GetId(k), ids[static_cast<std::size_t>(k)]);
  }
  vtkDataArray* number = grid->GetFieldData()->GetArray(mesh.patches[0].name.c_str());
  ASSERT_TRUE(number);
  EXPECT_EQ(number->GetTuple1(0), mesh.patches[0].number);
  fs::remove(path);
}

TEST(VtkReads, PiecesOfAParallelMesh) {
  const SolverMesh mesh = solver_mesh(sample().mesh);
  const fs::path piece = scratch("vtk_piece.vtu"), whole = scratch("vtk_whole.pvtu");
  write_vtu_piece(piece, mesh);
  write_pvtu(whole, mesh, piece.filename());
  vtkNew<vtkXMLPUnstructuredGridReader> reader;
  reader->SetFileName(whole.c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  expect_points(grid, mesh.nodes);
  EXPECT_EQ(grid->GetNumberOfCells(), static_cast<vtkIdType>(mesh.n_tets()));
  EXPECT_TRUE(grid->GetPointData()->HasArray("global_vertex"));
  EXPECT_TRUE(grid->GetCellData()->HasArray("global_tet"));
  fs::remove(piece);
  fs::remove(whole);
}

TEST(VtkReads, PointsWithTheirData) {
  const Shape shape = sample();
  const std::map<std::string, FieldValues> data = {{"x", std::vector<double>(shape.mesh.V.size(), 7.5)}};
  const fs::path path = scratch("vtk.vtp");
  write_vtp(path, shape.mesh.V, data);
  const auto points = read<vtkXMLPolyDataReader>(path);
  expect_points(points, shape.mesh.V);
  EXPECT_EQ(points->GetNumberOfVerts(), static_cast<vtkIdType>(shape.mesh.V.size()));
  expect_data(points->GetPointData(), data);
  fs::remove(path);
}

TEST(VtkReads, AnImage) {
  Image image{{3, 4, 5}, {1, 2, 3}, {.5, .25, .125}, {{"a", std::vector<float>(60)}, {"b", std::vector<float>(60)}}};
  for (std::size_t i = 0; i < 60; ++i) image.values[0].second[i] = static_cast<float>(i) / 7;
  const fs::path path = scratch("vtk.vti");
  write_image(path, image);
  const auto grid = read<vtkXMLImageDataReader>(path);
  EXPECT_EQ(Vec3(grid->GetOrigin()), image.origin);
  EXPECT_EQ(Vec3(grid->GetSpacing()), image.spacing);
  auto* a = vtkFloatArray::SafeDownCast(grid->GetPointData()->GetScalars());
  ASSERT_TRUE(a && a->GetNumberOfTuples() == 60);
  EXPECT_STREQ(a->GetName(), "a");
  for (vtkIdType i = 0; i < 60; ++i) EXPECT_EQ(a->GetValue(i), image.values[0].second[static_cast<std::size_t>(i)]);
  fs::remove(path);
}

TEST(VtkReads, ALevelSet) {
  // Of version 0.9, in base64: read and written again.
  const LevelSet psi = read_level_set(fs::path(UMTET_SOURCE_DIR) / "tests/corpus/files/level_set/one.vti");
  const fs::path path = scratch("vtk_level_set.vti");
  write_level_set(path, psi);
  const auto grid = read<vtkXMLImageDataReader>(path);
  auto* a = vtkDoubleArray::SafeDownCast(grid->GetPointData()->GetArray("psi_a"));
  const std::vector<double>& coefficients = psi.coarsest().coefficients;
  ASSERT_TRUE(a && a->GetNumberOfTuples() == static_cast<vtkIdType>(coefficients.size()));
  for (std::size_t i = 0; i < coefficients.size(); ++i)
    EXPECT_EQ(a->GetValue(static_cast<vtkIdType>(i)), coefficients[i]);
  vtkDataArray* lattice = grid->GetFieldData()->GetArray("lattice");
  ASSERT_TRUE(lattice);
  EXPECT_EQ(lattice->GetComponent(3, 0), psi.coarsest().lattice.h);
  fs::remove(path);
}

}  // namespace
}  // namespace umtet
