#!/usr/bin/env python3
"""Remeshes point sets with the command-line client and has every result judged from outside.

    points.py                        every file of data/points, and 100,000 samples of twelve models in four ways
    points.py --ways plain,0.2% --only bunny,igea
    points.py --subset               a few, in seconds

The ways: normals (with the normals of the faces), plain (without any), 0.2% and 0.5% (with normals, and moved at random by so much of
the diagonal); a file of data/points has the way file. Rows go to OUT/points.jsonl, one JSON object a line; a row that is there already
for the same binary is not made again, unless it was too slow for less time than there is now. Exit code: 0 all well, 1 something is
wrong, 77 no data or no judge.

What must hold: an end in time; a manifold, consistently oriented result without degenerate parts or self-intersections, with the
figures of --stats as the judge has them. Samples of a model have its components, genus and loops, a p0.5 of 2r/R of 0.82, and where they
are moved an RMS distance to the model of a third of that, or half of 0.5 %. Files of PARTIAL may come out in part, with
the places; those of REFUSED are no samples of a surface.
"""
import argparse
import json
import shutil
import sys

import corpus

# Written into every row: rows that were made or judged by other rules are made again.
RULES = 1
RHO = 0.8
SAMPLES = 100000
MODELS = ["scans/bunny_closed.off.gz", "scans/igea.ply", "scans/nefertiti.obj.gz", "scans/armadillo.obj.gz", "scans/max_planck_20k.obj",
          "scans/feline_41k.obj.gz", "genus/kitten.obj", "genus/fertility.off", "cad/rocker-arm.obj", "genus/3holes.off",
          "scans/dragon_100k.ply", "cad/cube_twist_bumpy.obj.gz"]
# Of a way: flags for the judge's samples, and the RMS distance allowed, in % of the diagonal.
WAYS = {"normals": (["--normals"], None), "plain": ([], None), "0.2%": (["--normals", "--noise", "0.2%"], 0.2 / 3),
        "0.5%": (["--normals", "--noise", "0.5%"], 0.5 / 2)}
SUBSET = [("points/kitten.xyz", "file"), ("points/sphere_20k.xyz", "file"), ("points/ball.ply.gz", "file"),
          ("genus/kitten.obj", "plain"), ("genus/3holes.off", "0.2%")]
# No surfaces all over: clouds of trees and walls, and echoes without a side.
PARTIAL = {"points/building.ply.gz", "points/b9_training.ply", "points/radar.xyz.gz"}
# Files that are refused (exit code 3), and why.
REFUSED = {"points/blobby.xyz": "its points fill a volume"}
LEAST_QUALITY = 0.82


class Points(corpus.Corpus):
    """Its rows: {model, way, what came out, problems}."""
    FILE, KEY, RULES = "points.jsonl", ("model", "way", "binary", "rules"), RULES

    def key(self, name, way):
        return name, way, self.version, self.RULES

    def row(self, name, way):
        row, work = self.begun(name, way)
        model = self.models.path(name)
        points = model if way == "file" else self.sampled(model, work, way)
        command = [self.options.meshfront, "remesh", str(points), str(work / "out.ply"), "--stats", str(work / "stats.json"), "--quiet",
                   "--rho", str(RHO), "--threads", "1"]
        row["exit"], said, row["cpu_seconds"] = corpus.run(command, self.options.timeout)
        row["late"] = "timeout" if row["exit"] == -1 else ""
        if row["exit"] == 3 and name in REFUSED:
            row["refused"] = said
        elif row["exit"] != 0 and not (row["exit"] == 4 and name in PARTIAL):
            row["problems"].append(corpus.failure(row, said))
        if (work / "out.ply").exists():
            self.judge_points(row, None if way == "file" else model, work)
        if not self.options.keep:
            shutil.rmtree(work)
        return row

    def sampled(self, model, work, way):
        corpus.quietly(self.judge, "sample", model, work / "in.ply", "-n", SAMPLES, *WAYS[way][0])
        return work / "in.ply"

    def judge_points(self, row, model, work):
        command = [self.judge, "report", str(work / "out.ply"), "--json", str(work / "judged.json")]
        code, said, _ = corpus.run(command + (["--ref", str(model)] if model else []), self.options.judge_timeout)
        if code:
            corpus.note_unjudged(row, "judge", code, said)
            return
        found, stats = (json.loads((work / name).read_text()) for name in ("judged.json", "stats.json"))
        counts, ratio = found["counts"], found["quality"]["radius_ratio"]
        row.update(triangles=counts["faces"], components=counts["components"], genus=counts["genus"], loops=counts["boundary_loops"],
                   self_intersections=found["self_intersections"]["pairs"], min=ratio["min"], engine_seconds=stats["seconds"]["engine"])
        row["p0.5"] = ratio["p0.5"]
        if row["exit"] != 0:
            return
        row["problems"] += [*corpus.unsound(counts), *corpus.misreported(counts, stats["output"])]
        if row["self_intersections"]:
            row["problems"].append(f"{row['self_intersections']} self-intersections")
        if model:
            row.update(hausdorff_pct=found["distance"]["symmetric_max_pct"], rms_pct=found["distance"]["forward"]["rms_pct"])
            row["problems"] += [*corpus.unlike(counts, found["reference_counts"]), *too_far(row)]

    def show(self, row):
        print(line_of(row), flush=True)


def too_far(row):
    most = WAYS[row["way"]][1]
    if most is not None and row["rms_pct"] > most:
        yield f"RMS distance of {row['rms_pct']:.4f} %; the bar is <= {most:.4f}"
    if row["p0.5"] < LEAST_QUALITY:
        yield f"2r/R p0.5 is {row['p0.5']:.4f}; the bar is >= {LEAST_QUALITY}"


def line_of(row):
    head = f"{row['model']:<28} {row['way']:<8}"
    if "triangles" in row:
        head += f" {row['triangles']:>7} tri  genus {row['genus']}  {row['loops']} loops  q {row['min']:.3f} {row['p0.5']:.3f}"
    if "rms_pct" in row:
        head += f"  H {row['hausdorff_pct']:.3f} %  RMS {row['rms_pct']:.4f} %"
    well = {0: "ok", 4: "in part"}.get(row["exit"], row.get("refused"))
    return f"{head}  {row['cpu_seconds']:.1f} s  {'; '.join(row['problems']) or well}"


def chosen(checks):
    options = checks.options
    if options.subset:
        return SUBSET
    ways = options.ways.split(",")
    files = [f"points/{p.name}" for p in sorted((checks.models.data / "points").iterdir())]
    jobs = [(name, "file") for name in files if "file" in ways] + [(name, way) for way in ways if way != "file" for name in MODELS]
    only = [part for part in options.only.split(",") if part]
    return [job for job in jobs if not only or any(part in job[0] for part in only)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    corpus.add_options(parser, timeout=120, judge_timeout=600)
    corpus.add_survey_options(parser, "points")
    parser.add_argument("--ways", default="file," + ",".join(WAYS))
    options = parser.parse_args()
    checks = Points(options)
    if checks.judge is None or not (checks.models.data / "points").is_dir():
        print("skipped: no judge, or no models beside the repository (../shared/data)")
        return corpus.SKIPPED
    rows = checks.rows(chosen(checks))
    wrong = [row for row in rows if row["problems"]]
    print(f"{len(rows)} runs, {len(wrong)} with problems, {sum(row['exit'] == 4 for row in rows)} in part; "
          f"{sum(row['cpu_seconds'] for row in rows):.0f} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
