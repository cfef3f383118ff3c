#include "body/sizing/deviation.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "body/pieces/zero_set_choice.h"
#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/implicit/curvature.h"

namespace umtet {
namespace {

// Each round lets in at most one finer level of psi, and there are few levels.
constexpr int kRounds = 8;

/// The least over the pieces that are meshed.
double least_edge(const Domain& domain, double h, double deviation, const Context& context) {
  const std::vector<Vec3> x = kept_points(choose_components(domain, h, context));
  std::vector<double> edge(x.size());
  for_each_asking(domain.psi(), x.size(), kValuesPerPoll, context, [&](std::size_t i) {
    edge[i] = edge_of_deviation(principal_curvatures(domain.psi(), x[i]), deviation);
  });
  return edge.empty() ? std::numeric_limits<double>::infinity() : *std::min_element(edge.begin(), edge.end());
}

}  // namespace

double h_for_deviation(Domain& domain, double deviation, double start, double least, const Context& context) {
  double h = start;
  for (int round = 0; round < kRounds && h > least; ++round) {
    domain.limit_detail(h);
    const double wanted = least_edge(domain, h, deviation, context);
    if (wanted >= h) return h;
    h = std::max(wanted, least);
  }
  domain.limit_detail(h);
  return h;
}

}  // namespace umtet
