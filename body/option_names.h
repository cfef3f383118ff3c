#pragma once

#include "common/message.h"

// The options that messages of this library name, by their positions in BodyOptions and in umtet::Options.
namespace umtet::option {

inline constexpr Option keep_all{"scan.keep_all"};
inline constexpr Option normals{"scan.normals"};
inline constexpr Option merge{"scan.merge"};
inline constexpr Option flip{"scan.flip"};
inline constexpr Option viewpoints{"viewpoints"};
inline constexpr Option columns{"columns"};  ///< parameter of read_scan()
inline constexpr Option sample_spacing{"triangles.spacing"};
inline constexpr Option close{"fit.close"};
inline constexpr Option edges{"fit.edges"};
inline constexpr Option h{"mesh.h"};
inline constexpr Option tets{"mesh.tets"};
inline constexpr Option max_deviation{"mesh.max_deviation"};
inline constexpr Option max_tets{"mesh.max_tets"};
inline constexpr Option background{"mesh.background"};
inline constexpr Option grade{"mesh.grade"};
inline constexpr Option h_min{"mesh.h_min"};
inline constexpr Option h_max{"mesh.h_max"};
inline constexpr Option max_turn{"mesh.max_turn"};
inline constexpr Option grade_inside{"mesh.grade_inside"};
inline constexpr Option box_walls{"mesh.box_walls"};
inline constexpr Option complement{"mesh.complement"};
inline constexpr Option sizes{"sizes"};
inline constexpr Option label_sizes{"label_sizes"};
inline constexpr Option box{"box"};
inline constexpr Option accept{"verdict.accept"};

/// All options, so that a test can check the names that front ends give them.
inline constexpr Option kAll[] = {keep_all,    normals, merge,    flip,          viewpoints, columns,    close,
                                  edges,       h,       tets,     max_deviation, max_tets,   background, grade,
                                  h_min,       h_max,   max_turn, grade_inside,  box_walls,  complement, sizes,
                                  label_sizes, box,     accept,   sample_spacing};

}  // namespace umtet::option
