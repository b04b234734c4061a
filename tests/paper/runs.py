"""Remeshes one model at one rho and eta, has the result judged, and times it against the clock.

Rows go to OUT/rows.jsonl as they come, one JSON object a line; a row that is there already for the same program, shape and way of
measuring is not made again. Meshes stay in OUT/meshes, pictures go to OUT/pictures.
"""
import hashlib
import json
import os
import pathlib
import shutil

import corpus
import models
import quality

# Written into every row: rows that an older script made by other rules are made again.
RULES = 3
# Two programs measure the same quality of the same file.
QUALITY_TOLERANCE = 1e-3
# Seconds of the clock from which a pair is not timed again: what else the machine does evens out within it.
LONG = 10


def find_clock():
    clock = os.environ.get("MESHFRONT_CLOCK") or str(corpus.ROOT / "build/peers/clock")
    return clock if os.access(clock, os.X_OK) else None


class Runs:
    def __init__(self, options, paper_models):
        self.options, self.models = options, paper_models
        self.out = pathlib.Path(options.out)
        for folder in ("meshes", "pictures"):
            (self.out / folder).mkdir(parents=True, exist_ok=True)
        self.version = hashlib.sha256(pathlib.Path(options.meshfront).read_bytes()).hexdigest()[:12]
        self.judge, self.clock = corpus.find_judge(), find_clock()
        self.cpu = str(max(os.sched_getaffinity(0)))
        self.rows, self.known, self.failures = {}, {}, []
        file = self.out / "rows.jsonl"
        for line in file.read_text().splitlines() if file.exists() else []:
            row = json.loads(line)
            if row["key"][0] == RULES and not corpus.may_be_in_time(row, options):
                self.known[json.dumps(row["key"])] = row

    # ---- rows ----

    def row(self, name, rho, eta, timed):
        """The row of one run; made, read from a broken run's file, or the one that was asked for before."""
        short = (name, rho, eta)
        if short in self.rows:
            return self.rows[short]
        key = [RULES, self.version, name, self.models.size(name), rho, eta, bool(self.judge), timed and bool(self.clock)]
        row = None if self.options.fresh else self.known.get(json.dumps(key))
        kept = self.mesh(name, rho, eta).exists() and self.input_mesh(name).exists()
        if row is None or not (kept or row["problems"]):
            row = {"key": key, "model": name, "rho": rho, "eta": eta, "timeout": self.options.timeout,
                   "judge_timeout": self.options.judge_timeout, "late": "", "problems": []}
            self.fill(row, timed)
            with open(self.out / "rows.jsonl", "a", encoding="utf-8") as out:
                out.write(json.dumps(row) + "\n")
        self.rows[short] = row
        print(line_of(row), flush=True)
        return row

    def mesh(self, name, rho, eta):
        return self.out / "meshes" / f"{name}-rho-{rho}-eta-{eta}.ply"

    def input_mesh(self, name):
        """The input as it was meshed, after repair."""
        return self.out / "meshes" / f"{name}.ply"

    def fill(self, row, timed):
        work = self.out / "work"
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()
        mesh = self.mesh(row["model"], row["rho"], row["eta"])
        mesh.unlink(missing_ok=True)
        code, said = self.remesh(row, work, "--write-repaired", str(work / "repaired.ply"))
        row["late"] = "timeout" if code == -1 else ""
        if code:
            row["problems"].append(said if row["late"] else f"exit code {code}: {said[:300]}")
        if (work / "out.ply").exists() and (work / "stats.json").exists():
            self.measure(row, work)
            if timed and not row["problems"]:
                self.time(row, work)
            os.replace(work / "out.ply", mesh)
        if (work / "repaired.ply").exists():
            os.replace(work / "repaired.ply", self.input_mesh(row["model"]))
        shutil.rmtree(work)

    def remesh(self, row, work, *more):
        command = ["taskset", "-c", self.cpu, self.options.meshfront, "remesh", str(self.models.path(row["model"])), str(work / "out.ply"),
                   "--rho", str(row["rho"]), "--eta", str(row["eta"]), "--threads", "1", "--quiet", "--stats", str(work / "stats.json")]
        code, said, _ = corpus.run([*command, *more], self.options.timeout)
        return code, said.replace(str(work / "out.ply"), "the result").replace(str(self.models.path(row["model"])), row["model"])

    def measure(self, row, work):
        stats = json.loads((work / "stats.json").read_text())
        diagonal = stats["input"]["diagonal"]
        row.update(input_triangles=stats["input"]["triangles"], genus=stats["output"]["genus"], loops=stats["output"]["boundary_loops"],
                   repairs=stats["input"]["repairs"], predicted_triangles=stats["predicted_triangles"],
                   bound_pct=100 * stats["error_bound"] / diagonal, error_bound=stats["error_bound"],
                   seconds=[stats["seconds"]["engine"]], memory_mb=stats["peak_rss_bytes"] / 1e6)
        found = quality.quality_of(work / "out.ply")
        row.update(found._asdict())
        judged = self.judged(row, work) if self.judge else self.measured(row, work, stats)
        if judged is None:
            return
        ratio, distance, row["self_intersections"] = judged
        for mine, its in zip((found.worst, found.half_percentile, found.median), ratio):
            if abs(mine - its) > QUALITY_TOLERANCE:
                row["problems"].append(f"2r/R is {mine:.4f}, and {its:.4f} where it was measured")
        row["error_pct"] = max(way["max"] for way in distance) * 100 / diagonal
        row["rms_pct"] = max(way["rms"] for way in distance) * 100 / diagonal
        if self.judge and not row["problems"]:
            row["problems"] += corpus.new_meetings(row, work)  # takes long: not for a result that is wrong already
        elif row["self_intersections"]:
            row["problems"].append(f"{row['self_intersections']} self-intersections")

    def judged(self, row, work):
        """((worst, half percentile, median), two one-sided distances, pairs of faces that meet), from outside."""
        judged = corpus.judged(self.judge, row, work / "repaired.ply", work)
        if judged is None:
            return None
        row["problems"] += [*corpus.unsound(judged["counts"]), *corpus.unlike(judged["counts"], judged["reference_counts"])]
        ratio = judged["quality"]["radius_ratio"]
        return ((ratio["min"], ratio["p0.5"], ratio["median"]), [judged["distance"][way] for way in ("forward", "backward")],
                judged["self_intersections"]["pairs"])

    def measured(self, row, work, stats):
        """The same by meshfront itself, where there is no judge."""
        command = [self.options.meshfront, "measure", str(work / "out.ply"), "--ref", str(work / "repaired.ply"), "--json"]
        with open(work / "measured.json", "wb") as out:
            code, said, _ = corpus.run(command, self.options.judge_timeout, out)
        if code:
            corpus.note_unjudged(row, "meshfront measure", code, said)
            return None
        told = json.loads((work / "measured.json").read_text())
        counts = told["counts"]
        row["problems"] += [f"not {what}" for what in ("manifold", "oriented") if not counts[what]]
        row["problems"] += [f"{what} {stats['input'][what]} -> {counts[what]}" for what in ("components", "genus", "boundary_loops")
                            if stats["input"][what] != counts[what]]
        ratio = told["quality"]
        return ((ratio["radius_ratio_min"], ratio["radius_ratio_p0_5"], ratio["radius_ratio_median"]),
                [told["distance"][way] for way in ("forward", "backward")], told["self_intersections"])

    # ---- against the clock ----

    def time(self, row, work):
        """Ours and the clock by turns, on one core, so that what else the machine does falls upon both."""
        clock = []
        for turn in range(self.options.repeats):
            if turn and not self.remesh(row, work)[0]:
                row["seconds"].append(json.loads((work / "stats.json").read_text())["seconds"]["engine"])
            if self.clock:
                code, said, _ = corpus.run(["taskset", "-c", self.cpu, self.clock, str(work / "repaired.ply"), "--triangles",
                                            str(row["triangles"]), "--runs", "1"], self.options.clock_timeout)
                words = said.split()
                if code or "seconds" not in words:
                    row["clock_said"] = said[:200]
                    break
                clock.append(float(words[words.index("seconds") + 1]))
                row["clock_triangles"] = int(words[words.index("out") + 1])
                if clock[-1] > LONG:
                    break
        if clock:
            row["clock_seconds"] = clock

    # ---- pictures ----

    def input_quality(self, name):
        """Of the input as it was meshed; None where no run got so far."""
        mesh, kept = self.input_mesh(name), self.out / "meshes" / f"{name}.quality.json"
        if not mesh.exists():
            return None
        if not kept.exists() or kept.stat().st_mtime < mesh.stat().st_mtime:
            kept.write_text(json.dumps(quality.quality_of(mesh)._asdict()))
        return quality.Quality(**json.loads(kept.read_text()))

    def picture(self, mesh, view_of, close=None, size=560):
        """The name of a picture of the mesh, below OUT; None where there is nothing to see. Close: a place in the box, and a zoom."""
        if not mesh.exists() or not view_of.exists():
            return None
        png = self.out / "pictures" / f"{mesh.stem}{'-close' if close else ''}.png"
        if not png.exists() or png.stat().st_mtime < mesh.stat().st_mtime:
            command = [self.options.meshfront, "render", str(mesh), str(png), "--view-of", str(view_of), "--size", str(size)]
            up = models.MODELS[view_of.stem].up
            command += ["--up", up] if up else []
            if close:
                place, zoom = close
                low, high = self.input_quality(view_of.stem).box
                command += [f"--at={','.join(repr(a + t * (b - a)) for a, b, t in zip(low, high, place))}", "--zoom", str(zoom)]
            code, said, _ = corpus.run(command, self.options.timeout)
            if code:
                self.failures.append(f"{png.name}: exit code {code}: {said}")
                return None
        return png.relative_to(self.out).as_posix()


def seconds_of(row):
    """The run that was least disturbed."""
    return min(row["seconds"])


def ratio_of(row):
    """How many times faster than the clock; None where that is not known."""
    return min(row["clock_seconds"]) / seconds_of(row) if "clock_seconds" in row else None


def line_of(row):
    head = f"{models.MODELS[row['model']].title:<42} rho {row['rho']:<4} eta {row['eta']:<4}"
    if "error_pct" in row:
        head += (f" {row['triangles']:>7} triangles  H {row['error_pct']:.3f} %  2r/R {row['worst']:.3f} {row['half_percentile']:.3f}"
                 f" {row['median']:.3f}  {seconds_of(row):.2f} s")
    if ratio_of(row):
        head += f"  clock / ours {ratio_of(row):.2f}"
    return f"{head}  {'; '.join(row['problems']) or 'ok'}"
