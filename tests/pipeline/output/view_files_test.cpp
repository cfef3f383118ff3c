// The built program, from outside: files to look at the stages with, read back by VTK and Python.

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataReader.h>

#include <regex>

#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

TEST_F(Program, ViewShowsPsiAndItsZeros) {
  ASSERT_EQ(run("mesh --implicit x^2+y^2+z^2-1 --box=-1.5,-1.5,-1.5,1.5,1.5,1.5 --h .3 -o ball --no-report").code, 0);
  ASSERT_EQ(run("view ball").code, 0);
  vtkNew<vtkXMLImageDataReader> image;
  image->SetFileName((folder / "ball/5-view/psi.vti").c_str());
  image->Update();
  vtkImageData* grid = image->GetOutput();
  vtkDataArray *psi = grid->GetPointData()->GetArray("psi"), *slope = grid->GetPointData()->GetArray("grad_psi");
  ASSERT_TRUE(psi && slope);
  ASSERT_GT(grid->GetNumberOfPoints(), 1000);
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    const double* x = grid->GetPoint(i);
    const double r = std::hypot(x[0], x[1], x[2]);
    ASSERT_NEAR(psi->GetTuple1(i), r * r - 1, 1e-6);
    ASSERT_NEAR(slope->GetTuple1(i), 2 * r, 1e-6);
  }
  const std::string script = content(folder / "ball/5-view/view.py");
  EXPECT_NE(script.find("Contour(Input=psi, ContourBy=[\"POINTS\", \"psi\"], Isosurfaces=[0.0])"), std::string::npos);
  ASSERT_EQ(run("mesh ball --h .25 --no-report").code, 0);
  EXPECT_FALSE(fs::exists(folder / "ball/5-view")) << "it was of the former mesh";
}

TEST_F(Program, ScriptForParaViewNamesFilesThatAreThere) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 2000 --no-report --keep-iterates --mode paper").code, 0);
  ASSERT_EQ(run("view egg").code, 0);
  // A ParaView of nothing but names: every file a reader is given must be there.
  fs::create_directories(folder / "paraview");
  std::ofstream(folder / "paraview/__init__.py") << "";
  std::ofstream(folder / "paraview/simple.py") << R"(import os, sys
class Thing:
    def __init__(self, **k): self.__dict__.update(k)
    def __getattr__(self, name): return self.__dict__.setdefault(name, Thing())
    def __call__(self, *a, **k): return Thing()
def reader(**k):
    names = k.get("FileNames", k.get("FileName", k.get("FileName")))
    for name in names if isinstance(names, list) else [names]:
        print("reads", os.path.getsize(name), name)
    return Thing()
PLYReader = XMLImageDataReader = XMLUnstructuredGridReader = XMLPolyDataReader = PVDReader = reader
Glyph = GetColorTransferFunction = HideScalarBarIfNotNeeded = Slice = Clip = Contour = GetActiveViewOrCreate = Show = Hide = RenameSource = ColorBy = ResetCamera = Render = GetActiveCamera = Thing()
)";
  const std::string call = "cd / && PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='" + folder.string() + "' /usr/bin/python3 '" +
                           (folder / "egg/5-view/view.py").string() + "' >'" + (folder / "read").string() + "'";
  ASSERT_EQ(std::system(call.c_str()), 0);
  const std::string read = content(folder / "read");
  EXPECT_EQ(std::count(read.begin(), read.end(), '\n'), 6) << read;
  // The script finds the case where it is moved to.
  fs::rename(folder / "egg", folder / "moved");
  const std::string moved = std::regex_replace(call, std::regex("/egg/5-view"), "/moved/5-view");
  EXPECT_EQ(std::system(moved.c_str()), 0);
  fs::rename(folder / "moved", folder / "egg");
  const std::string pvd = content(folder / "egg/3-mesh/iterates.pvd");
  std::vector<std::string> files;
  for (std::size_t at = pvd.find("file=\""); at != std::string::npos; at = pvd.find("file=\"", at + 1)) {
    files.push_back(pvd.substr(at + 6, pvd.find('"', at + 6) - at - 6));
    EXPECT_TRUE(fs::exists(folder / "egg/3-mesh" / files.back())) << files.back();
  }
  ASSERT_EQ(files.size(), 8) << pvd;  // N_P = 5 passes
  EXPECT_EQ(files.front(), "omega_h.vtu");
  EXPECT_EQ(files[1], "pass_1.vtu");
  EXPECT_EQ(files.back(), "mesh.vtu");
}

}  // namespace
}  // namespace umtet
