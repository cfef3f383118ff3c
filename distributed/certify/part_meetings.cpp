#include "distributed/certify/part_meetings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <unordered_map>

namespace umtet {
namespace {

using FaceBox = Eigen::AlignedBox3d;

/// A face in a message to another rank.
struct SentFace {
  std::int64_t id;
  std::int64_t corner[3];
  double place[3][3];
};

SentFace sent(const DistributedMesh& mesh, const PartBoundary& boundary, std::size_t f) {
  SentFace face{boundary.id[f], {}, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    const int v = boundary.triangles[f][k];
    face.corner[k] = mesh.background_vertex[v];
    std::copy_n(mesh.mesh.V[v].data(), 3, face.place[k]);
  }
  return face;
}

FaceBox box_of(const SentFace& face) {
  FaceBox box;
  for (const auto& x : face.place) box.extend(Vec3(x[0], x[1], x[2]));
  return box;
}

/// Numbers of the cubes of a regular grid.
class Cubes {
 public:
  explicit Cubes(double edge) : edge_(edge) {}

  /// Returns the number of the cube that contains x. Cubes with the same number are far apart, and the same rank tests
  /// both.
  std::int64_t at(const Vec3& x) const { return number(cell(x)); }
  template <class F>
  void for_each(const FaceBox& box, const F& f) const {
    const auto low = cell(box.min()), high = cell(box.max());
    for (std::int64_t k = low[2]; k <= high[2]; ++k) {
      for (std::int64_t j = low[1]; j <= high[1]; ++j) {
        for (std::int64_t i = low[0]; i <= high[0]; ++i) f(number({i, j, k}));
      }
    }
  }

 private:
  static constexpr int kBits = 21;

  std::array<std::int64_t, 3> cell(const Vec3& x) const {
    std::array<std::int64_t, 3> c{};
    for (int a = 0; a < 3; ++a) c[a] = static_cast<std::int64_t>(std::floor(x[a] / edge_));
    return c;
  }
  static std::int64_t number(const std::array<std::int64_t, 3>& c) {
    std::int64_t n = 0;
    for (int a = 0; a < 3; ++a) n = n << kBits | (c[a] & ((std::int64_t{1} << kBits) - 1));
    return n;
  }

  double edge_;
};

/// Returns for each cube with local faces the rank that counts the pairs in it: the first rank with faces in the cube.
/// Collective.
std::unordered_map<std::int64_t, int> counters_of(MPI_Comm comm, const std::set<std::int64_t>& cubes) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  const auto n = static_cast<std::size_t>(n_ranks);
  // A hash of the cube selects the rank that finds its counter; the factor, 2^64 over the golden ratio, distributes
  // neighbouring cubes.
  const auto knower = [&](std::int64_t cube) {
    return static_cast<std::size_t>((static_cast<std::uint64_t>(cube) * 0x9e3779b97f4a7c15u >> 32) % n);
  };
  std::vector<std::vector<std::int64_t>> out(n);
  for (const std::int64_t cube : cubes) out[knower(cube)].push_back(cube);
  const auto in = all_to_all(comm, out);
  std::unordered_map<std::int64_t, int> first;
  for (std::size_t r = 0; r < n; ++r)
    for (const std::int64_t cube : in[r]) first.try_emplace(cube, static_cast<int>(r));
  std::vector<std::vector<int>> answers(n);
  for (std::size_t r = 0; r < n; ++r)
    for (const std::int64_t cube : in[r]) answers[r].push_back(first.at(cube));
  const auto told = all_to_all(comm, answers);
  std::unordered_map<std::int64_t, int> counters;
  for (std::size_t r = 0; r < n; ++r)
    for (std::size_t k = 0; k < told[r].size(); ++k) counters[out[r][k]] = told[r][k];
  return counters;
}

/// Faces in cubes that this rank counts, ascending.
struct CountedFaces {
  std::vector<Vec3> V;
  std::vector<Triangle> faces;
  std::vector<FaceBox> boxes;

  explicit CountedFaces(std::vector<SentFace> all) {
    std::sort(all.begin(), all.end(), [](const SentFace& a, const SentFace& b) { return a.id < b.id; });
    std::unordered_map<std::int64_t, int> number;
    for (const SentFace& face : all) {
      Triangle& f = faces.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [at, is_new] = number.try_emplace(face.corner[k], static_cast<int>(V.size()));
        if (is_new) V.emplace_back(face.place[k][0], face.place[k][1], face.place[k][2]);
        f[k] = at->second;
      }
      boxes.push_back(box_of(face));
    }
  }
};

}  // namespace

std::size_t meetings_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const PartBoundary& boundary, double edge) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &n_ranks);
  const Cubes cubes(edge);
  std::set<std::int64_t> own;
  for (std::size_t f = 0; f < boundary.triangles.size(); ++f)
    cubes.for_each(box_of(sent(mesh, boundary, f)), [&](std::int64_t cube) { own.insert(cube); });
  const auto counters = counters_of(comm, own);
  std::vector<std::vector<SentFace>> out(static_cast<std::size_t>(n_ranks));
  for (std::size_t f = 0; f < boundary.triangles.size(); ++f) {
    const SentFace face = sent(mesh, boundary, f);
    std::set<int> to;
    cubes.for_each(box_of(face), [&](std::int64_t cube) { to.insert(counters.at(cube)); });
    for (const int r : to) out[r].push_back(face);
  }
  std::vector<SentFace> all;
  for (const auto& some : all_to_all(comm, out)) all.insert(all.end(), some.begin(), some.end());
  const CountedFaces counted(std::move(all));
  std::uint64_t n = 0;
  for (const auto& [f, g] : self_intersections(counted.V, counted.faces)) {
    const Vec3 both = counted.boxes[f].min().cwiseMax(counted.boxes[g].min());
    const auto at = counters.find(cubes.at(both));
    n += at != counters.end() && at->second == rank;
  }
  MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPI_UINT64_T, MPI_SUM, comm);
  return n;
}

std::size_t wrongly_nested_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const PartBoundary& boundary,
                                    const BoundaryTopology& topology, const std::vector<ComponentVolume>& volumes) {
  std::vector<Vec3> corners;
  for (const BoundaryPiece& piece : topology.pieces)
    corners.emplace_back(piece.corner[0], piece.corner[1], piece.corner[2]);
  std::vector<int> winding(corners.size(), 0);
  if (corners.size() > 1) {
    winding = windings(mesh.mesh.V, boundary.triangles, topology.piece, corners);
    MPI_Allreduce(MPI_IN_PLACE, winding.data(), static_cast<int>(winding.size()), MPI_INT, MPI_SUM, comm);
  }
  std::size_t n = 0;
  for (std::size_t c = 0; c < volumes.size(); ++c) n += is_wrongly_nested(volumes[c], winding[c]);
  return n;
}

}  // namespace umtet
