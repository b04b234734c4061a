#!/usr/bin/env python3
"""The script that remakes the paper, on small shapes made in code; and its parts on what is known.

    test_reproduce.py MESHFRONT      runs the program; without it only the parts are tested
"""
import collections
import html.parser
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import charts
import page
import quality
import shapes

SCRIPT = pathlib.Path(__file__).resolve().parent / "reproduce"
MESHFRONT = sys.argv.pop(1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else None
SCALE = 0.01


class Shapes(unittest.TestCase):
    def assert_closed(self, points, triangles, genus):
        sides = collections.Counter((t[k], t[(k + 1) % 3]) for t in triangles for k in range(3))
        self.assertTrue(all(count == 1 and sides[b, a] == 1 for (a, b), count in sides.items()))
        self.assertEqual(2 - 2 * genus, len(points) - len(sides) // 2 + len(triangles))
        self.assertGreater(sum(shapes.volume(*(points[v] for v in t)) for t in triangles), 0)

    def test_a_statue_is_a_closed_sphere_of_as_many_triangles_as_wanted(self):
        points, triangles = shapes.statue(7, seed=1)
        self.assertEqual(20 * 7 * 7, len(triangles))
        self.assert_closed(points, triangles, genus=0)

    def test_a_bone_is_closed_and_has_three_tunnels(self):
        self.assert_closed(*shapes.bone(0.06), genus=3)

    def test_the_same_arguments_give_the_same_shape(self):
        self.assertEqual(shapes.statue(5, seed=3), shapes.statue(5, seed=3))
        self.assertNotEqual(shapes.statue(5, seed=3), shapes.statue(5, seed=4))


class TriangleQuality(unittest.TestCase):
    def test_an_equilateral_triangle_has_ratio_one_and_a_flat_one_zero(self):
        self.assertAlmostEqual(1, quality.radius_ratio((0, 0, 0), (1, 0, 0), (0.5, math.sqrt(0.75), 0)))
        self.assertEqual(0, quality.radius_ratio((0, 0, 0), (1, 0, 0), (2, 0, 0)))
        self.assertEqual(0, quality.radius_ratio((0, 0, 0), (0, 0, 0), (0, 0, 0)))

    def test_a_right_triangle_has_the_ratio_of_its_radii(self):
        # Sides 3, 4, 5: inradius 1, circumradius 2.5.
        self.assertAlmostEqual(0.8, quality.radius_ratio((0, 0, 0), (3, 0, 0), (0, 4, 0)))

    def test_every_triangle_of_a_file_is_counted_once(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "t.ply"
            shapes.write_ply(file, [(0, 0, 0), (3, 0, 0), (0, 4, 0), (3, 4, 2)], [(0, 1, 2), (1, 3, 2), (0, 2, 1)])
            found = quality.quality_of(file)
        self.assertEqual(3, found.triangles)
        self.assertEqual(3, sum(found.bins))
        self.assertAlmostEqual(0.8, found.median)
        self.assertEqual([[0, 0, 0], [3, 4, 2]], found.box)

    def test_percentiles_lie_between_ranks(self):
        self.assertAlmostEqual(1.5, quality.percentile([1.0, 2.0], 0.5))
        self.assertAlmostEqual(3, quality.percentile([1.0, 2.0, 3.0], 1))


class Pieces(unittest.TestCase):
    def test_what_is_written_on_the_page_is_escaped(self):
        self.assertIn("&lt;b&gt; &amp; co", page.table(["a"], [["<b> & co"]]))

    def test_a_failed_row_says_why_over_the_columns_that_it_lacks(self):
        self.assertIn('colspan="3">too slow<', page.table(["a", "b", "c", "d"], [["bunny", page.Failed("too slow")]]))

    def test_logarithmic_axes_give_each_decade_the_same_room(self):
        axis = charts.Axis("%", 0.01, 1, True)
        self.assertAlmostEqual(0.5, charts.share(axis, 0.1))
        self.assertEqual([0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0], [round(t, 6) for t in charts.ticks(axis)])


class Links(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found += [value for name, value in attributes if name in ("src", "href")]


def reproduce(out, *more, program=None):
    # Both may have been built where they are looked for when nothing is said.
    environment = {**os.environ, "MESHFRONT_JUDGE": str(out / "no judge"), "MESHFRONT_CLOCK": str(out / "no clock")}
    return subprocess.run([sys.executable, str(SCRIPT), str(out), "--meshfront", program or MESHFRONT, "--data", str(out / "no data"),
                           "--scale", str(SCALE), "--repeats", "1", *more], env=environment, capture_output=True, text=True, timeout=240)


@unittest.skipUnless(MESHFRONT, "no program given")
class WholePage(unittest.TestCase):
    """Without judge, clock and models from outside, as on a machine that has nothing but the repository."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name)
        cls.done = reproduce(cls.out, "--models", "david,statue")
        cls.page = (cls.out / "index.html").read_text() if (cls.out / "index.html").exists() else ""
        cls.rows = [json.loads(line) for line in (cls.out / "rows.jsonl").read_text().splitlines()] if cls.page else []

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_every_run_comes_out_right(self):
        self.assertEqual(0, self.done.returncode, self.done.stdout + self.done.stderr)
        self.assertGreater(len(self.rows), 15)
        self.assertEqual([], [row["problems"] for row in self.rows if row["problems"]])

    def test_the_numbers_are_sane(self):
        for row in self.rows:
            self.assertGreater(row["median"], 0.95, row)
            self.assertGreater(row["half_percentile"], 0.5, row)
            self.assertTrue(0 < row["error_pct"] < 10, row)
            self.assertTrue(0 < row["rms_pct"] < row["error_pct"], row)
            self.assertEqual(row["triangles"], sum(row["bins"]), row)

    def test_the_table_shows_the_row_as_it_was_measured(self):
        row = next(row for row in self.rows if row["model"] == "david")
        line = re.search(r"<tr>.*in place of David.*?</tr>", self.page.split("id='table1'")[1])[0]
        numbers = [float(x) for x in re.findall(r"<td[^>]*>([\d.]+)</td>", line)]
        paper, here = [133.6, 0.59, 1300.8, 286.0], [round(row["triangles"] / 1000, 1), round(row["error_pct"], 3), round(row["rms_pct"], 4)]
        for number in paper + here:
            self.assertIn(number, numbers)

    def test_a_smaller_rho_gives_more_triangles_and_less_error(self):
        sweep = sorted((row for row in self.rows if row["model"] == "statue" and row["eta"] == 1.2), key=lambda row: row["rho"])
        self.assertGreater(sweep[0]["triangles"], 4 * sweep[-1]["triangles"])
        self.assertLess(sweep[0]["error_pct"], 0.5 * sweep[-1]["error_pct"])

    def test_every_link_leads_somewhere(self):
        links = Links(self.page).found
        self.assertGreater(len(links), 20)
        for link in links:
            self.assertTrue((self.out / link).exists(), link)
            self.assertFalse(pathlib.Path(link).is_absolute())
        signatures = {(self.out / link).read_bytes()[:4] for link in links if link.endswith(".png")}
        self.assertEqual({b"\x89PNG"}, signatures)

    def test_what_is_missing_is_said(self):
        for what in ("no judge", "no clock", "Bunny"):
            self.assertIn(what, self.done.stdout)
        self.assertIn("Skipped, for want of their files: Bunny", self.page)

    def test_a_second_run_makes_nothing_again(self):
        before = (self.out / "rows.jsonl").read_text()
        self.assertEqual(0, reproduce(self.out, "--models", "david,statue").returncode)
        self.assertEqual(before, (self.out / "rows.jsonl").read_text())


@unittest.skipUnless(MESHFRONT, "no program given")
class Failures(unittest.TestCase):
    def test_a_program_that_fails_gives_a_row_that_says_so_and_exit_code_1(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "broken"
            program.write_text("#!/bin/sh\necho 'meshfront: out of ideas' >&2\nexit 70\n")
            program.chmod(0o755)
            done = reproduce(pathlib.Path(folder) / "out", "--only", "table1", "--models", "david", program=str(program))
            self.assertEqual(1, done.returncode, done.stdout + done.stderr)
            self.assertIn("exit code 70: meshfront: out of ideas", (pathlib.Path(folder) / "out/index.html").read_text())

    def test_measuring_that_takes_too_long_is_a_problem_of_the_row_and_tried_again_with_more_time(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "slow"
            program.write_text(f"#!/bin/sh\nif [ $1 = measure ]; then while :; do :; done; fi\nexec '{MESHFRONT}' \"$@\"\n")
            program.chmod(0o755)
            out = pathlib.Path(folder) / "out"
            for seconds, count in ((1, 1), (1, 1), (2, 2)):
                done = reproduce(out, "--only", "table1", "--models", "david", "--judge-timeout", str(seconds), program=str(program))
                self.assertEqual((1, ""), (done.returncode, done.stderr))
                problems = [json.loads(line)["problems"] for line in (out / "rows.jsonl").read_text().splitlines()]
                self.assertEqual(count, len(problems))
                self.assertEqual([f"meshfront measure: not done after {seconds} s on the CPU"], problems[-1])

    def test_models_that_are_not_here_leave_nothing_to_run(self):
        with tempfile.TemporaryDirectory() as folder:
            done = reproduce(pathlib.Path(folder), "--models", "bunny")
            self.assertEqual(77, done.returncode)
            self.assertIn("skipped: Bunny", done.stdout)


if __name__ == "__main__":
    unittest.main()
