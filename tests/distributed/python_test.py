"""umtet.mesh(comm=...): mpirun -n N python3 python_test.py. All ranks run all tests; what one process makes is made by each."""
import json
import unittest

import numpy as np
import umtet
from mpi4py import MPI

COMM = MPI.COMM_WORLD
BOX = (-1.3, -1.3, -1.3, 1.3, 1.3, 1.3)
TWO_BALLS = "((x-1.3)^2+y^2+z^2-1)*((x+1.3)^2+y^2+z^2-1)"
TWO_BOX = (-2.6, -1.3, -1.3, 2.6, 1.3, 1.3)


def without_run(certificate):
    return {name: value for name, value in certificate.items() if name != "run"}


class Parts(unittest.TestCase):
    maxDiff = 2000

    def check(self, psi, box, **parameters):
        part = umtet.mesh(psi, box=box, comm=COMM, threads=1, **parameters)
        one = umtet.mesh(psi, box=box, threads=1, **parameters)
        self.assertEqual((part.n_vertices, part.n_tets), (len(one.points), len(one.tets)))
        self.assertTrue((part.points == one.points[part.global_vertex]).all())
        self.assertTrue((part.global_vertex[part.tets] == one.tets[part.global_tet]).all())
        self.assertTrue((part.background_vertex == one.background_vertex[part.global_vertex]).all())
        self.assertEqual(sorted(np.concatenate(COMM.allgather(part.global_tet)).tolist()), list(range(len(one.tets))))
        self.assertEqual(part.h, one.h)
        self.assertEqual(part.certified, one.certified)
        self.assertEqual(json.dumps(without_run(part.certificate)), json.dumps(without_run(one.certificate)))
        is_on = np.isin(part.global_vertex, one.boundary_vertices)
        self.assertEqual(np.flatnonzero(is_on).tolist(), part.boundary_vertices.tolist())
        self.assertTrue((part.global_vertex[part.boundary] == one.boundary[part.global_face]).all())
        self.assertEqual(sorted(np.concatenate(COMM.allgather(part.global_face)).tolist()), list(range(len(one.boundary))))
        return part, one

    def check_nodes(self, part):
        """What processes say of nodes between them, and of who owns them."""
        for other, vertices in part.shared.items():
            theirs = COMM.sendrecv(part.global_vertex[vertices], other, source=other)
            self.assertEqual(part.global_vertex[vertices].tolist(), theirs.tolist())
            self.assertTrue((part.owner[vertices] <= min(other, COMM.rank)).all())
        holders = COMM.allgather(part.global_vertex)
        for rank, held in enumerate(holders):
            if rank != COMM.rank:
                both = np.flatnonzero(np.isin(part.global_vertex, held))
                self.assertEqual(part.shared.get(rank, both[:0]).tolist(), both.tolist())
        first = np.full(part.n_vertices, COMM.size)
        for rank in reversed(range(COMM.size)):
            first[holders[rank]] = rank
        self.assertEqual(part.owner.tolist(), first[part.global_vertex].tolist())
        owned = part.owner == COMM.rank
        self.assertEqual(COMM.allreduce(int(owned.sum())), part.n_vertices)
        before = COMM.exscan(int(owned.sum())) or 0
        self.assertEqual(part.solver_vertex[owned].tolist(), list(range(before, before + int(owned.sum()))))
        numbers = np.empty(part.n_vertices, int)
        for vertices, of_them in zip(holders, COMM.allgather(np.where(owned, part.solver_vertex, -1))):
            numbers[vertices[of_them >= 0]] = of_them[of_them >= 0]
        self.assertEqual(part.solver_vertex.tolist(), numbers[part.global_vertex].tolist())

    def faces(self, part, local):
        of_all = COMM.allgather(part.global_vertex[local])
        return sorted(map(sorted, np.concatenate(of_all).tolist()))

    def test_a_formula_is_the_mesh_of_one_process(self):
        part, one = self.check("x^2+2*y^2+z^2-1", BOX, h=.15)
        self.assertEqual(self.faces(part, part.boundary), sorted(map(sorted, one.boundary.tolist())))

    def test_a_callable_is_asked_by_each(self):
        self.check(lambda x: (x**2).sum(axis=1) - 1, BOX, h=.2)
        self.check(lambda x: ((x**2).sum(axis=1) - 1, 2 * x), BOX, h=.2)

    def test_a_level_set_is_that_of_the_first(self):
        z = 1 - (2 * np.arange(2000) + 1) / 2000
        a = 2.399963 * np.arange(2000)
        normals = np.c_[np.sqrt(1 - z**2) * np.cos(a), np.sqrt(1 - z**2) * np.sin(a), z]
        psi = umtet.reconstruct(normals + [1000, -300, 7], normals=normals, threads=1)  # far away: work is done nearer
        self.check(psi, None, h=.15, background="a15")
        self.check(psi, None, h=.15, background="a15", order=2)

    def test_patches_have_the_names_of_one_process(self):
        part, one = self.check(TWO_BALLS, TWO_BOX, h=.2)
        self.assertEqual(list(part.patches), ["boundary_1", "boundary_2"])
        for name, faces in one.patches().items():
            self.assertEqual(self.faces(part, part.patches[name]), sorted(map(sorted, faces.tolist())))

    def test_processes_agree_on_what_is_between_them(self):
        part = umtet.mesh("x^2+y^2+z^2-1", box=BOX, h=.15, comm=COMM)
        self.check_nodes(part)

    def test_second_order_is_the_mesh_of_one_process(self):
        # A lens: mid-sides of its rim are relaxed.
        for psi, box, h in (("x^2+2*y^2+z^2-1", BOX, .15), ("x^2+y^2+100*z^2-1", (-1.3, -1.3, -.4, 1.3, 1.3, .4), .1)):
            part, one = self.check(psi, box, h=h, order=2)
            self.assertEqual((part.tets.shape[1], part.boundary.shape[1]), (10, 6))
            moved = part.certificate["second_order"]["n_mid_sides_slid"] + part.certificate["second_order"]["n_mid_sides_relaxed"]
            self.assertEqual(moved > 0, h < .15)
            self.check_nodes(part)

    def test_second_order_has_the_patches_of_one_process(self):
        part, one = self.check(TWO_BALLS, TWO_BOX, h=.3, order=2)
        self.assertEqual(list(part.patches), ["boundary_1", "boundary_2"])
        for name, faces in one.patches().items():
            of_all = np.concatenate(COMM.allgather(part.global_vertex[part.patches[name]]))
            self.assertEqual(sorted(of_all.tolist()), sorted(faces.tolist()))

    def test_second_order_of_more_processes_than_pieces(self):
        part, _ = self.check("x^2+y^2+z^2-.3", (-1, -1, -1, 9, 9, 9), h=.4, order=2)
        self.assertEqual(part.points.shape[1:] + part.tets.shape[1:] + part.boundary.shape[1:], (3, 10, 6))
        self.check_nodes(part)

    def test_more_processes_than_pieces_of_the_mesh(self):
        part, _ = self.check("x^2+y^2+z^2-.3", (-1, -1, -1, 9, 9, 9), h=.4)
        self.assertEqual(part.points.shape[1:] + part.tets.shape[1:] + part.boundary.shape[1:], (3, 4, 3))

    def test_what_the_first_raises_all_raise(self):
        with self.assertRaisesRegex(ValueError, "box is missing"):
            umtet.mesh("x", comm=COMM)
        with self.assertRaisesRegex(ValueError, "for one process"):
            umtet.mesh("x^2+y^2+z^2-1", box=BOX, h=.3, mode="paper", comm=COMM)
        with self.assertRaises(umtet.MeshingError) as caught:
            umtet.mesh("x^2+y^2+z^2-1", box=(-.9, -.9, -.9, .9, .9, .9), h=.2, comm=COMM)
        self.assertEqual(caught.exception.evidence["status"], "domain leaves background")
        with self.assertRaisesRegex(TypeError, "communicator"):
            umtet.mesh("x", box=BOX, comm=3)

    def test_processes_that_ask_for_different_meshes_are_told(self):
        if COMM.size == 1:
            return
        with self.assertRaisesRegex(ValueError, "different meshes: h is 0.2 on rank 0 and 0.3 on rank 1"):
            umtet.mesh("x^2+y^2+z^2-1", box=BOX, h=.2 if COMM.rank == 0 else .3, comm=COMM)

    def test_the_callers_messages_are_apart(self):
        request = COMM.irecv(source=MPI.ANY_SOURCE, tag=MPI.ANY_TAG)
        umtet.mesh("x^2+y^2+z^2-1", box=BOX, h=.3, comm=COMM)
        COMM.send(COMM.rank, dest=(COMM.rank + 1) % COMM.size, tag=7)
        self.assertEqual(request.wait(), (COMM.rank - 1) % COMM.size)


if __name__ == "__main__":
    unittest.main(argv=["python_test.py"], verbosity=0 if COMM.rank else 2)
