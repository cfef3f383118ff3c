#include "distributed/io/part_quality.h"

#include <algorithm>
#include <limits>

#include "distributed/exchange/selection.h"
#include "distributed/mesh/vertex_owners.h"
#include "mesh/certify/quality_report.h"

namespace umtet {
namespace {

constexpr double kNoTet = std::numeric_limits<double>::infinity();
constexpr std::size_t kTetsAtOnce = 1 << 16;  // half a megabyte of Q

/// Returns the least Q at each owned vertex with a tet, in ascending order. Collective.
std::vector<double> least_at_owned(const VertexOwners& owners, const std::vector<double>& least) {
  std::vector<double> owned(owners.ids().size(), kNoTet);
  owners.ask([&](std::size_t v) { return least[v]; },
             [&](std::size_t k, double q) { owned[k] = std::min(owned[k], q); });
  std::erase(owned, kNoTet);
  std::sort(owned.begin(), owned.end());
  return owned;
}

}  // namespace

QualitySamples quality_samples(MPI_Comm comm, DistributedMesh& mesh,
                               const std::vector<std::pair<std::string, std::vector<Vec3>*>>& stages) {
  const VertexOwners owners(comm, mesh);
  // The tet that makes a vertex positive may be on another rank.
  std::vector<char> is_positive(mesh.mesh.V.size(), 0);
  for (const Triangle& f : mesh.positive_faces)
    for (const int v : f) is_positive[v] = 1;
  is_positive = owners.exchange().any(is_positive);
  std::vector<std::string> names;
  std::vector<std::vector<double>> vectors;
  for (const bool of_boundary : {false, true}) {
    for (const auto& [name, V] : stages) {
      V->swap(mesh.mesh.V);
      std::vector<double> least(mesh.mesh.V.size(), kNoTet);
      for (std::size_t first = 0; first < mesh.mesh.C.size(); first += kTetsAtOnce) {
        const std::size_t end = std::min(mesh.mesh.C.size(), first + kTetsAtOnce);
        std::vector<double> Q(end - first);
        measure_mean_ratios(mesh.mesh, Q, first);
        for (std::size_t t = first; t < end; ++t) {
          const Tet& tet = mesh.mesh.C[t];
          if (of_boundary && std::none_of(tet.begin(), tet.end(), [&](int v) { return is_positive[v]; })) continue;
          for (const int v : tet) least[v] = std::min(least[v], Q[t - first]);
        }
      }
      V->swap(mesh.mesh.V);
      names.push_back((of_boundary ? "boundary_" : "") + name);
      vectors.push_back(least_at_owned(owners, least));
    }
  }
  std::vector<std::uint64_t> n;
  for (const auto& values : vectors) n.push_back(values.size());
  MPI_Allreduce(MPI_IN_PLACE, n.data(), static_cast<int>(n.size()), MPI_UINT64_T, MPI_SUM, comm);
  QualitySamples made{quality_csv_indices({n.begin(), n.end()}), {}};
  for (std::size_t c = 0; c < vectors.size(); ++c) {
    std::vector<std::uint64_t> places;
    for (const std::size_t i : made.indices) {
      if (i <= n[c]) places.push_back(i - 1);
    }
    made.curves.push_back({names[c], values_at(comm, vectors[c], places)});
  }
  return made;
}

}  // namespace umtet
