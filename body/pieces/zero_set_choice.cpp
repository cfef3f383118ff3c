#include "body/pieces/zero_set_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "body/label_volume.h"
#include "body/pieces/component_proof.h"
#include "body/pieces/zero_free_blocks.h"
#include "common/formatted.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/sizes/graded_zero_set.h"

namespace umtet {
namespace {

// Values of psi a count of pieces may cost: about ten seconds.
constexpr double kMaxGridNodes = 5e7;
// Fewer samples do not make a surface: read_scan() refuses fewer, too.
constexpr std::size_t kFewestSamples = 10;
// A piece needs this share of the samples per area of the piece that most samples back. A false piece around outliers
// has an area of some cells of the lattice, whatever the number of outliers: few samples for its area.
constexpr double kLeastDensity = .02;

/// For each piece the number of samples that are nearest to it and within `radius`.
std::vector<std::size_t> backing_samples(const Domain& domain, const ZeroSetTopology& topology, double radius,
                                         const Context& context) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  const std::vector<Vec3>& samples = domain.cloud.points;
  std::vector<double> least(samples.size(), radius);
  std::vector<std::size_t> owner(samples.size(), kNone), near;
  std::vector<Vec3> x;
  for (std::size_t c = 0; c < topology.components.size(); ++c) {
    context.poll();
    near.clear();
    x.clear();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (topology.components[c].box.exteriorDistance(samples[i]) > least[i]) continue;
      near.push_back(i);
      x.push_back(samples[i]);
    }
    if (near.empty()) continue;
    const auto points = topology.points_of(topology.components[c]);
    const std::vector<double> d = SampleDistance({points.begin(), points.end()}).distances(x, context);
    for (std::size_t k = 0; k < near.size(); ++k) {
      const std::size_t i = near[k];
      if (d[k] < least[i] || (owner[i] == kNone && d[k] <= radius)) least[i] = d[k], owner[i] = c;
    }
  }
  std::vector<std::size_t> count(topology.components.size());
  for (const std::size_t c : owner) {
    if (c != kNone) ++count[c];
  }
  return count;
}

/// Whether there is a sample within `radius` of the first piece; false may also mean that a few hundred were not.
bool has_sample(const Domain& domain, const ZeroSetTopology& topology, double radius) {
  constexpr std::size_t kLookedAt = 300;  // samples searched near a piece: bounds the time
  const auto points = topology.points_of(topology.components.front());
  const std::vector<Vec3>& samples = domain.cloud.points;
  const auto is_near = [&](const Vec3& x) {
    return std::any_of(points.begin(), points.end(),
                       [&](const Vec3& p) { return (p - x).squaredNorm() <= radius * radius; });
  };
  for (std::size_t i = 0; i < std::min(samples.size(), kLookedAt); ++i) {
    if (is_near(samples[i])) return true;
  }
  return false;
}

/// The number of samples that each piece has to have.
std::vector<std::size_t> wanted_samples(const ZeroSetTopology& topology, const std::vector<std::size_t>& backing) {
  std::vector<std::size_t> wanted(backing.size(), kFewestSamples);
  const auto main = static_cast<std::size_t>(std::max_element(backing.begin(), backing.end()) - backing.begin());
  const double density = static_cast<double>(backing[main]) / topology.components[main].area;
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    const double fair = std::ceil(kLeastDensity * density * topology.components[c].area);
    if (fair > static_cast<double>(kFewestSamples)) wanted[c] = static_cast<std::size_t>(fair);
  }
  wanted[main] = 1;
  return wanted;
}

/// Decides which pieces of choice.topology are meshed.
void choose_among(const Domain& domain, ZeroSetChoice& choice, const Context& context) {
  const std::vector<ZeroSetComponent>& pieces = choice.topology.components;
  if (pieces.empty()) return;
  const double radius = std::max(support_radius(domain), choice.topology.spacing);
  std::vector<std::size_t> backing(pieces.size()), wanted(pieces.size());
  // One piece is kept if it has one sample; how many there are matters to none but several.
  if (domain.level_set && !(pieces.size() == 1 && has_sample(domain, choice.topology, radius))) {
    backing = backing_samples(domain, choice.topology, radius, context);
    wanted = wanted_samples(choice.topology, backing);
  }
  for (std::size_t c = 0; c < pieces.size(); ++c) {
    if (backing[c] >= wanted[c]) {
      choice.kept.push_back(c);
      choice.seeds.push_back(pieces[c].seed);
      choice.euler_characteristic += pieces[c].euler_characteristic;
      continue;
    }
    const Vec3 at = pieces[c].seed + domain.shift;
    choice.dropped.push_back(
        formatted("piece of area %.3g at (%.6g, %.6g, %.6g): %zu of at least %zu samples within %.3g of it",
                  pieces[c].area, at.x(), at.y(), at.z(), backing[c], wanted[c], radius));
  }
}

}  // namespace

double support_radius(const Domain& domain) { return kSupportRadius * domain.cloud_spacing; }

double counting_spacing(const Domain& domain, double h) {
  const double wanted = domain.level_set ? std::min(h, domain.level_set->spacing())
                        : domain.labels  ? std::min(h, domain.labels->step() / 2)
                                         : h;
  return std::max(wanted, std::cbrt(domain.box.volume() / kMaxGridNodes));
}

std::vector<Vec3> kept_points(const ZeroSetChoice& pieces) {
  std::vector<Vec3> points;
  std::size_t n = 0;
  for (const std::size_t c : pieces.kept) n += pieces.topology.components[c].n_cut_edges;
  points.reserve(n);
  for (const std::size_t c : pieces.kept) {
    const auto of_piece = pieces.topology.points_of(pieces.topology.components[c]);
    points.insert(points.end(), of_piece.begin(), of_piece.end());
  }
  return points;
}

ZeroSetChoice choose_components(const Domain& domain, double h, const Context& context, const SignCells* cells) {
  ZeroSetChoice choice;
  const double spacing = counting_spacing(domain, h);
  FarFromZero far;
  if (domain.level_set) {
    if (!cells) cells = &choice.cells.emplace(sign_cells(*domain.level_set, h / 2));
    far = ZeroFreeMap(*cells, domain.box.intersection(domain.level_set->domain()), spacing);
  } else if (domain.has_edges_of_triangles()) {
    far = ZeroFreeBlocks(domain.psi(), domain.box, spacing, context);  // psi is a distance
  }
  choice.topology = zero_set_topology(domain.psi(), domain.box, spacing, context, far);
  choose_among(domain, choice, context);
  return choice;
}

ZeroSetChoice choose_components(const Domain& domain, const SizeField& sizes, double finest, double share,
                                const Context& context, const SignCells* cells) {
  ZeroSetChoice choice;
  choice.share = share;
  choice.topology = graded_zero_set(domain.psi(), domain.box, sizes, share, finest, domain.steepest(), context);
  if (domain.level_set && !cells && choice.topology.spacing > 0) {
    choice.cells.emplace(sign_cells(*domain.level_set, choice.topology.spacing / 2));
  }
  choose_among(domain, choice, context);
  return choice;
}

}  // namespace umtet
