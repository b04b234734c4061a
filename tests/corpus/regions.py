#!/usr/bin/env python3
"""Remeshes regions of models, each a ball around a vertex, and has every result judged.

    regions.py                       100 regions of each of five models
    regions.py --runs 30 -j 2 --only spot,bunny
    regions.py --subset              a few regions of shapes made in code, in seconds
    regions.py --only spot --run 17 --keep        one again; what came out stays below OUT

A run is what its number says, for one model: a vertex, a radius of 2 to 20 % of the diagonal, and flags. What must hold for every row
is what corpus.py says, of the whole mesh that came back; and each face beside the region is there with the bits of its coordinates
and its cyclic order. Rows go to OUT/regions.jsonl, as those of robustness.py. Exit code: 0 all well, 1 something is wrong, 77 no data
or no judge.
"""
import collections
import json
import math
import random
import shutil
import sys

import corpus
import intersections
import robustness

# Written into every row: rows that were made or judged by other rules are made again.
RULES = 1
MODELS = [
    "scans/bunny.off",            # holes, a scan
    "genus/fertility.off",        # genus 4
    "cad/fandisk.obj",            # creases, coarse faces
    "cad/rocker-arm.obj",
    "assets/spot.obj",            # smooth
]
SUBSET = ["generated/statue", "generated/bone", "generated/box"]
SUBSET_RUNS = 4


def draw_ball(chance, points, faces):
    """(centre, radius) of a ball with a face in it."""
    diagonal = math.dist(*([f(p[k] for p in points) for k in range(3)] for f in (min, max)))
    while True:
        center, radius = points[chance.choice(chance.choice(faces))], chance.uniform(0.02, 0.2) * diagonal
        if any(faces_inside(points, faces, center, radius)):
            return center, radius


def faces_inside(points, faces, center, radius):
    inside = [math.dist(p, center) <= radius for p in points]
    return [inside[a] and inside[b] and inside[c] for a, b, c in faces]


def draw_flags(chance):
    sizing = chance.choice([["--rho", "0.5"], ["--rho", "0.8"], ["--rho", "1"], ["--rho", "1.5"], ["--sizing", "error"],
                            ["--edge-length", "1%"]])
    return [*sizing, "--eta", chance.choice(["1.2", "1.2", "1.4"]), "--blend", chance.choice(["8", "8", "4", "16"])]


def corners_of(points, face):
    """The same for a face wherever its corners begin."""
    corners = [points[v] for v in face]
    first = corners.index(min(corners))
    return tuple(corners[first:] + corners[:first])


def missing_faces(before, after, inside):
    """How many faces beside the region are not in the result as they were."""
    points, faces = before
    kept = collections.Counter(corners_of(points, face) for face, is_in in zip(faces, inside) if not is_in)
    kept.subtract(corners_of(after[0], face) for face in after[1])
    return sum(count for count in kept.values() if count > 0)


class Regions(robustness.Robustness):
    """Its rows: {model, run, the ball and flags, what came out, problems}."""
    FILE, RULES = "regions.jsonl", RULES

    def row(self, name, number):
        failed, original = self.original(name)
        row, work = self.begun(name, number)
        if failed:
            row.update(failed)
        else:
            self.remesh_region(row, work, *original[:2])
        if not self.options.keep:
            shutil.rmtree(work)
        return row

    def remesh_region(self, row, work, points, faces):
        """Of the model as it was mended once, so that nothing is left to mend."""
        chance = random.Random(f"{row['model']} {row['run']}")
        (x, y, z), radius = draw_ball(chance, points, faces)
        flags = draw_flags(chance)
        row.update(center=[x, y, z], radius=radius, flags=" ".join(flags))
        model = work / "in.ply"
        robustness.shapes.write_ply(model, points, faces)
        points, faces = intersections.read_parts(model)
        ball = f"sphere:{x!r},{y!r},{z!r},{radius!r}"
        said = self.remesh(row, model, work, "--region", ball, *flags)
        if row["exit"] != 0:
            row["problems"].append(corpus.failure(row, said))
        if not (work / "out.ply").exists():
            return
        missing = missing_faces((points, faces), intersections.read_parts(work / "out.ply"),
                                faces_inside(points, faces, (x, y, z), radius))
        if missing:
            row["problems"].append(f"{missing} faces beside the region are not what they were")
        stats = json.loads((work / "stats.json").read_text())
        if "region" in stats:
            row.update(stats["region"])
        row.update(new_median=stats["quality"]["radius_ratio_median"], new_p05=stats["quality"]["radius_ratio_p0_5"],
                   new_min=stats["quality"]["radius_ratio_min"])
        self.judge_row(row, model, work)

    def show(self, row):
        if row["problems"] or self.options.verbose:
            print(line_of(row), flush=True)


def line_of(row):
    head = f"{row['model']:<22} run {row['run']:>3}"
    if "flags" in row:
        head += f"  {row['flags']}"
    if "new_triangles" in row:
        head += f"  {row['replaced_triangles']} -> {row['new_triangles']}"
        head += f"  q {row['new_min']:.3f} {row['new_p05']:.3f} {row['new_median']:.3f}"
    return f"{head}  {'; '.join(row['problems']) or 'ok'}"


def summarise(rows):
    by_model = collections.defaultdict(list)
    for row in rows:
        by_model[row["model"]].append(row)
    for name, its in by_model.items():
        done = sorted(row["new_median"] for row in its if "new_median" in row)
        middle = f"median 2r/R of the new triangles {done[len(done) // 2]:.3f}" if done else "no result"
        print(f"{name:<26} {sum(not row['problems'] for row in its):>4} of {len(its)} right  {middle}")
    return robustness.count_wrong(rows)


def models_and_runs(options):
    return (SUBSET, SUBSET_RUNS) if options.subset else (MODELS, options.runs)


if __name__ == "__main__":
    sys.exit(robustness.survey(__doc__, "regions", Regions, models_and_runs, summarise))
