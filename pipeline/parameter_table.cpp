#include "mesh/universal_mesh.h"
#include "pipeline/parameters.h"
#include "reconstruct/fit_ssd.h"

namespace umtet {
namespace {

#ifdef UMTET_WITH_GSL
constexpr const char* kDefaultMaxMin = "exact";
#else
constexpr const char* kDefaultMaxMin = "golden";
#endif

constexpr double kHuge = 1e100;
constexpr std::int64_t kManyTets = 2'000'000;  // about a minute and 1 GB

std::vector<ParamField> make_fields() {
  const SsdParams ssd;
  const UmParams um;
  const auto text = [](const char* s) { return ParamValue(std::string(s)); };
  const auto whole = [](auto n) { return ParamValue(static_cast<std::int64_t>(n)); };
  const double tiny = 1e-300;  // stands for "> 0"
  return {
      {"cloud.file", "", text(""), 0, 0, {}, "the point cloud, as given"},
      {"cloud.keep_all", "--keep-all", false, 0, 0, {}, "keep outliers and small pieces far from the rest"},
      {"cloud.normals",
       "--normals",
       text("auto"),
       0,
       0,
       {"auto", "given", "estimate"},
       "auto: those of the file, a turned minority turned back, estimated where there are none"},
      {"cloud.orient_from", "--orient-from", text(""), 0, 0, {}, "file of viewpoints x y z: normals look to the nearest"},
      {"cloud.flip", "--flip", false, 0, 0, {}, "turn all normals over in the end"},

      {"reconstruct.spacing",
       "--spacing",
       ssd.spacing,
       0,
       kHuge,
       {},
       "lattice spacing, model units; 0: from the cloud"},
      {"reconstruct.smoothing",
       "",
       ssd.smoothing,
       0,
       kHuge,
       {},
       "c, weight of the Hessian energy (weights = area); 0: from the noise"},
      {"reconstruct.noise",
       "",
       -1.,
       -1,
       kHuge,
       {},
       "standard deviation of the samples along the normal, model units; -1: from the cloud"},
      {"reconstruct.detail", "--detail", ssd.detail, .01, 100, {}, "divides the lattice spacing that is chosen"},
      {"reconstruct.smooth", "--smooth", ssd.smooth, 1e-6, 1e6, {}, "multiplies the smoothing that is chosen"},
      {"reconstruct.alpha", "", ssd.alpha, tiny, kHuge, {}, "alpha of eq. (10) (weights = paper)"},
      {"reconstruct.weights",
       "--weights",
       text("area"),
       0,
       0,
       {"area", "paper"},
       "area: samples weigh the area they stand for; paper: eq. (10) as printed"},
      {"reconstruct.prior", "", text("compact_c2"), 0, 0, {"compact_c2", "gaussian"}, "prior of the max-ent functions"},
      {"reconstruct.gamma", "", ssd.prior.gamma, tiny, 4, {}, "dimensionless locality of the prior (the paper: 1.6)"},
      {"reconstruct.support", "", whole(ssd.prior.support), 2, 4, {}, "radius in spacings (prior = compact_c2)"},
      {"reconstruct.epsilon", "", ssd.prior.epsilon, tiny, 1, {}, "cut-off (prior = gaussian)"},
      {"reconstruct.solver",
       "--solver",
       text("auto"),
       0,
       0,
       {"auto", "cascade", "full", "assembled"},
       "cascade: bands of finer lattices near the surface; full: one full lattice by multigrid; assembled: the same by a "
       "sparse direct solve, small problems only; auto: cascade, or full for weights = paper and prior = gaussian"},
      {"reconstruct.tolerance", "", ssd.tolerance, 1e-15, .1, {}, "relative residual at which the solver stops"},
      {"reconstruct.band_tolerance",
       "",
       ssd.band_tolerance,
       1e-6,
       .9,
       {},
       "the same for the corrections of the cascade"},
      {"reconstruct.max_iterations", "", whole(ssd.max_iterations), 1, 100000, {}, "of the solver"},
      {"reconstruct.padding", "", whole(ssd.padding), 4, 64, {}, "lattice cells around the cloud"},

      {"mesh.implicit", "--implicit", text(""), 0, 0, {}, "psi(x, y, z) < 0 inside: mesh a formula instead of a cloud"},
      {"mesh.box",
       "--box",
       text(""),
       0,
       0,
       {},
       "x0,y0,z0,x1,y1,z1 of the background mesh; empty: around the level set"},
      {"mesh.h",
       "--h",
       0.,
       0,
       kHuge,
       {},
       "edge length of the background mesh, model units; 0: from size and thickness"},
      {"mesh.tets", "--tets", whole(0), 0, 1e12, {}, "wanted number of tets, instead of --h; 0: --h decides"},
      {"mesh.max_deviation",
       "--max-deviation",
       0.,
       0,
       kHuge,
       {},
       "how far flat faces may be from psi = 0, model units: chooses h from curvature, instead of --h; 0: any"},
      {"mesh.max_tets", "--max-tets", whole(kManyTets), 100, 1e12, {}, "more tets are made for --tets only"},
      {"mesh.allow_thin",
       "--allow-thin",
       false,
       0,
       0,
       {},
       "keep a mesh that came out wrong where the body is too thin for h (else exit 5)"},
      {"mesh.background",
       "--background",
       text("a15"),
       0,
       0,
       {},
       "background mesh: a15, z, slab, cube (acute tilings), or a file"},
      {"mesh.box_walls", "--box-walls", false, 0, 0, {}, "fill --box with a15 up to flat walls, halved tets at them"},
      {"mesh.mode",
       "--mode",
       text("fast"),
       0,
       0,
       {"fast", "paper"},
       "fast: chosen labels, p-norm smoothing of a shell, repair; paper: Algorithms 1-3 of the paper, by default with random directions (Section 3.8(d)) and Newton projection; "
       "--set mesh.directions=axes and --set mesh.closest_point=paper give Sections 3.2 and 3.8(a)"},
      {"mesh.order", "--order", whole(1), 1, 2, {}, "of the tets; 2: ten nodes, mid-sides of boundary edges on psi = 0"},
      {"mesh.target_quality", "", um.fast.smoothing.target, .1, .9, {}, "mean ratio below which tets are worked on (mode = fast)"},
      {"mesh.projection_passes", "", whole(um.projection_passes), 1, 1000, {}, "N_P (this and below: mode = paper)"},
      {"mesh.relaxation_iterations", "", whole(um.relaxation_iterations), 0, 100000, {}, "N_R"},
      {"mesh.samples", "", whole(um.samples), 1, 100000, {}, "N_S: 2 N_S + 1 candidates on a line"},
      {"mesh.directions",
       "",
       text("random"),
       0,
       0,
       {"random", "axes"},
       "along which vertices relax; axes: e_x, e_y, e_z in turn, Section 3.2; random: Section 3.8(d)"},
      {"mesh.closest_point",
       "",
       text("newton"),
       0,
       0,
       {"newton", "damped", "paper"},
       "projection on psi = 0; paper: the iteration of Section 3.8(a) to the letter"},
      {"mesh.max_min",
       "",
       text(kDefaultMaxMin),
       0,
       0,
       {"exact", "golden"},
       "exact: roots of polynomials; golden: section search"},
      {"mesh.seed", "--seed", whole(um.seed), 0, 9e18, {}, "of the random tangents"},
      {"mesh.keep_iterates", "--keep-iterates", false, 0, 0, {}, "write 3-mesh/iterates.pvd, and pass_<n>.vtu after every pass (mode = paper)"},

      {"output.units", "--units", text(""), 0, 0, {}, "name of the model unit, e.g. mm: a label, nothing is converted"},
      {"output.max_memory", "--max-memory", 0., 0, 1e6, {}, "GB that a stage may take; 0: what the machine can give"},
      {"output.min_quality", "--min-quality", 0., 0, 1, {}, "gate: exit 6 when the least mean ratio is below"},
      {"output.label_names", "--label-names", text(""), 0, 0, {}, "names of labels in exported files: 1=feet,2=head"},
      {"output.label_min_area",
       "--label-min-area",
       -1.,
       -1,
       kHuge,
       {},
       "smaller islands of a label go, model units squared; -1: what three samples stand for"},
      {"output.patch_angle",
       "--patch-angle",
       0.,
       0,
       180,
       {},
       "without labels: boundary patches end where faces meet at more degrees; 0: where the surface ends"},
  };
}

}  // namespace

const std::vector<ParamField>& params_fields() {
  static const std::vector<ParamField> fields = make_fields();
  return fields;
}

}  // namespace umtet
