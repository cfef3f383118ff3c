#pragma once

#include <filesystem>

#include "body/body.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/second_order/quadratic_tets.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Writes the final mesh like write_mesh(), but with tets of 10 nodes; mid-sides have no vertex of the background (-1).
/// @param corners  final_content() of the result
/// \throw Cancelled, std::system_error  names the file
void write_second_order(const std::filesystem::path& file, const Domain& domain, const UmResult& result,
                        const MeshFile& corners, const SecondOrder& second);

}  // namespace umtet
