#include "reconstruct/cloud/neighbours/neighbour_tree.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <flann/flann.hpp>
#include <stdexcept>
#include <string>

#include "common/first_touch.h"
#include "reconstruct/cloud/neighbours/morton_order.h"

namespace umtet {
namespace {

using Distance = flann::L2_3D<double>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// FLANN compares what it has already summed up over the walk with the bound, so the bound is a few roundings
// more than the distance, lest points at exactly that distance are lost; the result sets compare again.
constexpr double kRounding = 1 + 1e-12;
double rounded_up(double distance2) { return kRounding * distance2 + std::numeric_limits<double>::min(); }

// Points a leaf; the time of a search hardly depends on it.
constexpr int kLeafSize = 16;
// FLANN builds a tree on one thread. So there are some, of stretches of Morton's curve, which are compact: as many as
// threads can build at once, none so small that looking at its box costs more than it saves.
constexpr std::size_t kMostPieces = 16, kLeastPerPiece = 1 << 15;
// Some 100 us of searches: a task costs less than a hundredth of that.
constexpr std::size_t kQueriesPerTask = 128;

/// What FLANN calls a result set, of rows of all pieces.
class RowResult : public flann::ResultSet<double> {
 public:
  std::size_t first_row = 0;  ///< of the piece that is searched
  void addPoint(double distance2, std::size_t row) final { add(distance2, first_row + row); }

 private:
  virtual void add(double distance2, std::size_t row) = 0;
};

/// The nearest few so far, in order. They are rows of the tree until the end: looking up every candidate's number would
/// cost a cache line each, and only equal distances ask for it.
class NearestFew final : public RowResult {
 public:
  /// @param bound2  at least the squared distance of the last one there will be room for
  NearestFew(const std::uint32_t* order, std::span<Neighbour> room, double bound2 = kInfinity)
      : order_(order), room_(room), bound_(bound2) {}
  bool full() const override { return size_ == room_.size(); }
  double worstDist() const override { return bound_; }
  void add(double distance2, std::size_t row) override {
    const Neighbour found{distance2, static_cast<std::uint32_t>(row)};
    if (size_ < room_.size())
      ++size_;
    else if (!is_before(found, room_[size_ - 1]))
      return;
    std::size_t at = size_ - 1;
    for (; at > 0 && is_before(found, room_[at - 1]); --at) room_[at] = room_[at - 1];
    room_[at] = found;
    if (size_ == room_.size()) bound_ = rounded_up(room_[size_ - 1].distance2);
  }
  void rows(std::vector<std::uint32_t>& out) const {
    out.resize(size_);
    for (std::size_t i = 0; i < size_; ++i) out[i] = room_[i].point;
  }
  /// Ends the search: points instead of rows.
  std::span<const Neighbour> points() {
    for (Neighbour& found : room_.first(size_)) found.point = order_[found.point];
    return room_.first(size_);
  }

 private:
  bool is_before(const Neighbour& a, const Neighbour& b) const {
    return a.distance2 < b.distance2 || (a.distance2 == b.distance2 && order_[a.point] < order_[b.point]);
  }
  const std::uint32_t* order_;
  std::span<Neighbour> room_;
  std::size_t size_ = 0;
  double bound_;
};

/// Hands on what is in a ball.
class Ball final : public RowResult {
 public:
  Ball(const std::vector<std::uint32_t>& order, double radius2, const std::function<void(std::uint32_t, double)>& visit)
      : order_(order), radius2_(radius2), bound_(rounded_up(radius2)), visit_(visit) {}
  bool full() const override { return true; }
  double worstDist() const override { return bound_; }
  void add(double distance2, std::size_t row) override {
    if (distance2 <= radius2_) visit_(order_[row], distance2);
  }

 private:
  const std::vector<std::uint32_t>& order_;
  double radius2_, bound_;
  const std::function<void(std::uint32_t, double)>& visit_;
};

/// Counts what is in a ball up to a limit, and ends the search there: no box is nearer than -1.
class Count final : public RowResult {
 public:
  Count(double radius2, std::size_t limit) : radius2_(radius2), bound_(rounded_up(radius2)), limit_(limit) {}
  bool full() const override { return count_ >= limit_; }
  double worstDist() const override { return full() ? -1 : bound_; }
  void add(double distance2, std::size_t) override { count_ += distance2 <= radius2_ ? 1 : 0; }
  std::size_t count() const { return std::min(count_, limit_); }

 private:
  double radius2_, bound_;
  std::size_t limit_, count_ = 0;
};

void require_place(const Vec3& x, std::size_t number) {
  if (!x.allFinite()) throw std::invalid_argument("points[" + std::to_string(number) + "] is not finite");
  if (x.cwiseAbs().maxCoeff() > NeighbourTree::kLargestCoordinate)
    throw std::invalid_argument("coordinates beyond 1e153: squared distances overflow");
}

}  // namespace

double squared_distance(const Vec3& a, const Vec3& b) { return Distance()(a.data(), b.data(), 3); }

struct NeighbourTree::Index {
  struct Piece {
    std::size_t first_row;
    Eigen::AlignedBox3d box;
    flann::KDTreeSingleIndex<Distance> tree;

    Piece(std::vector<Vec3>& rows, std::size_t first, std::size_t end)
        : first_row(first),
          tree(flann::Matrix<double>(rows[first].data(), end - first, 3), flann::KDTreeSingleIndexParams(kLeafSize)) {
      for (std::size_t row = first; row < end; ++row) box.extend(rows[row]);
      tree.buildIndex();
    }
  };
  Eigen::AlignedBox3d box;
  std::vector<Vec3> rows;  // the points along the curve; FLANN keeps pointers into them
  std::vector<std::unique_ptr<Piece>> pieces;

  explicit Index(std::vector<Vec3> sorted) : rows(std::move(sorted)) {
    const std::size_t n = std::clamp<std::size_t>(rows.size() / kLeastPerPiece, 1, kMostPieces);
    pieces.resize(n);
    tbb::parallel_for(
        std::size_t{0}, n,
        [&](std::size_t p) {
          pieces[p] = std::make_unique<Piece>(rows, p * rows.size() / n, (p + 1) * rows.size() / n);
        },
        tbb::simple_partitioner());
    for (const auto& piece : pieces) box.extend(piece->box);
  }
  /// The nearest piece first: what it has bounds the search of the others.
  void search(RowResult& found, const Vec3& x) const {
    std::array<double, kMostPieces> distance2;
    std::size_t nearest = 0;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      distance2[p] = pieces[p]->box.squaredExteriorDistance(x);
      if (distance2[p] < distance2[nearest]) nearest = p;
    }
    search(*pieces[nearest], found, x);
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      if (p != nearest && distance2[p] <= found.worstDist()) search(*pieces[p], found, x);
    }
  }

 private:
  static void search(const Piece& piece, RowResult& found, const Vec3& x) {
    found.first_row = piece.first_row;
    piece.tree.findNeighbors(found, x.data(), flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED, 0.0F));
  }
};

/// Finds the first accepted point of a piece of the tube around a ray, in a ball that contains the piece.
class NeighbourTree::TubePiece final : public RowResult {
 public:
  TubePiece(const NeighbourTree& tree, const Vec3& x, const Vec3& d, const std::array<double, 2>& from_to,
            double width2, double reach2, const std::function<bool(std::uint32_t)>& accept)
      : tree_(tree), x_(x), d_(d), from_to_(from_to), width2_(width2), reach2_(reach2), accept_(accept) {}
  bool full() const override { return true; }
  double worstDist() const override { return reach2_; }
  void add(double, std::size_t row) override {
    const Vec3 r = tree_.index_->rows[row] - x_;
    const double t = r.dot(d_);
    if (t < from_to_[0] || t > from_to_[1] || t > hit_.t || (r - t * d_).squaredNorm() > width2_) return;
    const std::uint32_t point = tree_.order_[row];
    if ((t < hit_.t || point < hit_.point) && accept_(point)) hit_ = {t, point};
  }
  const Hit& hit() const { return hit_; }

 private:
  const NeighbourTree& tree_;
  const Vec3 &x_, &d_;
  std::array<double, 2> from_to_;
  double width2_, reach2_;
  const std::function<bool(std::uint32_t)>& accept_;
  Hit hit_;
};

NeighbourTree::NeighbourTree(const std::vector<Vec3>& points) {
  if (points.empty()) throw std::invalid_argument("a cloud without points has no neighbours");
  if (points.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw std::invalid_argument(std::to_string(points.size()) + " points: more than FLANN can number");
  for (std::size_t i = 0; i < points.size(); ++i) require_place(points[i], i);
  order_ = morton_order(points);
  std::vector<Vec3> rows = touched<Vec3>(points.size());
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t row) { rows[row] = points[order_[row]]; });
  index_ = std::make_unique<Index>(std::move(rows));
}

NeighbourTree::~NeighbourTree() = default;
NeighbourTree::NeighbourTree(NeighbourTree&&) noexcept = default;
NeighbourTree& NeighbourTree::operator=(NeighbourTree&&) noexcept = default;

std::span<const Neighbour> NeighbourTree::k_nearest(const Vec3& x, std::span<Neighbour> room) const {
  if (room.empty()) return room;
  NearestFew nearest(order_.data(), room);
  index_->search(nearest, x);
  return nearest.points();
}

void NeighbourTree::for_each_neighbourhood(
    std::size_t k, const std::function<void(std::uint32_t, std::span<const Neighbour>)>& visit) const {
  if (k == 0) throw std::invalid_argument("k = 0 neighbours: must be >= 1");
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size(), kQueriesPerTask),
                    [&](const tbb::blocked_range<std::size_t>& rows) {
                      std::vector<Neighbour> room(std::min(k, size()));
                      std::vector<std::uint32_t> former;  // rows of what the point before has found: as many as wanted
                      for (std::size_t row = rows.begin(); row != rows.end(); ++row) {
                        const Vec3& x = index_->rows[row];
                        double bound2 = former.empty() ? kInfinity : 0;
                        for (const std::uint32_t near : former) {
                          bound2 = std::max(bound2, (x - index_->rows[near]).squaredNorm());
                        }
                        NearestFew nearest(order_.data(), room, rounded_up(bound2));
                        index_->search(nearest, x);
                        nearest.rows(former);
                        visit(order_[row], nearest.points());
                      }
                    });
}

void NeighbourTree::visit_ball(const Vec3& x, double radius2,
                               const std::function<void(std::uint32_t, double)>& visit) const {
  Ball ball(order_, radius2, visit);
  index_->search(ball, x);
}

std::size_t NeighbourTree::count_within(const Vec3& x, double radius2, std::size_t limit) const {
  Count count(radius2, limit);
  index_->search(count, x);
  return count.count();
}

NeighbourTree::Hit NeighbourTree::first_along(const Vec3& x, const Vec3& d, double t_min, double width,
                                              const std::function<bool(std::uint32_t)>& accept) const {
  if (!(width > 0)) throw std::invalid_argument("first_along: width must be > 0");
  if (d.isZero(0)) return {};
  // Positions on the ray are rounded: this share of the width covers it as long as coordinates hold six digits of that.
  constexpr double kSlack = 1e-6;
  const double width2 = width * width, slack = kSlack * width;
  const double t_end = (x - index_->box.min()).cwiseAbs().cwiseMax((index_->box.max() - x).cwiseAbs()).norm() + width;
  for (double t = t_min; t <= t_end;) {
    // Where a ball is empty, so is the part of the tube within it. Balls an eighth of the way long keep their number
    // logarithmic. Larger ones cost more than they save: FLANN bounds cells by its cuts and not by their points, so
    // that it visits many for an empty ball inside a body.
    const double least = 2 * width;
    double radius = std::max(least, (t - t_min) / 8);
    while (radius > least && count_within(x + t * d, radius * radius, 1) > 0) radius = std::max(least, radius / 2);
    if (radius > least) {
      t += std::sqrt(radius * radius - width2) - slack;
      continue;
    }
    // Between samples: the next piece of the tube, twice as long as its radius, within a ball.
    const double next = std::max(t + 2 * width, std::nextafter(t, kInfinity));
    const double reach2 = 2 * (width + slack) * (width + slack);
    TubePiece piece(*this, x, d, {t_min, next}, width2, reach2, accept);
    index_->search(piece, x + (t + width) * d);
    if (piece.hit().t <= next) return piece.hit();
    t = next;
  }
  return {};
}

}  // namespace umtet
