"""What ranks send, as tests/bench/rank_traffic.c counts it: what docs/performance.md says of it grows as it says.

usage: traffic_test.py UMTET_MPI MPIEXEC RANK_TRAFFIC N
"""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench"))
import rank_model  # noqa: E402

UMTET_MPI, MPIEXEC, LIBRARY, N = sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4])


class Traffic(unittest.TestCase):
    def test_messages_grow_with_the_border_and_pieces_with_the_part(self):
        sizes = []
        with tempfile.TemporaryDirectory() as name:
            for h in (".08", ".04"):
                ranks, mesh = rank_model.traffic(MPIEXEC, UMTET_MPI, LIBRARY, N, ["mesh", *rank_model.TORUS, "--h", h], pathlib.Path(name))
                sizes.append((ranks, mesh["n_tets"], mesh["boundary"]["n_faces"]))

        def most(column, phases):
            return [max(sum(rank[p][column] for p in phases) for rank in ranks) for ranks, _, _ in sizes]

        (small, n_small, faces_small), (large, n_large, faces_large) = sizes
        for rank in small + large:
            self.assertLessEqual(set(rank_model.IN_MESH + rank_model.IN_PIECES), set(rank))
        for ranks in (small, large):  # all take part in each exchange
            for phase in rank_model.IN_MESH:
                self.assertEqual(len({rank[phase]["exchanges"] for rank in ranks}), 1, phase)
        # Half the edge: eight times the tets, four times the faces, twice the line in which a border cuts the boundary.
        self.assertGreater(n_large, 7 * n_small)
        bytes_small, bytes_large = most("sent", ("classify", "project"))
        self.assertGreater(bytes_small, 0)
        self.assertLess(bytes_large / bytes_small, faces_large / faces_small)
        exchanges_small, exchanges_large = most("exchanges", rank_model.IN_MESH)
        self.assertLess(exchanges_large, 2 * exchanges_small)
        written_small, written_large = (sum(rank["files"]["written"] for rank in ranks) for ranks, _, _ in sizes)
        self.assertLess(written_large / written_small, n_large / n_small)
        sent_large = sum(rank[p]["sent"] for p in rank_model.IN_PIECES for rank in large)
        self.assertLess(sent_large, 200 * n_large)


if __name__ == "__main__":
    rank_model.allow_root()
    unittest.main(argv=sys.argv[:1])
