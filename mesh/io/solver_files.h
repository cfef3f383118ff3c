#pragma once

#include <filesystem>
#include <string>

#include "mesh/io/solver_mesh.h"
#include "mesh/io/surface_files.h"

namespace umtet {

/// Files for solvers. Node numbers are indices + 1, and names keep their case. Every one of these functions throws
/// std::invalid_argument for a mesh that is not consistent or has more nodes or elements than the format can count, and
/// std::system_error naming the path when anything at all cannot be written.

enum class MshEncoding { Ascii, Binary };

/// Gmsh 2.2: the body and every patch are physical groups; faces come before tets. Boundary data are $NodeData.
void write_msh22(const std::filesystem::path& path, const SolverMesh& mesh, MshEncoding encoding);

/// Gmsh 4.1: the same, with $Entities: one volume, bounded by a surface for every patch.
void write_msh41(const std::filesystem::path& path, const SolverMesh& mesh, MshEncoding encoding);

/// MEDIT .mesh, ascii: references of tets, of faces, and of vertices: the first patch they are in, else the body.
/// Ten-node tets are TetrahedraP2, their nodes in VTK's order, as Gmsh reads them.
void write_medit(const std::filesystem::path& path, const SolverMesh& mesh);

/// Abaqus and CalculiX: C3D4 or C3D10 in an ELSET, and for every patch an explicit NSET and a *SURFACE, TYPE=ELEMENT
/// of its name; with several patches also NSET and SURFACE `boundary`. No material and no step: *INCLUDE it.
/// Coordinates are rounded to the 20 characters that CalculiX reads, 13 digits or more.
void write_inp(const std::filesystem::path& path, const SolverMesh& mesh);

/// Nastran bulk data: GRID* (16 characters a number: 10 digits or more), CTETRA, and the faces as CTRIA3 or CTRIA6
/// whose property is the number of the patch; the nodes of a patch are the SET1 of that number. Names are comments.
void write_nastran(const std::filesystem::path& path, const SolverMesh& mesh);

/// FEBio, febio_spec 4.0: a <Mesh> with the tets as tet4 or tet10 in a part of the name of the body, and for every
/// patch a <NodeSet> and a <Surface> of its name, tri3 or tri6 counter-clockwise from outside; with several patches
/// also both of `boundary`. No material and no step: <Mesh from="mesh.feb"/> in a model takes it.
void write_feb(const std::filesystem::path& path, const SolverMesh& mesh);

/// VTK XML. The tets with all data and, for every patch, 0/1 at its nodes under its name.
void write_vtu(const std::filesystem::path& path, const SolverMesh& mesh);
/// The faces, with the same nodes; cell data `patch`, and field data NAME = number for every patch.
void write_boundary_vtu(const std::filesystem::path& path, const SolverMesh& mesh);

/// A parallel VTK file of one piece: the tets of write_vtu() with `global_vertex`, `owner` and `global_tet`, as several
/// processes write them of a part each.
void write_vtu_piece(const std::filesystem::path& path, const SolverMesh& mesh);
/// @param piece  the name of the file of write_vtu_piece(), in the same folder
void write_pvtu(const std::filesystem::path& path, const SolverMesh& mesh, const std::string& piece);
/// The whole mesh as the one part of write_msh41_piece(). \throw std::invalid_argument for tets of 10 nodes
void write_msh41_piece(const std::filesystem::path& path, const SolverMesh& mesh);

/// HDF5: /nodes, /tets, /faces, /patch (of faces), /point_data/NAME and /cell_data/NAME; node sets as in write_vtu().
/// The file is made in memory first, so that every write can be checked: twice its size.
void write_hdf5(const std::filesystem::path& path, const SolverMesh& mesh);
/// XDMF 3 with one grid, of the tets or of the faces: readers want one topology a file, and one file a grid.
/// @param hdf5  the name of the file of write_hdf5(), in the same folder
void write_xdmf(const std::filesystem::path& path, const SolverMesh& mesh, const std::string& hdf5);
void write_boundary_xdmf(const std::filesystem::path& path, const SolverMesh& mesh, const std::string& hdf5);

/// The boundary, or one patch of it, as flat triangles of the corners, by write_surface().
void write_boundary_surface(const std::filesystem::path& path, const SolverMesh& mesh, SurfaceFormat format);
void write_boundary_surface(const std::filesystem::path& path, const SolverMesh& mesh, SurfaceFormat format,
                            std::size_t patch);

}  // namespace umtet
