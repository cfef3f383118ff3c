#include "reconstruct/solve/scan_holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <unordered_map>

#include "common/disjoint_sets.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

// Of so many samples, evenly picked, the jump of the winding number is taken: the median is then known to 2 %.
constexpr std::size_t kJumps = 1000;
// Cells from a sample, on both sides. Nearer, single samples show; both together give the jump at none, as what the
// rest of the surface adds changes linearly.
constexpr double kNearSide = 1.25, kFarSide = 2 * kNearSide;
// A place of the closing surface is at the rim if a sample is within so many cells.
constexpr double kRimCells = kFarCells + 1.5;

double median(std::vector<double>& v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

FastWindingNumber winding_number_of(const std::vector<SsdSample>& samples) {
  const SampleColumns columns(samples);
  return {columns.places, columns.normals, columns.areas};
}

/// Fills depth and rim_cosine.
void measure_rims(const std::vector<SsdSample>& samples, ScanHoles& found) {
  if (found.places.empty()) return;
  const NeighbourTree tree(SampleColumns(samples).places);
  std::set<std::pair<int, std::uint32_t>> seen;
  std::vector<int> n_rim(found.holes.size(), 0);
  for (std::size_t p = 0; p < found.places.size(); ++p) {
    std::array<Neighbour, 1> room;
    const Neighbour near = tree.k_nearest(found.places[p], room).front();
    ScanHole& hole = found.holes[found.hole_of[p]];
    hole.depth = std::max(hole.depth, std::sqrt(near.distance2));
    if (near.distance2 > kRimCells * kRimCells || !seen.emplace(found.hole_of[p], near.point).second) continue;
    hole.rim_cosine += samples[near.point].normal.normalized().dot(found.normals[p]);
    ++n_rim[found.hole_of[p]];
  }
  for (std::size_t h = 0; h < found.holes.size(); ++h) found.holes[h].rim_cosine /= std::max(1, n_rim[h]);
}

}  // namespace

double ScanHole::bulge() const {
  const double c = std::clamp(rim_cosine, 0., 1.);
  return depth * std::sqrt((1 - c) / (1 + c));
}

std::vector<std::uint8_t> far_nodes(const Vector3i& n, const std::vector<Vector3d>& places) {
  std::vector<std::uint8_t> is_far(static_cast<std::size_t>(n[0]) * n[1] * n[2], 1);
  for (const Vector3d& x : places) {
    const Vector3i low = (x.array() - kFarCells).ceil().cast<int>().max(0);
    const Vector3i high = (x.array() + kFarCells).floor().cast<int>().min(n.array() - 1);
    for (int k = low[2]; k <= high[2]; ++k) {
      for (int j = low[1]; j <= high[1]; ++j) {
        const double rest = kFarCells * kFarCells - std::pow(k - x[2], 2) - std::pow(j - x[1], 2);
        const std::size_t row = static_cast<std::size_t>(n[0]) * (j + static_cast<std::size_t>(n[1]) * k);
        for (int i = low[0]; i <= high[0]; ++i)
          if (std::pow(i - x[0], 2) <= rest) is_far[row + i] = 0;
      }
    }
  }
  return is_far;
}

ScaledWindingNumber::ScaledWindingNumber(const std::vector<SsdSample>& samples) : number_(winding_number_of(samples)) {
  std::vector<double> jumps, inner;
  const std::size_t step = std::max<std::size_t>(1, samples.size() / kJumps);
  for (std::size_t i = 0; i < samples.size(); i += step) {
    const Vector3d n = samples[i].normal.normalized();
    const auto at = [&](double side) { return number_(samples[i].xi + side * n); };
    const double inside = at(-kNearSide);
    jumps.push_back(2 * (inside - at(kNearSide)) - (at(-kFarSide) - at(kFarSide)));
    inner.push_back(inside);
  }
  const double jump = median(jumps);
  if (jump > 0) scale_ = jump;
  inner_ = median(inner) / scale_;
}

Vector3d ScaledWindingNumber::outward(const Vector3d& xi) const {
  Vector3d gradient;
  number_.evaluate(xi, &gradient);
  const double length = gradient.norm();
  return length > 0 ? Vector3d(-gradient / length) : Vector3d(Vector3d::Zero());
}

ScanHoles scan_holes(const std::vector<SsdSample>& samples, const ScaledWindingNumber& number, const Vector3i& n,
                     const std::vector<std::uint8_t>& far, const std::vector<float>& w) {
  ScanHoles found;
  DisjointSets groups;
  std::unordered_map<std::size_t, int> in_cell;  // a cell's first place; a place is on an edge of four cells
  const std::size_t stride[3] = {1, static_cast<std::size_t>(n[0]), static_cast<std::size_t>(n[0]) * n[1]};
  const auto visit_edge = [&](const Vector3i& node, int d) {
    const std::size_t a = node[0] + stride[1] * node[1] + stride[2] * node[2], b = a + stride[d];
    if (!far[b] || (w[a] < .5F) == (w[b] < .5F)) return;
    Vector3d x = node.cast<double>();
    x[d] += (.5 - w[a]) / (w[b] - w[a]);
    const Vector3d normal = number.outward(x);
    const int p = groups.add();
    found.places.push_back(x);
    found.normals.push_back(normal);
    found.areas.push_back(std::abs(normal[d]));  // |n_d| edges along d meet a unit of area: their squares add up to one
    for (int u = 0; u < 2; ++u) {
      for (int v = 0; v < 2; ++v) {
        Vector3i cell = node;
        cell[(d + 1) % 3] -= u;
        cell[(d + 2) % 3] -= v;
        if (cell.minCoeff() < 0) continue;
        const auto [first, is_new] = in_cell.emplace(cell[0] + stride[1] * cell[1] + stride[2] * cell[2], p);
        if (!is_new) groups.unite(first->second, p);
      }
    }
  };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const Vector3i node(i, j, k);
        if (!far[i + stride[1] * j + stride[2] * k]) continue;
        for (int d = 0; d < 3; ++d)
          if (node[d] + 1 < n[d]) visit_edge(node, d);
      }

  found.hole_of.assign(found.places.size(), -1);
  for (std::size_t p = 0; p < found.places.size(); ++p) {
    const int root = groups.find(static_cast<int>(p));  // the least of its group: it has been here
    if (root == static_cast<int>(p)) {
      found.hole_of[p] = static_cast<int>(found.holes.size());
      found.holes.emplace_back();
    }
    found.hole_of[p] = found.hole_of[root];
    ScanHole& hole = found.holes[found.hole_of[p]];
    hole.area += found.areas[p];
    hole.centre += found.areas[p] * found.places[p];
    hole.normal += found.areas[p] * found.normals[p];
  }
  for (ScanHole& hole : found.holes) {
    hole.centre /= hole.area;
    hole.normal.normalize();
  }
  measure_rims(samples, found);
  return found;
}

}  // namespace umtet
