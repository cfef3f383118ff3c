#include "pipeline/output/view_files.h"

#include <fmt/format.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataWriter.h>

#include <cmath>

#include "body/body.h"
#include "common/polled_loops.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/reports/stage_reports.h"
#include "pipeline/stages/stages.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// psi and |grad psi| in single precision: 16 MB.
constexpr double kMostNodes = 2e6;
constexpr std::size_t kValuesPerPoll = 100'000;

vtkSmartPointer<vtkFloatArray> values(const char* name, std::size_t n) {
  auto array = vtkSmartPointer<vtkFloatArray>::New();
  array->SetName(name);
  array->SetNumberOfValues(static_cast<vtkIdType>(n));
  return array;
}

/// psi at the nodes of a grid that fills the box, in model coordinates.
vtkSmartPointer<vtkImageData> sampled(const Domain& domain, double h) {
  const Vec3 size = domain.box.sizes();
  double spacing = std::max(h / 2, std::cbrt(size.prod() / kMostNodes));
  Eigen::Vector3i n;
  // Round-off and a node more on each axis: a little coarser, until it fits.
  for (;; spacing *= 1.02) {
    n = (size / spacing).array().ceil().cast<int>() + 1;
    if (n.cast<double>().prod() <= kMostNodes) break;
  }
  const Vec3 step = size.cwiseQuotient((n.array() - 1).matrix().cast<double>()), origin = domain.box.min();
  const std::size_t n_nodes = static_cast<std::size_t>(n.x()) * n.y() * n.z();
  const vtkSmartPointer<vtkFloatArray> psi = values("psi", n_nodes), slope = values("grad_psi", n_nodes);
  polled_parallel_for(n_nodes, kValuesPerPoll, until_interrupted(), [&](std::size_t k) {
    const std::size_t row = k / n.x(), layer = row / n.y();
    const Vec3 at(static_cast<double>(k % n.x()), static_cast<double>(row % n.y()), static_cast<double>(layer));
    Vec3 g;
    psi->SetValue(static_cast<vtkIdType>(k), static_cast<float>(domain.psi().value(origin + at.cwiseProduct(step), g)));
    slope->SetValue(static_cast<vtkIdType>(k), static_cast<float>(g.norm()));
  });
  const Vec3 shown = origin + domain.shift;
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(n.data());
  image->SetOrigin(shown.data());
  image->SetSpacing(step.data());
  image->GetPointData()->SetScalars(psi);
  image->GetPointData()->AddArray(slope);
  return image;
}

/// psi = 0 of the grid, then one step y = x - psi grad psi / |grad psi|^2 a vertex, of at most half a cell.
vtkSmartPointer<vtkPolyData> zero_surface(vtkImageData* image, const Domain& domain) {
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(image);
  contour->SetValue(0, 0);
  contour->ComputeNormalsOff();
  contour->ComputeScalarsOff();
  contour->Update();
  vtkSmartPointer<vtkPolyData> surface = contour->GetOutput();
  const vtkIdType n = surface->GetNumberOfPoints();
  const double reach = Vec3(image->GetSpacing()).norm() / 2;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const vtkSmartPointer<vtkFloatArray> slope = values("grad_psi", static_cast<std::size_t>(n));
  for (vtkIdType i = 0; i < n; ++i) {
    Vec3 x;
    surface->GetPoint(i, x.data());
    Vec3 g;
    const double value = domain.psi().value(x - domain.shift, g);
    const Vec3 step = -value / g.squaredNorm() * g;
    if (step.norm() <= reach) x += step;
    points->InsertNextPoint(x.data());
    slope->SetValue(i, static_cast<float>(g.norm()));
  }
  surface->SetPoints(points);
  surface->GetPointData()->AddArray(slope);
  return surface;
}

/// Into memory: VTK's writers report success on a full disk, write_text_artefact() does not.
template <class Writer>
void write_vtk(const fs::path& file, vtkDataObject* data) {
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  writer->SetWriteToOutputString(true);
  writer->SetDataModeToBinary();
  writer->SetHeaderTypeToUInt64();
  if (!writer->Write()) throw std::runtime_error(file.string() + ": VTK could not write it");
  write_text_artefact(file, writer->GetOutputString());
}

/// A path as Python reads it: JSON's escapes are Python's too.
std::string python_text(const fs::path& path) {
  return Json(fs::absolute(path).lexically_normal().string()).dump(-1, ' ', true, Json::error_handler_t::replace);
}

constexpr const char* kScript = R"(# umtet view: the stages of a case in ParaView.  paraview --script=view.py
import os
from paraview.simple import *

case = {case}
def path(name):
    return os.path.join(case, name)
def shown(source, name, **properties):
    RenameSource(name, source)
    display = Show(source, view)
    for key, value in properties.items():
        setattr(display, key, value)
    return display
def coloured(display, association, array):
    ColorBy(display, (association, array))
    display.RescaleTransferFunctionToDataRange(False)

view = GetActiveViewOrCreate("RenderView")
if os.path.exists(path("1-cloud/cloud.ply")):
    shown(PLYReader(FileNames=[path("1-cloud/cloud.ply")]), "1 samples", Representation="Point Gaussian", GaussianRadius={radius})
psi = XMLImageDataReader(FileName=[path("5-view/psi.vti")])
cut = Slice(Input=psi, SliceType="Plane")
cut.SliceType.Origin = {centre}
cut.SliceType.Normal = [0.0, 0.0, 1.0]
coloured(shown(cut, "2 psi, cut", Opacity=0.6), "POINTS", "psi")
zero = XMLPolyDataReader(FileName=[path("5-view/zero.vtp")])
coloured(shown(zero, "2 psi = 0, by slope", Opacity=0.25), "POINTS", "grad_psi")
mesh = XMLUnstructuredGridReader(FileName=[path("3-mesh/mesh.vtu")])
tets = Clip(Input=mesh, ClipType="Plane")
tets.ClipType.Origin = {centre}
tets.ClipType.Normal = [1.0, 0.0, 0.0]
tets.Crinkleclip = 1
coloured(shown(tets, "3 tets behind a cut", Representation="Surface With Edges"), "CELLS", "mean_ratio")
support_radius = {support_radius}
if support_radius is not None:
    # In front of the tets: where no sample is near, up to the line at which the guess begins.
    guessed = Clip(Input=ExtractSurface(Input=mesh), ClipType="Scalar", Scalars=["POINTS", "support"], Value=support_radius, Invert=0)
    coloured(shown(guessed, "3 closed holes, by distance to samples"), "POINTS", "support")
if os.path.exists(path("3-mesh/iterates.pvd")):
    iterates = PVDReader(FileName=path("3-mesh/iterates.pvd"))
    RenameSource("3 iterates", iterates)
    Hide(iterates, view)
ResetCamera(view)
GetActiveCamera().Azimuth(50)
GetActiveCamera().Elevation(20)
Render(view)
)";

}  // namespace

std::vector<fs::path> write_view(const CasePaths& paths, Progress& progress) {
  if (!fs::exists(paths.parameters())) throw UsageError(paths.root.string() + " is not a case: it has no case.toml");
  Parameters parameters;
  parameters.load(paths.parameters(), ParamSource::Case);
  const StageState state = inspect_stage(paths, Stage::Mesh, parameters.section("mesh"), std::nullopt);
  if (state.kind == StageState::Kind::Damaged) throw ArtefactDamaged(state.reason);
  if (!state.record) throw UsageError("nothing to view: " + state.reason + "; umtet mesh makes it");
  const MeshMeasures measured = mesh_report(*state.record).measured;
  const double h = measured.mesh.h;
  const std::optional<SupportReport>& support = measured.domain.support;
  const bool has_holes = support && support->n_closed_holes > 0;
  Domain domain = load_domain(paths, parameters);
  domain.limit_detail(h);
  const fs::path folder = paths.view();
  fs::create_directories(folder);
  remove_stale_temporaries(folder);
  std::vector<fs::path> files;
  files.reserve(kViewFiles.size());
  for (const char* name : kViewFiles) files.push_back(folder / name);
  progress.report("view", "psi", 0);
  const vtkSmartPointer<vtkImageData> image = sampled(domain, h);
  stop_if_interrupted();
  write_vtk<vtkXMLImageDataWriter>(files[0], image);
  progress.report("view", "psi = 0", .6);
  write_vtk<vtkXMLPolyDataWriter>(files[1], zero_surface(image, domain));
  const Vec3 centre = domain.box.center() + domain.shift;
  write_text_artefact(
      files[2],
      fmt::format(fmt::runtime(kScript), fmt::arg("case", python_text(paths.root)),
                  fmt::arg("radius", .002 * domain.diagonal),
                  fmt::arg("support_radius", has_holes ? fmt::format("{:.17g}", support->radius) : "None"),
                  fmt::arg("centre", fmt::format("[{:.17g}, {:.17g}, {:.17g}]", centre.x(), centre.y(), centre.z()))));
  return files;
}

}  // namespace umtet
