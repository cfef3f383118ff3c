#include "pipeline/output/view_files.h"

#include <fmt/format.h>

#include <cmath>

#include "body/body.h"
#include "common/polled_loops.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/reports/stage_reports.h"
#include "pipeline/stages/stages.h"
#include "reconstruct/io/image_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// psi and |grad psi| in single precision take 16 MB.
constexpr double kMostNodes = 2e6;
constexpr std::size_t kNodesPerPoll = 100'000;

/// Returns psi at the nodes of a grid that fills the box, in model coordinates.
Image sampled(const Domain& domain, double h) {
  const Vec3 size = domain.box.sizes();
  double spacing = std::max(h / 2, std::cbrt(size.prod() / kMostNodes));
  Eigen::Vector3i n;
  // Because of rounding and one more node per axis, the grid is coarsened a little until it fits.
  for (;; spacing *= 1.02) {
    n = (size / spacing).array().ceil().cast<int>() + 1;
    if (n.cast<double>().prod() <= kMostNodes) break;
  }
  const Vec3 step = size.cwiseQuotient((n.array() - 1).matrix().cast<double>()), origin = domain.box.min();
  const std::size_t n_nodes = static_cast<std::size_t>(n.x()) * n.y() * n.z();
  std::vector<float> psi(n_nodes), slope(n_nodes);
  polled_parallel_for(n_nodes, kNodesPerPoll, until_interrupted(), [&](std::size_t k) {
    const std::size_t row = k / n.x(), layer = row / n.y();
    const Vec3 at(static_cast<double>(k % n.x()), static_cast<double>(row % n.y()), static_cast<double>(layer));
    Vec3 g;
    psi[k] = static_cast<float>(domain.psi().value(origin + at.cwiseProduct(step), g));
    slope[k] = static_cast<float>(g.norm());
  });
  return {n, origin + domain.shift, step, {{"psi", std::move(psi)}, {"grad_psi", std::move(slope)}}};
}

/// Returns a path as a Python string: Python understands the escapes of JSON.
std::string python_text(const fs::path& path) {
  return Json(fs::absolute(path).lexically_normal().string()).dump(-1, ' ', true, Json::error_handler_t::replace);
}

constexpr const char* kScript = R"(# umtet view: the stages of a case in ParaView.  paraview --script=view.py
import os
from paraview.simple import *

# The case may have been moved since: the folder around this script counts, where ParaView tells it.
case = {case}
try:
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    if os.path.exists(os.path.join(here, "5-view/psi.vti")):
        case = here
except NameError:
    pass
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
    display.SetScalarBarVisibility(view, True)
def hidden(source, name, association, array):
    coloured(shown(source, name), association, array)
    HideScalarBarIfNotNeeded(GetColorTransferFunction(array), view)
    Hide(source, view)

view = GetActiveViewOrCreate("RenderView")
if os.path.exists(path("1-cloud/cloud.ply")):
    shown(PLYReader(FileNames=[path("1-cloud/cloud.ply")]), "1 samples", Representation="Point Gaussian", GaussianRadius={radius})
if os.path.exists(path("1-cloud/marked.vtp")):
    hidden(XMLPolyDataReader(FileName=[path("1-cloud/marked.vtp")]), "1 samples dropped, turned, doubted", "POINTS", "mark")
psi = XMLImageDataReader(FileName=[path("5-view/psi.vti")])
cut = Slice(Input=psi, SliceType="Plane")
cut.SliceType.Origin = {centre}
cut.SliceType.Normal = [0.0, 0.0, 1.0]
coloured(shown(cut, "2 psi, cut", Opacity=0.6), "POINTS", "psi")
zero = Contour(Input=psi, ContourBy=["POINTS", "psi"], Isosurfaces=[0.0])
coloured(shown(zero, "2 psi = 0, by slope", Opacity=0.25), "POINTS", "grad_psi")
for name in ("2-level-set/features.vtp", "3-mesh/features.vtp"):
    if os.path.exists(path(name)):
        hidden(XMLPolyDataReader(FileName=[path(name)]), name[0] + " sharp edges", "CELLS", "angle_deg")
for name, title in (("3-mesh/omega_h.vtu", "3 chosen tets"), ("3-mesh/projected.vtu", "3 projected tets")):
    if os.path.exists(path(name)):
        hidden(XMLUnstructuredGridReader(FileName=[path(name)]), title, "CELLS", "mean_ratio")
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
if os.path.exists(path("3-mesh/defects.vtp")):
    # Spheres as wide as the defects.
    defects = Glyph(Input=XMLPolyDataReader(FileName=[path("3-mesh/defects.vtp")]), GlyphType="Sphere")
    defects.ScaleArray = ["POINTS", "size_over_h"]
    defects.ScaleFactor = {h}
    defects.GlyphMode = "All Points"
    coloured(shown(defects, "3 defects", Opacity=0.4), "POINTS", "kind")
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
  if (!fs::exists(paths.parameters()))
    throw UsageError(paths.root.string() + " is not a case: it contains no case.toml");
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
  const Image image = sampled(domain, h);
  stop_if_interrupted();
  write_artefact(files[0], [&](const fs::path& path) { write_image(path, image); });
  const Vec3 centre = domain.box.center() + domain.shift;
  write_text_artefact(
      files[1],
      fmt::format(fmt::runtime(kScript), fmt::arg("case", python_text(paths.root)),
                  fmt::arg("radius", .002 * domain.diagonal), fmt::arg("h", h),
                  fmt::arg("support_radius", has_holes ? fmt::format("{:.17g}", support->radius) : "None"),
                  fmt::arg("centre", fmt::format("[{:.17g}, {:.17g}, {:.17g}]", centre.x(), centre.y(), centre.z()))));
  return files;
}

}  // namespace umtet
