#include "mesh/fast/flips/local_flips.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "mesh/fast/flips/detail/edge_operations.h"
#include "mesh/fast/flips/detail/edge_rings.h"
#include "mesh/fast/flips/detail/patch_trials.h"

namespace umtet {
namespace {

using Stratum = VertexStratum;
using Operation = detail::FlipCandidate::Operation;

// The remaining tets are tried again with more candidates and a lower bar, and all vertices of a patch move at once:
// this mends half of them or more, at ten times the cost of a try.
constexpr int kMoreCandidates = 3;  // times as many
constexpr int kTriesPerPoll = 64;
// Tets that a pass takes from the queue, per tet that it begins with, and besides: graded bodies need 6, cubes 5, a
// wedge of 45 degrees up to 15 (mesh_tests, *PiecewiseMeshes*). Operations that undo each other would go on for ever.
constexpr std::size_t kMostTurns = 50, kTurnsAnyway = 1000;

/// The queue of tets below the target, and the operations that are kept.
class LocalFlips {
 public:
  LocalFlips(std::vector<Vec3> V, std::vector<Tet> C, const std::vector<Stratum>& stratum, ImplicitFunctionRef psi,
             const LocalFlipParams& params, LocalFlipReport& report, const StratifiedVertices* strata,
             std::vector<int> region)
      : mesh_(std::move(V), std::move(C), stratum, strata, std::move(region)),
        n_given_(mesh_.C.size()),
        alive_(mesh_.C.size(), 1),
        version_(mesh_.C.size(), 0),
        psi_(psi),
        params_(params),
        report_(report),
        trials_(mesh_, psi, params, report) {}

  FlippedMesh operator()(const Context& context) {
    for (is_last_ = false;; is_last_ = true) {
      mend_all(context);
      if (is_last_) return result();
    }
  }

 private:
  using Queued = std::tuple<double, int, int>;  ///< mean ratio, tet, its version

  void mend_all(const Context& context) {
    queue_ = {};
    failures_.assign(mesh_.V.size(), 0);
    for (std::size_t t = 0; t < mesh_.C.size(); ++t)
      if (alive_[t]) enqueue(static_cast<int>(t));
    const auto at_first = static_cast<double>(std::max<std::size_t>(1, queue_.size()));
    const std::size_t most = kMostTurns * queue_.size() + kTurnsAnyway;
    for (std::size_t n = 0; !queue_.empty() && n < most; ++n) {
      if (n % kTriesPerPoll == 0)
        context.report("flips", 1 - std::min(1., static_cast<double>(queue_.size()) / at_first));
      const auto [q, tet, version] = queue_.top();
      queue_.pop();
      if (alive_[tet] && version_[tet] == version) mend(tet);
    }
  }

  void enqueue(int tet) {
    const Tet& t = mesh_.C[tet];
    double q = detail::mean_ratio_of(mesh_.V, t);
    const auto n_on_boundary =
        std::count_if(t.begin(), t.end(), [&](int v) { return mesh_.stratum[v] == Stratum::Boundary; });
    if (n_on_boundary >= 3) q = std::min(q, detail::quality_of_cosine(params_.target, least_cosine(tet)));
    if (q < std::min(params_.target, is_last_ ? params_.mend_below_at_last : params_.mend_below))
      queue_.emplace(q, tet, version_[tet]);
  }

  /// The least cosine of the faces of a tet that lie on the boundary, or between its region and a lesser one.
  double least_cosine(int tet) {
    const Tet& t = mesh_.C[tet];
    double least = 1;
    for (const auto& f : kTetFace) {
      const Triangle face = {t[f[0]], t[f[1]], t[f[2]]};
      if (!std::all_of(face.begin(), face.end(), [&](int v) { return mesh_.stratum[v] == Stratum::Boundary; }))
        continue;
      const int behind = tet_behind(tet, face);
      if (behind >= 0 && mesh_.region_of(behind) >= mesh_.region_of(tet)) continue;
      const Vec3 &a = mesh_.V[face[0]], &b = mesh_.V[face[1]], &c = mesh_.V[face[2]];
      Vec3 gradient;
      const Vec3 centroid = (a + b + c) / 3;
      if (mesh_.stratified && behind >= 0) {
        mesh_.value_between(mesh_.region_of(tet), mesh_.region_of(behind), centroid, gradient);
      } else if (mesh_.stratified) {
        mesh_.value_on_patch(face, centroid, gradient);
      } else {
        psi_.value(centroid, gradient);
      }
      ++report_.psi_evaluations;
      const Vec3 normal = (b - a).cross(c - a);
      const double cosine = normal.dot(gradient) / (normal.norm() * gradient.norm());
      least = std::min(least, std::isfinite(cosine) ? cosine : -1);
    }
    return least;
  }

  /// The other tet with a face; -1: none.
  int tet_behind(int tet, const Triangle& face) const {
    const std::span<const int> around = mesh_.incidence.of(face[0]);
    const auto at = std::find_if(around.begin(), around.end(), [&](int s) {
      return s != tet && detail::contains(mesh_.C[s], face[1]) && detail::contains(mesh_.C[s], face[2]);
    });
    return at == around.end() ? -1 : *at;
  }

  void mend(int tet) {
    const Tet corners = mesh_.C[tet];
    const int most = is_last_ ? params_.most_failures_at_last : params_.most_failures;
    if (std::all_of(corners.begin(), corners.end(), [&](int v) { return failures_[v] >= most; })) return;
    if (was_mended(tet)) return;
    for (const int v : corners) failures_[v] = static_cast<std::uint8_t>(std::min(255, failures_[v] + 1));
  }

  bool was_mended(int tet) {
    const auto most = static_cast<std::size_t>(params_.most_candidates) * (is_last_ ? kMoreCandidates : 1);
    for (const detail::FlipCandidate& c :
         detail::edge_operations(mesh_, tet, is_last_ ? params_.promising_at_last : params_.promising, most))
      if (attempt(c)) return true;
    detail::FlipCandidate c = detail::smoothing_around(mesh_, tet);
    if (attempt(c)) return true;
    c.operation = Operation::SmoothAll;
    return attempt(c);
  }

  /// @return whether it was kept
  bool attempt(const detail::FlipCandidate& c) {
    detail::FlipPatch patch;
    if (!trials_(c, is_last_, patch)) return false;
    commit(c, patch);
    std::size_t& n = c.operation == Operation::RemoveEdge ? report_.n_removed_edges
                     : c.operation == Operation::Collapse ? report_.n_collapsed
                                                          : report_.n_smoothed;
    ++n;
    return true;
  }

  void commit(const detail::FlipCandidate& c, const detail::FlipPatch& patch) {
    for (std::size_t v = 0; v < patch.V.size(); ++v)
      if (patch.moves[v]) mesh_.V[patch.vertices[v]] = patch.V[v];
    if (c.changes_tets()) {
      for (const int t : c.old_tets) {
        alive_[t] = 0;
        for (const int v : mesh_.C[t]) mesh_.incidence.remove(v, t);
      }
      for (const Tet& t : c.new_tets) {
        const auto id = static_cast<int>(mesh_.C.size());
        mesh_.C.push_back(t);
        if (mesh_.has_regions())
          mesh_.region.push_back(c.new_regions[static_cast<std::size_t>(&t - c.new_tets.data())]);
        alive_.push_back(1);
        version_.push_back(0);
        for (const int v : t) mesh_.incidence.add(v, id);
        if (!mesh_.stratified && !mesh_.has_regions()) enqueue(id);
      }
      // With strata once all of them are there: before, a face between two new tets looks like one of the boundary, and
      // the tet is tried in vain. A smooth boundary keeps its bytes.
      if (mesh_.stratified || mesh_.has_regions())
        for (std::size_t k = mesh_.C.size() - c.new_tets.size(); k < mesh_.C.size(); ++k) enqueue(static_cast<int>(k));
    }
    for (const int t : c.changes_tets() ? trials_.kept_tets() : trials_.patch_tets()) {
      ++version_[t];
      enqueue(t);
    }
  }

  FlippedMesh result() {
    FlippedMesh made;
    made.V = std::move(mesh_.V);
    for (std::size_t t = 0; t < mesh_.C.size(); ++t) {
      if (!alive_[t]) continue;
      if (mesh_.has_regions()) made.region.push_back(mesh_.region[t]);
      report_.n_below += detail::mean_ratio_of(made.V, mesh_.C[t]) < params_.target ? 1 : 0;
      made.C.push_back(mesh_.C[t]);
      made.origin.push_back(t < n_given_ ? static_cast<std::int64_t>(t) : -1);
    }
    return made;
  }

  detail::ChangingMesh mesh_;
  const std::size_t n_given_;
  std::vector<std::uint8_t> alive_;
  std::vector<int> version_;
  ImplicitFunctionRef psi_;
  const LocalFlipParams& params_;
  LocalFlipReport& report_;
  detail::PatchTrials trials_;
  std::vector<std::uint8_t> failures_;  ///< per vertex, in this pass
  bool is_last_ = false;                ///< the last pass
  std::priority_queue<Queued, std::vector<Queued>, std::greater<>> queue_;
};

}  // namespace

std::vector<std::string> problems(const LocalFlipParams& params) {
  std::vector<std::string> p;
  if (!(params.target > 0 && params.target < 1)) p.emplace_back("target must be in (0, 1)");
  if (!(params.shortest > 0 && params.shortest < 1)) p.emplace_back("shortest must be in (0, 1)");
  if (!(params.longest > 1)) p.emplace_back("longest must be > 1");
  if (!(params.promising >= 0)) p.emplace_back("promising must be >= 0");
  if (!(params.promising_at_last >= 0)) p.emplace_back("promising_at_last must be >= 0");
  if (params.most_failures < 1 || params.most_failures > 255) p.emplace_back("most_failures must be 1 to 255");
  if (params.most_failures_at_last < 1 || params.most_failures_at_last > 255)
    p.emplace_back("most_failures_at_last must be 1 to 255");
  if (!(params.mend_below > 0)) p.emplace_back("mend_below must be > 0");
  if (!(params.mend_below_at_last > 0)) p.emplace_back("mend_below_at_last must be > 0");
  if (params.most_candidates < 0) p.emplace_back("most_candidates must be >= 0");
  return p;
}

FlippedMesh flip_locally(std::vector<Vec3> V, std::vector<Tet> C, const std::vector<VertexStratum>& stratum,
                         ImplicitFunctionRef psi, const LocalFlipParams& params, LocalFlipReport& report,
                         const Context& context, const StratifiedVertices* strata, std::vector<int> region) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (stratum.size() != V.size() || (strata && strata->of.size() != V.size()))
    all += (all.empty() ? "" : "; ") + std::string("one stratum for each vertex");
  if (!region.empty() && region.size() != C.size())
    all += (all.empty() ? "" : "; ") + std::string("one region for each tet");
  if (!all.empty()) throw std::invalid_argument(all);
  return LocalFlips(std::move(V), std::move(C), stratum, psi, params, report, strata, std::move(region))(context);
}

}  // namespace umtet
