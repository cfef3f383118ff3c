#!/usr/bin/python3
"""-Laplace u = 1 in a ball, u = 0 on its boundary, by dolfinx on the mesh of several processes: nobody has the whole mesh.

    apt-get install python3-dolfinx python3-mpi4py        # 44 MB with what it depends on, beside PETSc
    cmake --preset mpi && cmake --build --preset mpi
    PYTHONPATH=build/mpi/python mpirun -n 4 /usr/bin/python3 examples/python/poisson_dolfinx.py [H [SOLUTION.npy [ORDER]]]

ORDER, 1 or 2, is that of tets and of u. The first process prints the largest error at a node: u = (1 - r^2) / 6.
SOLUTION.npy gets u by the numbers of nodes in the whole mesh, which are the same for any number of processes.
"""
import sys

import numpy as np
import ufl
import umtet
from dolfinx import fem, mesh
from dolfinx.cpp.graph import AdjacencyList_int32
from dolfinx.cpp.io import perm_vtk
from dolfinx.fem.petsc import LinearProblem
from mpi4py import MPI

comm = MPI.COMM_WORLD
h = float(sys.argv[1]) if len(sys.argv) > 1 else .1
order = int(sys.argv[3]) if len(sys.argv) > 3 else 1


def destinations(part):
    """Cells stay where they are. Those at other processes are sent there, too: by them dolfinx finds out what is shared."""
    here = np.arange(len(part.tets))
    cells, ranks = [here], [np.full(len(here), comm.rank)]
    for rank, vertices in part.shared.items():
        is_shared = np.zeros(len(part.points), bool)
        is_shared[vertices] = True
        cells.append(np.flatnonzero(is_shared[part.tets].any(axis=1)))
        ranks.append(np.full(len(cells[-1]), rank))
    cells, ranks = np.concatenate(cells), np.concatenate(ranks)
    first = np.r_[0, np.cumsum(np.bincount(cells, minlength=len(here)))]
    return AdjacencyList_int32(ranks[np.argsort(cells, kind="stable")].astype(np.int32), first.astype(np.int32))


def mesh_of(part):
    """A dolfinx mesh of the parts. dolfinx wants nodes by one process after the other, solver_vertex, and mid-sides of a
    tet in an order of its own."""
    order_of_dolfinx = perm_vtk(mesh.CellType.tetrahedron, part.tets.shape[1])
    cells = np.ascontiguousarray(part.solver_vertex[part.tets][:, order_of_dolfinx])
    nodes = part.points[part.owner == comm.rank]
    domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, order))
    return mesh.create_mesh(comm, cells, nodes, domain, mesh.GhostMode.none, lambda *_: destinations(part))


def dofs_of(part, domain, V):
    """Of each point of the part its unknown: dolfinx numbers nodes and unknowns in orders of its own."""
    nodes = domain.geometry.dofmap.array.reshape(-1, part.tets.shape[1])
    dofs = V.dofmap.list.array.reshape(nodes.shape)
    by_number = np.argsort(part.solver_vertex)
    point = by_number[np.searchsorted(part.solver_vertex[by_number], domain.geometry.input_global_indices)]
    dof = np.empty(len(part.points), np.int32)
    dof[point[nodes]] = dofs
    return dof


def solve(part, domain):
    """u at the points of the part, by a direct solver."""
    V = fem.FunctionSpace(domain, ("Lagrange", order))
    u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    dofs = dofs_of(part, domain, V)
    fixed = fem.dirichletbc(0., np.sort(dofs[part.boundary_vertices]), V)
    source = fem.Constant(domain, 1.)
    options = {"ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"}
    solution = LinearProblem(ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx, source * v * ufl.dx, [fixed],
                             petsc_options=options).solve()
    solution.x.scatter_forward()
    return solution.x.array[dofs]


part = umtet.mesh("x^2+y^2+z^2-1", box=(-1.3, -1.3, -1.3, 1.3, 1.3, 1.3), h=h, order=order, comm=comm)
u = solve(part, mesh_of(part))
error = comm.reduce(np.abs(u - (1 - (part.points**2).sum(axis=1)) / 6).max(initial=0), MPI.MAX)
tets = comm.gather(len(part.tets))
vertices = comm.gather(part.global_vertex)
values = comm.gather(u)
if comm.rank == 0:
    print(f"{part.n_tets} tets, {' + '.join(map(str, tets))} by process; largest error {error:.2e}")
    if len(sys.argv) > 2:
        solution = np.empty(part.n_vertices)
        solution[np.concatenate(vertices)] = np.concatenate(values)
        np.save(sys.argv[2], solution)
