#pragma once

#include <filesystem>
#include <vector>

#include "mesh/sizes/source_tree.h"

namespace umtet {

/// Whether this is the name of a file that read_sizes() reads, by its ending: .vtu, .csv, .xyz or .txt.
bool is_size_file(const std::string& text);

/// Points with the edge lengths that are wanted there, in model coordinates.
///
/// A text has a point a line: x y z and its size, separated by blanks, commas, semicolons or tabs; # begins a comment.
/// A first line of names may say which columns are x, y, z and size (or h). A .vtu has the size as point data `size` or
/// `h` on tets, interpolated between their corners: tets with edges longer than their sizes get points inside, at most
/// kMostPerEdge along an edge. \throw MeshFileRefused for the content; std::system_error
std::vector<SizeSource> read_sizes(const std::filesystem::path& file);

}  // namespace umtet
