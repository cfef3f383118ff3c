#include "mesh/quality_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "mesh/detail/checked_file.h"
#include "mesh/tet_quality.h"

namespace umtet {

std::vector<double> quality_vector(const std::vector<Tet>& C, const std::vector<Vec3>& V) {
  constexpr double kNoTet = std::numeric_limits<double>::infinity();
  std::vector<double> q(V.size(), kNoTet);
  for (const Tet& t : C) {
    double Q = mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]);
    if (!std::isfinite(Q)) Q = -1;
    for (const int v : t) q[v] = std::min(q[v], Q);
  }
  std::erase(q, kNoTet);
  std::sort(q.begin(), q.end());
  return q;
}

std::vector<Tet> tets_at(const std::vector<Tet>& C, const std::vector<int>& vertices, std::size_t n_vertices) {
  std::vector<char> wanted(n_vertices, 0);
  for (const int v : vertices) wanted[v] = 1;
  std::vector<Tet> result;
  std::copy_if(C.begin(), C.end(), std::back_inserter(result),
               [&](const Tet& t) { return wanted[t[0]] || wanted[t[1]] || wanted[t[2]] || wanted[t[3]]; });
  return result;
}

double quantile(const std::vector<double>& lowest, std::size_t n, double p) {
  if (lowest.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double at = p * static_cast<double>(n - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, n - 1);
  return lowest[below] + (at - static_cast<double>(below)) * (lowest[above] - lowest[below]);
}

double quantile(const std::vector<double>& ascending, double p) { return quantile(ascending, ascending.size(), p); }

std::vector<QualityCurve> quality_curves(const std::vector<Tet>& C, const std::vector<int>& positive_vertices,
                                         const std::vector<Vec3>& omega_h, const std::vector<Vec3>& projected,
                                         const std::vector<Vec3>& final) {
  if (projected.size() != omega_h.size() || final.size() != omega_h.size()) {
    throw std::invalid_argument("quality curves: the three stages must have the same vertices");
  }
  const std::vector<Tet> at_boundary = tets_at(C, positive_vertices, omega_h.size());
  return {{"omega_h", quality_vector(C, omega_h)},
          {"projected", quality_vector(C, projected)},
          {"final", quality_vector(C, final)},
          {"boundary_omega_h", quality_vector(at_boundary, omega_h)},
          {"boundary_projected", quality_vector(at_boundary, projected)},
          {"boundary_final", quality_vector(at_boundary, final)}};
}

void write_quality_csv(const std::filesystem::path& path, const std::vector<QualityCurve>& curves) {
  std::size_t longest = 0;
  std::set<std::size_t> indices;
  for (const QualityCurve& c : curves) {
    longest = std::max(longest, c.values.size());
    if (!c.values.empty()) indices.insert(c.values.size());
  }
  constexpr double kPerDecade = 100;
  for (std::size_t i = 1; i <= std::min<std::size_t>(longest, 100); ++i) indices.insert(i);
  for (int step = 1;; ++step) {
    const auto i = static_cast<std::size_t>(std::llround(100 * std::pow(10.0, step / kPerDecade)));
    if (i > longest) break;
    indices.insert(i);
  }
  detail::CheckedFile file(path);
  file.text("index");
  for (const QualityCurve& c : curves) file.text(",").text(c.name);
  file.text("\n");
  for (const std::size_t i : indices) {
    file.number(i);
    for (const QualityCurve& c : curves) {
      file.text(",");
      if (i <= c.values.size()) file.number(c.values[i - 1]);
    }
    file.text("\n");
  }
  file.close();
}

}  // namespace umtet
