#pragma once

#include <filesystem>
#include <vector>

#include "mesh/sizes/source_tree.h"

namespace umtet {

/// Returns whether the ending is one that read_sizes() reads: .vtu, .csv, .xyz or .txt.
bool is_size_file(const std::string& text);

/// Reads points with requested edge lengths, in model coordinates.
///
/// A text contains one point per line: x y z and its size, separated by blanks, commas, semicolons or tabs; # begins a
/// comment. An optional first line of names specifies which columns are x, y, z and size (or h). A .vtu contains the
/// size as point data `size` or `h` on tets, interpolated between their corners: tets with edges longer than their
/// sizes get additional points inside, at most kMostPerEdge along an edge. \throw MeshFileRefused for the content;
/// std::system_error
std::vector<SizeSource> read_sizes(const std::filesystem::path& file);

}  // namespace umtet
