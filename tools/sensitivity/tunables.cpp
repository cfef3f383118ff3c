#include "tools/sensitivity/tunables.h"

#include <type_traits>
#include <utility>

#include "mesh/background/tiling.h"
#include "mesh/classification/configuration_costs.h"

namespace umtet::sensitivity {
namespace {

/// @param field  of Settings to a reference
template <class F>
Tunable of(std::string name, std::vector<double> values, F field) {
  return {std::move(name), std::move(values),
          [field](Settings& s, double value) {
            auto& at = field(s);
            at = static_cast<std::remove_reference_t<decltype(at)>>(value);
          },
          [field](const Settings& s) {
            Settings copy = s;
            return static_cast<double>(field(copy));
          }};
}

template <class F>
Tunable of_moving(std::string name, std::vector<double> values, F field) {
  Tunable made = of(std::move(name), std::move(values), field);
  made.is_of_moving = true;
  return made;
}

std::vector<Tunable> of_classification() {
  const auto c = [](Settings& s) -> ClassificationParams& { return s.fast.classification; };
  return {
      of(
          "ClassificationParams::shift", {0, .05, .15}, [=](Settings & s) -> auto& { return c(s).shift; }),
      of(
          "ClassificationParams::reach_in", {.4, .6, .75, 1.2}, [=](Settings & s) -> auto& { return c(s).reach_in; }),
      of(
          "ClassificationParams::reach_out", {0, .1, .35, .5}, [=](Settings & s) -> auto& { return c(s).reach_out; }),
      of(
          "ClassificationParams::most_stretch",
          {1, 1.1, 1.3, 1.4, 2, 1e6}, [=](Settings & s) -> auto& { return c(s).most_stretch; }),
      of(
          "ClassificationParams::least_thickness",
          {0, .5, 1.5, 2}, [=](Settings & s) -> auto& { return c(s).least_thickness; }),
      of(
          "ClassificationParams::outside_weight",
          {5, 10, 20, 60, 80}, [=](Settings & s) -> auto& { return c(s).outside_weight; }),
      of(
          "ClassificationParams::outside_height",
          {-.15, 0, .05, .15, .2, .3}, [=](Settings & s) -> auto& { return c(s).outside_height; }),
      of(
          "ClassificationParams::inside_weight",
          {0, 5, 10, 30, 40}, [=](Settings & s) -> auto& { return c(s).inside_weight; }),
      of(
          "ClassificationParams::inside_depth",
          {.3, .4, .6, .7}, [=](Settings & s) -> auto& { return c(s).inside_depth; }),
      of(
          "ClassificationParams::max_sweeps", {2, 5, 10, 20}, [=](Settings & s) -> auto& { return c(s).max_sweeps; }),
      of_moving(
          "ClassificationParams::keep", {0, .3, 3, 10}, [=](Settings & s) -> auto& { return c(s).keep; }),
  };
}

/// The quality that costs nothing in A15.
Tunable good_in_a15() {
  return {"kGoodInA15",
          {.9, .915, .94, .95, .97},
          [](Settings& s, double value) { s.good = value; },
          [](const Settings&) { return configuration_costs(a15())->good; }};
}

/// How much is left below other targets; margins and gains stay as they are.
Tunable quality_target() {
  return {"kQualityTarget",
          {.8, .81, .83, .84},
          [](Settings& s, double value) { s.fast.smoothing.target = s.fast.repair.target = value; },
          [](const Settings& s) { return s.fast.smoothing.target; }};
}

std::vector<Tunable> of_smoothing(const std::string& of_whom, SmoothingParams& (*p)(Settings&), bool is_of_patches) {
  std::vector<Tunable> list = {
      of(
          of_whom + "margin",
          is_of_patches ? std::vector{0., .02, .03, .06} : std::vector{0., .01, .02, .027, .04, .05, .07},
          [=](Settings & s) -> auto& { return p(s).margin; }),
      of(
          of_whom + "fine_gain", is_of_patches ? std::vector{2e-5, 1e-4, 1e-3} : std::vector{2e-6, 7e-6, 6e-5, 2e-4},
          [=](Settings & s) -> auto& { return p(s).fine_gain; }),
      of(
          of_whom + "least_step", is_of_patches ? std::vector{.0075} : std::vector{0., .004, .015, .03},
          [=](Settings & s) -> auto& { return p(s).least_step; }),
      of(
          of_whom + "max_sweeps", is_of_patches ? std::vector{4., 8., 30.} : std::vector{5., 10., 20., 30., 120.},
          [=](Settings & s) -> auto& { return p(s).max_sweeps; }),
  };
  if (!is_of_patches) {
    list.push_back(of(
        of_whom + "least_gain", {3e-5, 1e-4, 1e-3}, [=](Settings & s) -> auto& { return p(s).least_gain; }));
  }
  return list;
}

std::vector<Tunable> of_projection() {
  const auto p = [](Settings& s) -> ProjectionParams& { return s.fast.projection; };
  return {
      of(
          "ProjectionParams::passes", {1, 2, 4, 5}, [=](Settings & s) -> auto& { return p(s).passes; }),
      of(
          "ProjectionParams::max_rounds", {3, 6, 10, 40}, [=](Settings & s) -> auto& { return p(s).max_rounds; }),
      of(
          "ProjectionParams::least_quality",
          {.05, .1, .3, .4, .5}, [=](Settings & s) -> auto& { return p(s).least_quality; }),
      of(
          "ProjectionParams::sweeps", {0, 1, 2, 5}, [=](Settings & s) -> auto& { return p(s).sweeps; }),
  };
}

std::vector<Tunable> of_relaxation() {
  const auto p = [](Settings& s) -> TangentialRelaxationParams& { return s.relaxation; };
  return {
      of(
          "TangentialRelaxationParams::least_chord",
          {.03, .06, .15, .2}, [=](Settings & s) -> auto& { return p(s).least_chord; }),
      of(
          "TangentialRelaxationParams::near_margin",
          {0, .01, .03}, [=](Settings & s) -> auto& { return p(s).near_margin; }),
      of(
          "TangentialRelaxationParams::far_chord",
          {.1, .16, .25}, [=](Settings & s) -> auto& { return p(s).far_chord; }),
      of(
          "TangentialRelaxationParams::sweeps", {0, 3, 12}, [=](Settings & s) -> auto& { return p(s).sweeps; }),
      of(
          "TangentialRelaxationParams::inner_sweeps",
          {0, 1, 6}, [=](Settings & s) -> auto& { return p(s).inner_sweeps; }),
  };
}

std::vector<Tunable> of_repair() {
  const auto p = [](Settings& s) -> RepairParams& { return s.fast.repair; };
  return {
      of(
          "RepairParams::reach", {1, 2, 4}, [=](Settings & s) -> auto& { return p(s).reach; }),
      of(
          "RepairParams::max_tries", {0, 6, 12, 48}, [=](Settings & s) -> auto& { return p(s).max_tries; }),
      of(
          "RepairParams::max_patches", {100, 300, 1000}, [=](Settings & s) -> auto& { return p(s).max_patches; }),
      of(
          "RepairParams::all_vertices", {0}, [=](Settings & s) -> auto& { return p(s).all_vertices; }),
      of(
          "RepairParams::lift", {0, .005, .02}, [=](Settings & s) -> auto& { return p(s).lift; }),
      of(
          "RepairParams::target_step", {0, .005, .02}, [=](Settings & s) -> auto& { return p(s).target_step; }),
      of(
          "RepairParams::slides", {0}, [=](Settings & s) -> auto& { return p(s).slides; }),
      of(
          "RepairParams::reach_out", {.2, .35, .8}, [=](Settings & s) -> auto& { return p(s).reach_out; }),
  };
}

std::vector<Tunable> all() {
  std::vector<Tunable> list = {quality_target(), good_in_a15()};
  const auto add = [&](std::vector<Tunable> more) {
    list.insert(list.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  add(of_classification());
  add({of(
      "FastParams::layers", {1, 3, 4}, [](Settings & s) -> auto& { return s.fast.layers; })});
  add(of_projection());
  add(of_smoothing(
      "SmoothingParams::", [](Settings& s) -> SmoothingParams& { return s.fast.smoothing; }, false));
  add(of_relaxation());
  add(of_repair());
  add(of_smoothing(
      "RepairParams::patch_smoothing.", [](Settings& s) -> SmoothingParams& { return s.fast.repair.smoothing; }, true));
  add({of_moving(
      "FastParams::update_margin", {.02, .027, .034}, [](Settings & s) -> auto& { return s.fast.update_margin; })});
  return list;
}

}  // namespace

const std::vector<Tunable>& tunables() {
  static const std::vector<Tunable> list = all();
  return list;
}

}  // namespace umtet::sensitivity
