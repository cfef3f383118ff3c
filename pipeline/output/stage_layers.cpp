#include "pipeline/output/stage_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/polled_loops.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/output/detail/scene_blocks.h"

namespace umtet {
namespace {

struct KindOfMark {
  SampleMark mark;
  const char *id, *name;
};
constexpr std::array kKindsOfMarks = {
    KindOfMark{SampleMark::Outlier, "outliers", "dropped outliers"},
    KindOfMark{SampleMark::SmallComponent, "small_components", "dropped small pieces"},
    KindOfMark{SampleMark::NoNormal, "no_normal", "dropped, without a normal"},
    KindOfMark{SampleMark::Turned, "turned", "normal turned over"},
    KindOfMark{SampleMark::Doubtful, "doubtful", "side is a guess"}};

// The colour of a few samples far from psi = 0 must not make all others look alike.
constexpr double kShownShare = .995;

class LayerMaker {
 public:
  LayerMaker(std::size_t most, SampleLayers& into) : most_(most), into_(into) {}

  /// Adds a layer. @return the indices of the points that it shows
  std::vector<std::size_t> add(const char* id, const char* name, const std::vector<Vec3>& all, const Vec3& shift) {
    const std::size_t step = all.size() / most_ + 1;
    std::vector<std::size_t> picked;
    std::vector<Vec3> points;
    SampleLayer layer;
    layer.id = id;
    layer.name = name;
    layer.n = all.size();
    for (std::size_t i = 0; i < all.size(); i += step) {
      picked.push_back(i);
      points.push_back(all[i] + shift);
    }
    Box box;
    for (const Vec3& x : points) box.extend(x);
    if (!points.empty()) {
      layer.box_min = box.min();
      layer.box_size = box.sizes();
    }
    layer.n_shown = points.size();
    add_block(layer, "", detail::position_block(points, layer.box_min, layer.box_size));
    into_.layers.push_back(std::move(layer));
    return picked;
  }
  void add_normals(const std::vector<Vec3>& normals, const std::vector<std::size_t>& picked) {
    std::vector<Vec3> shown;
    for (const std::size_t i : picked) shown.push_back(normals[i]);
    into_.layers.back().has_normals = true;
    add_block(into_.layers.back(), "_normals", detail::direction_block(shown));
  }
  void add_values(const std::string& name, const std::vector<double>& values) {
    std::vector<double> sorted;
    for (const double v : values)
      if (!std::isnan(v)) sorted.push_back(v);
    if (sorted.empty()) return;
    std::sort(sorted.begin(), sorted.end());
    const double most = sorted[static_cast<std::size_t>(kShownShare * static_cast<double>(sorted.size() - 1))];
    std::vector<std::uint8_t> bytes;
    for (const double v : values) bytes.push_back(detail::in_known_steps(v, 0, most));
    SampleLayer& layer = into_.layers.back();
    add_block(layer, "_value_" + std::to_string(layer.values.size()), detail::byte_block(bytes));
    layer.values.push_back({name, {0, most}});
  }

 private:
  void add_block(const SampleLayer& layer, const std::string& suffix, std::string text) {
    into_.blocks.emplace_back("layer_" + layer.id + suffix, std::move(text));
  }
  std::size_t most_;
  SampleLayers& into_;
};

}  // namespace

std::vector<double> residuals(const Domain& domain, const std::vector<Vec3>& points) {
  std::vector<double> off(points.size());
  domain.with_psi_apart([&](ImplicitFunctionRef psi) {
    polled_parallel_for(points.size(), umtet::kValuesPerPoll, until_interrupted(), [&](std::size_t i) {
      Vec3 g;
      const double value = psi.value(points[i], g);
      off[i] = std::abs(value) / g.norm();
      if (!std::isfinite(off[i])) off[i] = std::numeric_limits<double>::quiet_NaN();
    });
  });
  return off;
}

SampleLayers sample_layers(const OrientedPointCloud& cloud, const Vec3& shift, const std::vector<MarkedSample>& marked,
                           const Domain* domain, std::size_t most) {
  SampleLayers made;
  LayerMaker maker(most, made);
  const std::vector<std::size_t> picked = maker.add("samples", "samples", cloud.points, shift);
  if (!cloud.normals.empty()) maker.add_normals(cloud.normals, picked);
  if (domain) {
    std::vector<Vec3> points;
    for (const std::size_t i : picked) points.push_back(cloud.points[i]);
    maker.add_values("residual", residuals(*domain, points));
  }
  for (const KindOfMark& kind : kKindsOfMarks) {
    std::vector<Vec3> points;
    for (const MarkedSample& sample : marked)
      if (sample.mark == kind.mark) points.push_back(sample.where);
    if (!points.empty()) maker.add(kind.id, kind.name, points, Vec3::Zero());
  }
  return made;
}

Json to_json(const SampleLayer& layer) {
  Json values = Json::array();
  for (const SceneHead::Field& f : layer.values)
    values.push_back({{"name", f.name}, {"range", {f.range.least, f.range.most}}});
  return {{"id", layer.id},
          {"name", layer.name},
          {"box_min", json_of(layer.box_min)},
          {"box_size", json_of(layer.box_size)},
          {"n", layer.n},
          {"n_shown", layer.n_shown},
          {"normals", layer.has_normals},
          {"values", values}};
}

}  // namespace umtet
