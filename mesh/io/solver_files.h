#pragma once

#include <filesystem>
#include <string>

#include "mesh/io/solver_mesh.h"
#include "mesh/io/surface_files.h"

namespace umtet {

/// Writers of mesh files for solvers. Node numbers are indices + 1, and names keep their case. All functions throw
/// std::invalid_argument for a mesh that is inconsistent or has more nodes or elements than the format can count, and
/// std::system_error naming the path if any write fails.

/// Encoding of a Gmsh file.
enum class MshEncoding { Ascii, Binary };

/// Writes Gmsh 2.2. The body and every patch are physical groups; faces come before tets. Boundary data are $NodeData.
void write_msh22(const std::filesystem::path& path, const SolverMesh& mesh, MshEncoding encoding);

/// Writes Gmsh 4.1. It has the contents of Gmsh 2.2, with $Entities: one volume, bounded by a surface for every patch.
void write_msh41(const std::filesystem::path& path, const SolverMesh& mesh, MshEncoding encoding);

/// Writes MEDIT .mesh, ascii, with references for tets, faces and vertices. The reference of a vertex is its first
/// patch, else the body. Ten-node tets are TetrahedraP2 with nodes in VTK's order, as Gmsh reads them.
void write_medit(const std::filesystem::path& path, const SolverMesh& mesh);

/// Writes an input file of Abaqus and CalculiX: C3D4 or C3D10 in an ELSET, and for every patch an explicit NSET and a
/// *SURFACE, TYPE=ELEMENT with its name. With several patches there are also an NSET and a SURFACE `boundary`. There is
/// no material and no step: *INCLUDE the file. Coordinates are rounded to the 20 characters that CalculiX reads, 13
/// digits or more.
void write_inp(const std::filesystem::path& path, const SolverMesh& mesh);

/// Writes Nastran bulk data: GRID* (16 characters per number: 10 digits or more), CTETRA, and the faces as CTRIA3 or
/// CTRIA6 with the patch's number as property. The SET1 with this number contains the nodes of the patch. Names are
/// comments.
void write_nastran(const std::filesystem::path& path, const SolverMesh& mesh);

/// Writes an FEBio file, febio_spec 4.0: a <Mesh> with the tets as tet4 or tet10 in a part with the name of the body,
/// and for every patch a <NodeSet> and a <Surface> with its name, tri3 or tri6, counter-clockwise from outside. With
/// several patches there are also both for `boundary`. There is no material and no step: a model includes the mesh by
/// <Mesh from="mesh.feb"/>.
void write_feb(const std::filesystem::path& path, const SolverMesh& mesh);

/// Writes a blocked .cdb file, which Ansys Mechanical APDL reads by CDREAD: NBLOCK (14 digits), EBLOCK with the tets as
/// SOLID285 or SOLID187 of material 1, and for every patch a component (CMBLOCK) of its nodes. The elements form a
/// component with the name of the body, and with several patches there is a component `boundary` of nodes. Names of
/// components have at most 32 letters, digits and '_': a comment in the file tells the patch of a name that differs.
/// There is no material and no load. Node and element numbers have at most 9 digits.
void write_cdb(const std::filesystem::path& path, const SolverMesh& mesh);

/// Writes VTK XML: the tets with all data, and for every patch an array with its name that is 1 at its nodes and 0
/// elsewhere.
void write_vtu(const std::filesystem::path& path, const SolverMesh& mesh);
/// Writes the boundary faces as VTK XML, with the same nodes; cell data `patch`, and field data NAME = number for every
/// patch.
void write_boundary_vtu(const std::filesystem::path& path, const SolverMesh& mesh);

/// Writes the piece of a parallel VTK file with one piece: the tets of write_vtu() with `global_vertex`, `owner` and
/// `global_tet`, as several processes write them for a part each.
void write_vtu_piece(const std::filesystem::path& path, const SolverMesh& mesh);
/// Writes the .pvtu file. @param piece  the name of the file of write_vtu_piece(), in the same folder
void write_pvtu(const std::filesystem::path& path, const SolverMesh& mesh, const std::string& piece);
/// Writes the whole mesh as the only part of write_msh41_piece(). \throw std::invalid_argument for tets with 10 nodes
void write_msh41_piece(const std::filesystem::path& path, const SolverMesh& mesh);

/// Writes HDF5: /nodes, /tets, /faces, /patch (of faces), /point_data/NAME and /cell_data/NAME; node sets as in
/// write_vtu(). The file is first made in memory, so that every write can be checked; this takes twice its size.
void write_hdf5(const std::filesystem::path& path, const SolverMesh& mesh);
/// Writes /faces and /patch alone, to a file beside that of write_boundary_xdmf() with the ending .h5: dolfinx opens
/// the HDF5 file with the name of the XDMF file, whatever that file says.
void write_boundary_hdf5(const std::filesystem::path& path, const SolverMesh& mesh);
/// Writes XDMF 3 with one grid, of the tets or of the faces. Readers expect one topology per file, so each grid has its
/// own file.
/// @param hdf5  the name of the file of write_hdf5(), in the same folder
void write_xdmf(const std::filesystem::path& path, const SolverMesh& mesh, const std::string& hdf5);
void write_boundary_xdmf(const std::filesystem::path& path, const SolverMesh& mesh, const std::string& hdf5);

/// Writes the boundary, or one patch of it, as flat triangles of the corners, by write_surface().
void write_boundary_surface(const std::filesystem::path& path, const SolverMesh& mesh, SurfaceFormat format);
void write_boundary_surface(const std::filesystem::path& path, const SolverMesh& mesh, SurfaceFormat format,
                            std::size_t patch);

}  // namespace umtet
