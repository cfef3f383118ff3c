#pragma once

#include <string>

namespace umtet {

/// Resolution of a fit, with the reason.
struct Resolution {
  double spacing = 0;           ///< spacing of the finest lattice, model units
  double smoothing = 0;         ///< c of the functional, on a full lattice and in all bands but the finest
  double finest_smoothing = 0;  ///< c in the finest band
  bool noise_decides = false;   ///< the spacing would be smaller without noise
  std::string reason;           ///< one sentence for the record
};

/// Chooses spacing and smoothing from the properties of a cloud.
///
/// The spacing of the finest lattice is
/// - 1.25 times the distance between samples (the root of the area per sample);
/// - where this exceeds an edge of the mesh: the edge or 1.04 times the distance, whichever is greater;
/// - at least three times the noise, because a finer lattice fits the noise of single samples.
///
/// On clean data c is 0.004, and 0.001 in the finest band. It increases with the square of noise / spacing, by 0.022 if
/// noise determines the spacing.
///
/// @param sample_spacing  model units, > 0
/// @param mesh_edge  edge length of the finest mesh required, model units; > 0
/// @param noise   standard deviation of the samples along the normal, model units; >= 0
/// @param detail  > 0: divides the spacing
/// @param smooth  > 0: multiplies c
/// @param least  least useful spacing, model units; >= 0
Resolution choose_resolution(double sample_spacing, double mesh_edge, double noise, double detail = 1,
                             double smooth = 1, double least = 0);

/// Edge length of the default mesh of a body without thin parts, relative to its diagonal: 50k to 150k tets. No full
/// lattice needs to be finer.
constexpr double kMeshEdge = 0.015;

/// Length scale l of the weights of values, a f² / l². Samples that are off the surface by more than the spacing are
/// less informative about its position than their normals are about its direction.
double value_length(double spacing, double noise);

/// The same for the finest lattice, where no finer one follows: clean samples get full weight.
double finest_value_length(double spacing, double noise);

}  // namespace umtet
