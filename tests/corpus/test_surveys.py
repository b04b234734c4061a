#!/usr/bin/env python3
"""The surveys with programs that fail: what is made again, and that a run which fails leaves the others theirs."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import max_error

HERE = pathlib.Path(__file__).resolve().parent
FAILS, IS_SLOW = "echo 'meshfront: out of ideas' >&2; exit 70", "while :; do :; done"
# As much of meshfront as is needed to get to the judge.
REMESHES = 'echo "{\\"input\\": {\\"repairs\\": []}}" > "$5"; : > "$3"'


class Survey(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("a", "b"):
            model = self.folder / f"data/scans/{name}.off"
            model.parent.mkdir(parents=True, exist_ok=True)
            model.write_text("OFF\n0 0 0\n")
        self.program("judge", "exit 1")

    def program(self, name, script):
        path = self.folder / name
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)
        return str(path)

    def survey(self, script, program, *more):
        """(what it said, the rows that are there)"""
        command = [sys.executable, str(HERE / script), "--meshfront", self.program("meshfront", program), "--data",
                   str(self.folder / "data"), "--out", str(self.folder / "out"), *more]
        environment = {**os.environ, "MESHFRONT_JUDGE": str(self.folder / "judge")}
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
        self.assertEqual(1, done.returncode, done.stdout + done.stderr)
        self.assertEqual("", done.stderr)
        lines = [line for file in (self.folder / "out").glob("*.jsonl") for line in file.read_text().splitlines()]
        return done.stdout, [json.loads(line) for line in lines]

    def test_a_row_that_is_there_is_made_again_only_when_that_is_asked_for(self):
        said, rows = self.survey("corpus.py", FAILS, "--rho", "1")
        self.assertEqual([["exit code 70: meshfront: out of ideas"]] * 2, [row["problems"] for row in rows])
        again, same = self.survey("corpus.py", FAILS, "--rho", "1")
        self.assertEqual((said, rows), (again, same))
        self.assertEqual(4, len(self.survey("corpus.py", FAILS, "--rho", "1", "--fresh")[1]))

    def test_what_was_too_slow_is_tried_again_with_more_time(self):
        arguments = ("corpus.py", IS_SLOW, "--rho", "1", "--only", "a.off")
        rows = self.survey(*arguments, "--timeout", "1")[1]
        self.assertEqual(["not done after 1 s on the CPU"], rows[0]["problems"])
        self.assertEqual(1, len(self.survey(*arguments, "--timeout", "1", "--judge-timeout", "900")[1]))
        self.assertEqual(2, len(self.survey(*arguments, "--timeout", "2")[1]))

    def test_what_could_not_be_judged_in_time_is_tried_again_with_more_time(self):
        self.program("judge", IS_SLOW)
        arguments = ("corpus.py", REMESHES, "--rho", "1", "--only", "a.off")
        rows = self.survey(*arguments, "--judge-timeout", "1")[1]
        self.assertEqual(["judge: not done after 1 s on the CPU"], rows[0]["problems"])
        self.assertEqual(1, len(self.survey(*arguments, "--judge-timeout", "1", "--timeout", "900")[1]))
        self.assertEqual(2, len(self.survey(*arguments, "--judge-timeout", "2")[1]))

    def test_a_result_that_is_farther_away_than_the_bound_is_a_problem_even_if_it_says_so(self):
        row = {"max_error": "0.1%", "forward_pct": 0.12, "forward_at": [1, 2, 3], "certified_pct": 0.13, "beyond_bound": False}
        self.assertEqual(["1.200 of the bound away from the input, at 1, 2, 3"], max_error.beyond(row))
        self.assertIn("which --stats does not say", max_error.beyond({**row, "beyond_bound": True})[0])
        self.assertEqual(["certified to 1.300 of the bound, 0.900 of it by samples"], max_error.beyond({**row, "forward_pct": 0.09}))
        self.assertEqual([], max_error.beyond({**row, "forward_pct": 0.09, "certified_pct": 0.1}))

    def test_every_model_is_remeshed_at_every_bound(self):
        said, rows = self.survey("max_error.py", FAILS, "--max-error", "1%,2%")
        self.assertEqual([("1%", "scans/a.off"), ("1%", "scans/b.off"), ("2%", "scans/a.off"), ("2%", "scans/b.off")],
                         [(row["max_error"], row["model"]) for row in rows])
        self.assertIn("4 runs, 0 results, 4 with problems", said)

    def test_a_model_that_takes_too_long_or_cannot_be_read_is_a_problem_of_its_runs_alone(self):
        slow_on_bones = f"case $2 in *bone*) {IS_SLOW};; *) {FAILS};; esac"
        said, rows = self.survey("robustness.py", slow_on_bones, "--generated", "--only", "bone,box", "--runs", "2", "--timeout", "1")
        self.assertEqual([("generated/bone", ["as it is: not done after 1 s on the CPU"]),
                          ("generated/box", ["as it is: exit code 70: meshfront: out of ideas"])] * 2,
                         [(row["model"], row["problems"]) for row in rows])
        self.assertIn("4 runs, 4 with problems", said)
        self.assertEqual([], list((self.folder / "out/work").iterdir()))


if __name__ == "__main__":
    unittest.main()
