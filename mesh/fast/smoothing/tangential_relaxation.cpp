#include "mesh/fast/smoothing/tangential_relaxation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/fast/defects/patch_state.h"

namespace umtet {
namespace {

// In h: the chords are linear in a step only while the faces around stay much as they are.
constexpr double kLongestStep = .25;
constexpr int kTrials = 4;          // lengths of a step that are tried
constexpr double kLeastGain = .01;  // a move has to lower the sum by this share: by 1 %
constexpr double kDamping = .05;    // added to the diagonal of the matrix, relative to its trace

/// Gamma_h^+
std::vector<Triangle> boundary_faces(const ActiveLayer& layer, const std::vector<std::uint8_t>& inside) {
  std::vector<Triangle> faces;
  Triangle face;
  for (const Tet& t : layer.C) {
    if (positive_face(t, inside, face)) faces.push_back(face);
  }
  return faces;
}

/// Boundary faces by their corners.
struct Fans {
  std::vector<int> begin;                  ///< per vertex of the layer, into others
  std::vector<std::array<int, 2>> others;  ///< the next and the last corner of each face

  Fans(const std::vector<Triangle>& faces, std::size_t n_vertices)
      : begin(n_vertices + 1, 0), others(3 * faces.size()) {
    for (const Triangle& f : faces) {
      for (const int v : f) ++begin[v + 1];
    }
    for (std::size_t v = 0; v < n_vertices; ++v) begin[v + 1] += begin[v];
    std::vector<int> next(begin.begin(), begin.end() - 1);
    for (const Triangle& f : faces) {
      for (int k = 0; k < 3; ++k) others[next[f[k]]++] = {f[(k + 1) % 3], f[(k + 2) % 3]};
    }
  }
};

/// What the faces around a place miss of psi = 0.
struct Chords {
  double sum = 0;   ///< of e^4, e in h
  double most = 0;  ///< e in h
  double least_cosine = 1;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();  ///< of sum / 4, tangential, per h
  /// Matrix of the normal equations of reweighted least squares, sum of e^2 (h grad e)(h grad e)^T: each e has the
  /// weight e^2 that it has now, as if e^4 were e^2 times a constant.
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
};

class VertexSolver {
 public:
  VertexSolver(const PNormSmoother& smoother, ImplicitFunctionRef psi, const Fans& fans,
               const TangentialRelaxationParams& params, const ClosestPointParams& closest_point)
      : smoother_(smoother),
        layer_(smoother.layer()),
        psi_(psi),
        fans_(fans),
        params_(params),
        closest_point_(closest_point),
        least_f_(f_of_quality(params.least_quality)),
        least_f_near_(f_of_quality(params.least_quality + params.near_margin)) {}

  /// @return true if `place` is better
  bool operator()(int i, Vec3& place, std::size_t& evaluations) const {
    const Vec3 x = layer_.V[i];
    const double h = layer_.h_at(i);
    Vec3 g;
    psi_.value(x, g);
    ++evaluations;
    Eigen::Matrix<double, 3, 2> tangents;
    tangents.col(0) = g.unitOrthogonal();
    tangents.col(1) = g.normalized().cross(tangents.col(0));
    const Chords now = chords(i, x, &tangents, evaluations);
    if (!(now.most >= params_.least_chord)) return false;
    const double damping = kDamping * now.normal.trace();
    if (!(damping > 0)) return false;
    Eigen::Vector2d step = -(now.normal + damping * Eigen::Matrix2d::Identity()).inverse() * now.gradient * h;
    const double length = step.norm();
    if (!std::isfinite(length)) return false;
    if (length > kLongestStep * h) step *= kLongestStep * h / length;
    const OneRing ring = smoother_.ring(i);
    const double bar = std::min(now.most < params_.far_chord ? least_f_near_ : least_f_, ring.f_here);
    const double least_cosine = std::min(now.least_cosine, kMisalignedCosine);
    for (int trial = 0; trial < kTrials; ++trial, step *= .5) {
      const Vec3 y = tangents * step;
      if (ring.min_f(y) < bar) continue;
      const ClosestPoint foot = closest_point(psi_, x + y, h, closest_point_);
      evaluations += static_cast<std::size_t>(foot.iterations);
      if (!foot.converged || ring.min_f(foot.point - x) < bar) continue;
      const Chords then = chords(i, foot.point, nullptr, evaluations);
      if (!(then.sum < (1 - kLeastGain) * now.sum) || then.least_cosine < least_cosine) continue;
      place = foot.point;
      return true;
    }
    return false;
  }

 private:
  Chords chords(int i, const Vec3& x, const Eigen::Matrix<double, 3, 2>* tangents, std::size_t& evaluations) const {
    Chords c;
    const double h = layer_.h_at(i);
    const auto look = [&](const Vec3& m, double share) {
      Vec3 g;
      const double value = psi_.value(m, g), norm = g.norm(), e = value / (norm * h);
      ++evaluations;
      c.sum += e * e * e * e;
      c.most = std::max(c.most, std::abs(e));
      g /= norm;
      if (tangents) {
        const Eigen::Vector2d slope = share * tangents->transpose() * g;
        c.gradient += e * e * e * slope;
        c.normal += e * e * slope * slope.transpose();
      }
      return g;
    };
    for (int k = fans_.begin[i]; k < fans_.begin[i + 1]; ++k) {
      const Vec3 &a = layer_.V[fans_.others[k][0]], &b = layer_.V[fans_.others[k][1]];
      look((x + a) / 2, .5);  // each edge is the first of one face
      const Vec3 g = look((x + a + b) / 3, 1. / 3), n = (a - x).cross(b - x);
      c.least_cosine = std::min(c.least_cosine, n.dot(g) / n.norm());
    }
    return c;
  }

  const PNormSmoother& smoother_;
  const ActiveLayer& layer_;
  ImplicitFunctionRef psi_;
  const Fans& fans_;
  const TangentialRelaxationParams& params_;
  const ClosestPointParams& closest_point_;
  double least_f_, least_f_near_;
};

// A quick test of the middle of a face alone. Where e at the middles of the edges is e_1, e_2, e_3 and psi a quadratic,
// it is 4/9 (e_1 + e_2 + e_3) at the middle of the face: more than a third of the greatest, if all have one sign.
constexpr double kMiddleOverEdge = 1. / 3;

/// Is psi = 0 farther from the face than `least`, at its middle or those of its edges?
bool is_far(ImplicitFunctionRef psi, const Vec3& a, const Vec3& b, const Vec3& c, double least, int& evaluations) {
  const auto farther = [&](const Vec3& m, double than) {
    Vec3 g;
    ++evaluations;
    return std::abs(psi.value(m, g)) > than * g.norm();
  };
  const Vec3 middle = (a + b + c) / 3;
  if (!farther(middle, kMiddleOverEdge * least)) return false;
  return farther(middle, least) || farther((a + b) / 2, least) || farther((b + c) / 2, least) ||
         farther((c + a) / 2, least);
}

/// By colour, ascending.
std::vector<std::vector<int>> vertices_of_far_faces(const ActiveLayer& layer, ImplicitFunctionRef psi,
                                                    const std::vector<Triangle>& faces,
                                                    const TangentialRelaxationParams& params, const Context& context,
                                                    TangentialRelaxationReport& report) {
  std::vector<std::uint8_t> far(faces.size(), 0);
  std::vector<int> evaluations(faces.size(), 0);
  for_each_asking(psi, faces.size(), kValuesPerPoll, context, [&](std::size_t k) {
    const Triangle& f = faces[k];
    far[k] =
        is_far(psi, layer.V[f[0]], layer.V[f[1]], layer.V[f[2]], params.least_chord * layer.h_at(f[0]), evaluations[k]);
  });
  std::vector<std::uint8_t> chosen(layer.V.size(), 0);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    report.psi_evaluations += static_cast<std::size_t>(evaluations[k]);
    if (far[k] == 0) continue;
    for (const int v : faces[k]) chosen[v] = layer.role[v] == ActiveLayer::Role::Boundary;
  }
  std::vector<std::vector<int>> colours;
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    if (chosen[v] == 0) continue;
    const auto colour = static_cast<std::size_t>(layer.colour[v]);
    if (colour >= colours.size()) colours.resize(colour + 1);
    colours[colour].push_back(static_cast<int>(v));
    ++report.vertices;
  }
  return colours;
}

}  // namespace

std::vector<std::string> problems(const TangentialRelaxationParams& params) {
  std::vector<std::string> list;
  const auto refuse = [&](const char* name, double value, const char* rule) {
    list.push_back(std::string(name).append(" = ").append(std::to_string(value)).append(": must be ").append(rule));
  };
  if (!(params.least_chord > 0)) refuse("least_chord", params.least_chord, "> 0");
  if (!(params.least_quality > 0 && params.least_quality < 1))
    refuse("least_quality", params.least_quality, "> 0 and < 1");
  if (!(params.near_margin >= 0)) refuse("near_margin", params.near_margin, ">= 0");
  if (!(params.far_chord >= 0)) refuse("far_chord", params.far_chord, ">= 0");
  if (params.sweeps < 0) refuse("sweeps", params.sweeps, ">= 0");
  if (params.inner_sweeps < 0) refuse("inner_sweeps", params.inner_sweeps, ">= 0");
  return list;
}

TangentialRelaxationReport relax_tangentially(PNormSmoother& smoother, const std::vector<std::uint8_t>& inside,
                                              ImplicitFunctionRef psi, const TangentialRelaxationParams& params,
                                              SmoothingParams smoothing, const Context& context) {
  if (const auto list = problems(params); !list.empty()) {
    std::string all;
    for (const std::string& problem : list) all += (all.empty() ? "" : "; ") + problem;
    throw std::invalid_argument(all);
  }
  ActiveLayer& layer = smoother.layer();
  const std::vector<Triangle> faces = boundary_faces(layer, inside);
  TangentialRelaxationReport report;
  const std::vector<std::vector<int>> colours = vertices_of_far_faces(layer, psi, faces, params, context, report);
  if (smoother.sum(report.vertices) == 0) return report;
  const Fans fans(faces, layer.V.size());
  const VertexSolver solve(smoother, psi, fans, params, smoothing.closest_point);
  smoothing.max_sweeps = params.inner_sweeps;
  std::vector<std::size_t> evaluations(layer.V.size());
  std::vector<ActiveLayer::Role> roles = layer.role;
  for (int sweep = 0; sweep < params.sweeps; ++sweep) {
    std::size_t moves = 0;
    for (int c = 0; c < smoother.n_colours(); ++c) {
      const std::vector<int> none, &colour = static_cast<std::size_t>(c) < colours.size() ? colours[c] : none;
      std::vector<std::uint8_t> moved(colour.size(), 0);
      for_each_asking(psi, colour.size(), kValuesPerPoll / 64, context, [&](std::size_t k) {
        const int i = colour[k];
        Vec3 place;
        moved[k] = solve(i, place, evaluations[i]);
        if (!moved[k]) return;
        layer.V[i] = place;
        smoother.enqueue(i);
      });
      moves += static_cast<std::size_t>(std::count(moved.begin(), moved.end(), 1));
      smoother.pass_on(c);
    }
    report.moves += moves;
    if (smoother.sum(moves) == 0) break;
    for (ActiveLayer::Role& role : layer.role)
      role = role == ActiveLayer::Role::Boundary ? ActiveLayer::Role::Fixed : role;
    smoother.run(psi, smoothing, context);
    layer.role = roles;
  }
  for (const std::size_t n : evaluations) report.psi_evaluations += n;
  return report;
}

}  // namespace umtet
