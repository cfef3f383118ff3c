#include "mesh/fast/repair/step_back.h"

#include <oneapi/tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "mesh/base/violations.h"
#include "mesh/core/orientation.h"
#include "mesh/core/tet_quality.h"
#include "mesh/embedding/self_intersections.h"

namespace umtet {
namespace {

// Of h, inwards. Faces that pierce each other do so by less than their sagitta, and one or two such steps free most.
constexpr double kStep = .05;
// Steps after which it is no sagitta any more.
constexpr int kInwardSteps = 8;
// A vertex goes back to the background in so many parts: in one, it would lose more than it has to.
constexpr int kParts = 4;
// The guard of the projection: ProjectionParams::least_quality.
constexpr double kLeastQuality = .2;
// Parts of a step that are tried, longest first.
constexpr std::array<double, 3> kShares = {1, .5, .25};
constexpr std::size_t kVerticesPerTask = 1 << 14;  // to compare places, a nanosecond each

class StepBack {
 public:
  StepBack(const Submesh& submesh, const std::vector<Triangle>& walls, const std::function<double(int)>& h,
           std::vector<Vec3>& V)
      : submesh_(submesh), h_(h), V_(V), faces_(submesh.positive_faces) {
    faces_.insert(faces_.end(), walls.begin(), walls.end());
  }

  StepBackReport operator()(const Context& context) {
    find(context);
    report_.n_pairs = pairs_.size();
    report_.n_inverted = inverted_.size();
    // A stored background that passes through itself leaves pairs that nothing frees; the certificate will say so.
    while ((!pairs_.empty() || !inverted_.empty()) && move()) {
      ++report_.rounds;
      find(context);
    }
    for (const auto& [v, record] : records_) report_.vertices.push_back(v);
    return std::move(report_);
  }

 private:
  /// How far a vertex has gone back.
  struct Record {
    int steps = 0;             ///< inwards, and those that were refused
    int parts = 0;             ///< of the way to its place in the background
    Vec3 from;                 ///< where that way begins
    std::vector<int> ring{};   ///< tets
    std::vector<int> faces{};  ///< positive ones
  };

  void find(const Context& context);
  bool move();
  void list_rings();
  Vec3 normal(const Record& record) const;
  double least_quality(const std::vector<int>& ring) const;
  bool step_inwards(int v, Record& record);
  bool return_part(int v, Record& record);

  const Submesh& submesh_;
  const std::function<double(int)>& h_;
  std::vector<Vec3>& V_;
  std::vector<Triangle> faces_;
  std::vector<std::array<int, 2>> pairs_;
  std::vector<int> inverted_;
  std::map<int, Record> records_;
  StepBackReport report_;
};

void StepBack::find(const Context& context) {
  pairs_ = self_intersections(V_, faces_, context);
  const std::vector<Tet>& C = submesh_.mesh.C;
  std::vector<char> has_moved(V_.size());  // the background's own tets are positive
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, V_.size(), kVerticesPerTask), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) has_moved[i] = V_[i] != submesh_.mesh.V[i];
  });
  std::vector<char> is_inverted(C.size());
  const Violations some = find_violations(C.size(), [&](std::size_t k) {
    const Tet& t = C[k];
    if ((has_moved[t[0]] | has_moved[t[1]] | has_moved[t[2]] | has_moved[t[3]]) == 0) return false;
    is_inverted[k] = orientation_sign(V_[t[0]], V_[t[1]], V_[t[2]], V_[t[3]]) <= 0;
    return is_inverted[k] != 0;
  });
  inverted_.clear();
  for (std::size_t k = some.count > 0 ? some.first : C.size(); k < C.size(); ++k) {
    if (is_inverted[k] != 0) inverted_.push_back(static_cast<int>(k));
  }
}

/// Of the vertices that have not gone anywhere yet.
void StepBack::list_rings() {
  std::vector<Record*> at(V_.size(), nullptr);
  for (auto& [v, record] : records_) {
    if (record.steps == 0 && record.parts == 0) at[v] = &record;
  }
  const std::vector<Tet>& C = submesh_.mesh.C;
  for (std::size_t k = 0; k < C.size(); ++k) {
    for (const int v : C[k])
      if (at[v]) at[v]->ring.push_back(static_cast<int>(k));
  }
  const std::vector<Triangle>& faces = submesh_.positive_faces;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    for (const int v : faces[k])
      if (at[v]) at[v]->faces.push_back(static_cast<int>(k));
  }
}

/// Outward, of the boundary faces weighted by their areas.
Vec3 StepBack::normal(const Record& record) const {
  Vec3 sum = Vec3::Zero();
  for (const int k : record.faces) {
    const Triangle& f = submesh_.positive_faces[k];
    sum += (V_[f[1]] - V_[f[0]]).cross(V_[f[2]] - V_[f[0]]);
  }
  return sum.normalized();
}

double StepBack::least_quality(const std::vector<int>& ring) const {
  double least = 1;
  for (const int k : ring) {
    const Tet& t = submesh_.mesh.C[k];
    least = std::min(least, mean_ratio(V_[t[0]], V_[t[1]], V_[t[2]], V_[t[3]]));
  }
  return least;
}

bool StepBack::step_inwards(int v, Record& record) {
  ++record.steps;
  const Vec3 here = V_[v], n = normal(record);
  const double h = h_(v);
  const double least = std::min(kLeastQuality, least_quality(record.ring));
  for (const double share : kShares) {
    V_[v] = here - share * kStep * h * n;
    if (least_quality(record.ring) >= least) return true;
  }
  V_[v] = here;
  return false;
}

bool StepBack::return_part(int v, Record& record) {
  if (record.parts == kParts) return false;
  if (record.parts == 0) record.from = V_[v];
  const Vec3& to = submesh_.mesh.V[v];
  V_[v] = ++record.parts == kParts ? to : record.from + static_cast<double>(record.parts) / kParts * (to - record.from);
  return true;
}

/// @return whether a vertex has moved, or will another way
bool StepBack::move() {
  std::set<int> of_faces, of_tets;
  for (const auto& pair : pairs_) {
    for (const int f : pair) of_faces.insert(faces_[f].begin(), faces_[f].end());
  }
  for (const int k : inverted_) of_tets.insert(submesh_.mesh.C[k].begin(), submesh_.mesh.C[k].end());
  for (const auto* set : {&of_faces, &of_tets}) {
    for (const int v : *set) {
      if (V_[v] != submesh_.mesh.V[v]) records_.try_emplace(v);
    }
  }
  list_rings();
  bool any = false;
  for (auto& [v, record] : records_) {
    const bool is_torn = of_tets.count(v) != 0;
    if (!is_torn && of_faces.count(v) == 0) continue;
    const bool may_step = !is_torn && record.steps < kInwardSteps && record.parts == 0;
    any |= (may_step && step_inwards(v, record)) || return_part(v, record);
  }
  return any;
}

}  // namespace

StepBackReport step_back(const Submesh& submesh, const std::vector<Triangle>& walls,
                         const std::function<double(int)>& h, std::vector<Vec3>& V, const Context& context) {
  return StepBack(submesh, walls, h, V)(context);
}

}  // namespace umtet
