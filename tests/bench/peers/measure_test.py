#!/usr/bin/python3
"""The measuring code of the comparison, on meshes whose numbers are known. usage: tests/bench/peers/measure_test.py"""
import tempfile
import unittest

import measure as m
import numpy as np

REGULAR = np.array([[1, -1, -1], [1, 1, 1], [-1, 1, -1], [-1, -1, 1.0]])
CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
FIVE = np.array([[3, 0, 5, 6], [1, 3, 0, 5], [2, 0, 3, 6], [4, 5, 0, 6], [7, 6, 3, 5]])
for t in FIVE:  # positive
    if np.linalg.det(CUBE[t[1:]] - CUBE[t[0]]) < 0:
        t[:2] = t[1::-1]


class Measure(unittest.TestCase):
    def test_regular_tet(self):
        self.assertAlmostEqual(m.mean_ratio(REGULAR[None])[0], 1)
        np.testing.assert_allclose(m.dihedral_angles(REGULAR[None]), np.degrees(np.arccos(1 / 3)))

    def test_corner_of_a_cube(self):
        P = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])[None]
        self.assertAlmostEqual(m.mean_ratio(P)[0], 12 * (9 / 36)**(1 / 3) / 9)
        np.testing.assert_allclose(np.sort(m.dihedral_angles(P)[0]), [54.735610317] * 3 + [90] * 3)
        self.assertLess(m.mean_ratio(P[:, [1, 0, 2, 3]])[0], 0)

    def test_flat_tet(self):
        P = np.array([[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0.0]])[None]
        self.assertEqual(m.mean_ratio(P)[0], 0)
        np.testing.assert_allclose(np.sort(m.dihedral_angles(P)[0]), [0] * 4 + [180] * 2, atol=1e-5)

    def test_boundary_and_pieces(self):
        self.assertGreater(m.mean_ratio(CUBE[FIVE]).min(), 0)
        faces = m.boundary(FIVE)
        self.assertEqual((len(faces), m.pieces(faces)), (12, 1))
        P = CUBE[faces]
        flux = np.einsum("ij,ij->i", P[:, 0], np.cross(P[:, 1], P[:, 2])).sum() / 6
        self.assertAlmostEqual(flux, 1)  # outward
        self.assertEqual(m.pieces(m.boundary(np.r_[FIVE, FIVE + 8])), 2)

    def test_one_inverted_tet_is_counted_whatever_the_numbering(self):
        tets = FIVE.copy()
        tets[0] = tets[0, [1, 0, 2, 3]]
        for numbering in ([0, 1, 2, 3], [1, 0, 2, 3]):
            result = m.measure(CUBE + 1.5, tets[:, numbering], m.sphere, 1)
            self.assertEqual(result["inverted"], 1)
            self.assertLess(result["min_Q"], 0)

    def test_distances(self):
        x = 1.1 * REGULAR / np.sqrt(3)
        np.testing.assert_allclose(m.distance(m.sphere, x), .1)
        np.testing.assert_allclose(m.distance(m.torus, np.array([[0, 1.37, 0], [1, 0, -.42]])), [.03, .02])
        x = np.array([[1.5, 1.5, 1.5]])
        np.testing.assert_allclose(m.distance(m.sphere, x), np.sqrt(6.75) - 1)

    def test_gradients(self):
        x = np.random.default_rng(1).uniform(-1, 1, (50, 3))
        for psi in m.SHAPES.values():
            for k in range(3):
                e = np.eye(3)[k] * 1e-6
                np.testing.assert_allclose((psi(x + e)[0] - psi(x - e)[0]) / 2e-6, psi(x)[1][:, k], rtol=1e-5, atol=1e-5)

    def test_medit_keeps_digits(self):
        with tempfile.NamedTemporaryFile("w", suffix=".mesh") as file:
            file.write("MeshVersionFormatted 1\nDimension 3\nVertices\n4\n0.1234567890123 0 0 1\n1 0 0 1\n0 1 0 1\n"
                       "0 0 1 2\nTriangles\n1\n1 2 3 4\nTetrahedra\n1\n1 2 3 4 1\nEnd\n")
            file.flush()
            points, tets = m.read(file.name)
        self.assertEqual(points[0, 0], 0.1234567890123)
        np.testing.assert_array_equal(tets, [[0, 1, 2, 3]])


if __name__ == "__main__":
    unittest.main()
