// What becomes of thin bodies and gaps whose truth is known.
//
//   thin_bodies [--bodies N] [--seed N] [--only FAMILY] [--list] > data/thin_bodies.csv
//
// N bodies (2000) of the families of bodies.h, .1 to 3 h thick, in random places and rotations, are meshed at h = 1 as
// `umtet mesh --h` does, and judged. A line of the table is a family and a range of thickness:
//
//   bodies      how many
//   exit_0      meshes that pass; faithful: those without any place
//   exit_6      meshes that fail
//   none        no mesh: no vertex of the background is inside
//   not_valid   meshes that are not valid
//   unreported  meshes that are wrong where they say nothing. Wrong is a point of psi = 0 farther than h / 2 from the
//               boundary, or a face farther than h / 2 from psi = 0, outside of all places by more than 2.5 h; or
//               pieces or a genus that are not the body's and are said to be
//
// Points of psi = 0 are found along rays, faces by the distance to these points: code apart from that of the
// certificate. --only: the bodies of this family alone. --list: a line a body instead. The same bytes for any number of
// threads.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "body/fidelity/verdict.h"
#include "body/search/mesh_maker.h"
#include "mesh/background/background_mesh.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/expression/expression.h"
#include "tools/thin_bodies/bodies.h"

using namespace umtet;
using namespace umtet::thin_bodies;

namespace {

// Ranges of thickness, h.
constexpr double kBounds[] = {.1, .25, .5, .75, 1, 1.25, 1.5, 2, 2.5, 3};
constexpr int kRanges = static_cast<int>(std::size(kBounds)) - 1;
// What is added to kSmallOff: points of psi = 0 are that far apart where they are sparse ...
constexpr double kSparse = .2;
// ... and the mesher looks for them in steps.
constexpr double kSteps = .05;
// From a wrong point to the place that reports it, h; besides the size of the place.
constexpr double kNear = 2.5;

struct Request {
  std::size_t bodies = 2000, seed = 0;
  std::string only = {};
  bool lists = false;
};

struct Outcome {
  std::string family, formula;
  double thickness = 0;
  bool made = false, passes = false, faithful = false, valid = false, same_topology = false, reports_topology = false;
  double lost = 0, extra = 0;  ///< largest distances: of psi = 0 to the boundary, and the other way; h
  std::size_t n_places = 0, n_unreported = 0;

  bool unreported() const { return made && (n_unreported > 0 || (!same_topology && !reports_topology)); }
};

bool is_near_a_place(const Vec3& x, const std::vector<MeshDefect>& places) {
  return std::any_of(places.begin(), places.end(),
                     [&](const MeshDefect& p) { return (p.where - x).norm() <= p.size_over_h + kNear; });
}

Outcome outcome_of(const Body& body) {
  Outcome o{.family = body.family, .formula = body.formula, .thickness = body.thickness};
  Domain domain;
  domain.formula = shared_function(Expression(body.formula));
  domain.box = body.box;
  domain.diagonal = body.box.diagonal().norm();
  MeshMaker maker(domain, BodyOptions(), {});
  const MeshAttempt a = maker.attempt({BackgroundMesh(a15(), body.box, 1)}, 1);
  o.made = a.made();
  if (!o.made) return o;
  o.passes = a.is_right();
  o.faithful = fits_psi(a.measured) && a.measured.defects.empty();
  o.valid = a.measured.is_valid;
  o.n_places = a.defects.size();
  const MeshCertificate::Boundary& boundary = a.measured.mesh.boundary;
  o.same_topology = boundary.components == body.n_pieces && boundary.euler_characteristic == 2L * body.n_pieces;
  o.reports_topology = a.measured.domain.topology != TopologyProof::Same;
  const std::vector<Triangle>& faces = a.result.submesh.positive_faces;
  const auto look = [&](const Vec3& x, double off, double tolerance, double& largest) {
    largest = std::max(largest, off);
    if (off > kSmallOff + tolerance && !is_near_a_place(x, a.defects)) ++o.n_unreported;
  };
  const std::vector<double> lost = SurfaceDistance(a.result.final, faces).distances(body.surface);
  for (std::size_t i = 0; i < lost.size(); ++i) look(body.surface[i], lost[i], kSteps, o.lost);
  std::vector<Vec3> centroids;
  for (const Triangle& f : faces) {
    centroids.emplace_back((a.result.final[f[0]] + a.result.final[f[1]] + a.result.final[f[2]]) / 3.);
  }
  const std::vector<double> extra = SampleDistance(body.surface).distances(centroids);
  for (std::size_t i = 0; i < extra.size(); ++i) look(centroids[i], extra[i], kSparse, o.extra);
  return o;
}

std::size_t number(const char* flag, const char* text) {
  char* end = nullptr;
  const unsigned long long n = std::strtoull(text, &end, 10);
  if (*text != '\0' && *end == '\0') return n;
  std::fprintf(stderr, "thin_bodies: %s wants a number, not '%s'\n", flag, text);
  std::exit(2);
}

Request parse(int argc, char** argv) {
  Request request;
  for (int i = 1; i < argc; ++i) {
    const std::string flag = argv[i];
    if (flag == "--list") {
      request.lists = true;
      continue;
    }
    if (flag == "--only" && i + 1 < argc) {
      request.only = argv[++i];
      continue;
    }
    if ((flag != "--bodies" && flag != "--seed") || i + 1 == argc) {
      std::fprintf(stderr, "usage: thin_bodies [--bodies N] [--seed N] [--only FAMILY] [--list]\n");
      std::exit(2);
    }
    (flag == "--bodies" ? request.bodies : request.seed) = number(flag.c_str(), argv[++i]);
  }
  return request;
}

/// Families and ranges take turns.
std::vector<Outcome> outcomes(const Request& request) {
  std::vector<Outcome> all;
  for (std::size_t k = 0; k < request.bodies; ++k) {
    const std::string& family = families()[k % families().size()];
    if (!request.only.empty() && family != request.only) continue;
    const std::size_t range = k / families().size() % kRanges;
    all.push_back(
        outcome_of(random_body(family, kBounds[range], kBounds[range + 1], 1'000'000 * (request.seed + 1) + k)));
    std::fprintf(stderr, "\r%zu of %zu ", k + 1, request.bodies);
  }
  std::fprintf(stderr, "\n");
  return all;
}

void print_list(const std::vector<Outcome>& all) {
  std::puts("family,thickness,made,valid,passes,faithful,places,lost,extra,same_topology,unreported,formula");
  for (const Outcome& o : all) {
    std::printf("%s,%.4f,%d,%d,%d,%d,%zu,%.3f,%.3f,%d,%d,%s\n", o.family.c_str(), o.thickness, o.made, o.valid,
                o.passes, o.faithful, o.n_places, o.lost, o.extra, o.same_topology, o.unreported(), o.formula.c_str());
  }
}

void print_table(const std::vector<Outcome>& all) {
  std::puts("family,from,to,bodies,exit_0,faithful,exit_6,none,not_valid,unreported");
  for (const std::string& family : families()) {
    for (int r = 0; r < kRanges; ++r) {
      int n = 0, passes = 0, faithful = 0, fails = 0, none = 0, not_valid = 0, unreported = 0;
      for (const Outcome& o : all) {
        if (o.family != family || !(o.thickness >= kBounds[r] && o.thickness < kBounds[r + 1])) continue;
        ++n;
        none += !o.made;
        passes += o.passes;
        faithful += o.faithful;
        fails += o.made && !o.passes;
        not_valid += o.made && !o.valid;
        unreported += o.unreported();
      }
      if (n == 0) continue;
      std::printf("%s,%g,%g,%d,%d,%d,%d,%d,%d,%d\n", family.c_str(), kBounds[r], kBounds[r + 1], n, passes, faithful,
                  fails, none, not_valid, unreported);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Request request = parse(argc, argv);
  const std::vector<Outcome> all = outcomes(request);
  if (request.lists) {
    print_list(all);
  } else {
    print_table(all);
  }
}
