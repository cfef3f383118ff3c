#pragma once

#include <string>

namespace umtet {

/// How finely a cloud is fitted, and why.
struct Resolution {
  double spacing = 0;           ///< of the finest lattice, model units
  double smoothing = 0;         ///< c of the functional, on a full lattice and in bands that others follow
  double finest_smoothing = 0;  ///< c in the finest band
  bool noise_decides = false;   ///< without noise the spacing would be smaller
  std::string reason;           ///< one sentence for the record
};

/// Spacing and smoothing from what the cloud can tell.
///
/// The finest lattice has 1.25 times the distance between samples (the root of the area a sample stands for); where
/// that is more than an edge of the mesh, the edge or 1.04 times, whichever is more; and no less than three times the
/// noise: below, it fits the noise of single samples. On clean data c is 0.004, in the finest band 0.001; it rises with
/// the square of noise / spacing, by 0.022 where noise decides.
///
/// @param sample_spacing  model units, > 0
/// @param mesh_edge  of the finest mesh that is wanted, model units; > 0
/// @param noise   standard deviation of the samples along the normal, model units; >= 0
/// @param detail  > 0: divides the spacing
/// @param smooth  > 0: multiplies c
/// @param least  no spacing of less is of use, model units; >= 0
Resolution choose_resolution(double sample_spacing, double mesh_edge, double noise, double detail = 1,
                             double smooth = 1, double least = 0);

/// Edge of the default mesh of a body without thin parts, over its diagonal: 50k to 150k tets. No full lattice need be
/// finer.
constexpr double kMeshEdge = 0.015;

/// The length l by which values are weighed, a f² / l²: samples off the surface by more than the spacing say less about
/// where it is than their normals do about where it goes.
double value_length(double spacing, double noise);

/// The same on the finest lattice, where nothing finer follows: clean samples are taken at their word.
double finest_value_length(double spacing, double noise);

}  // namespace umtet
