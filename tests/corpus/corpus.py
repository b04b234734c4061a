#!/usr/bin/env python3
"""Remeshes real models with the command-line client and has every result judged from outside.

    corpus.py                        every model below the data folder at every rho, one row each, a summary at the end
    corpus.py --rho 0.5,1.0 -j 2 --only bunny,igea
    corpus.py --generated            the big ones that data/gen makes, at rho 0.5
    corpus.py --subset               a fixed choice of every class, in minutes
    corpus.py --worst                the same, and the worst ten rows by each measure
    corpus.py --bars bunny           the issue's table for one model: exit code 1 and the reasons where it is missed
    corpus.py --build-judge          builds the judge where it is missing

Rows go to OUT/rows.jsonl as they come, one JSON object a line; a row that is there already for the same binary and flags is not
made again, so a broken run goes on where it stopped, and a run with a longer --timeout or --judge-timeout tries again what was too
slow for a shorter one. Exit code: 0 all well, 1 something is wrong, 77 no data or no judge.
The judge is $MESHFRONT_JUDGE, or build/judge/meshjudge.

What must hold for every row: exit code 0 in time; a manifold, consistently oriented result without degenerate, duplicate or unused
parts; components, genus, boundary loops and the sign of the volume as in the input; the figures of --stats as the judge has them; no
self-intersection. Where repair changed the input, the repaired one (--write-repaired) is what the result is judged against, and it
must be manifold itself. An input that meets itself may do so in the result as well, but only within the result's error bound of
where the input does. Exit code 3 is right for the models of REFUSED alone.
"""
import argparse
import concurrent.futures
import gzip
import hashlib
import json
import math
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading

import intersections

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ["scans", "genus", "cad", "open", "thingi", "assets"]
SUFFIXES = {".off", ".obj", ".ply", ".stl", ".glb", ".gltf"}
SKIPPED = 77
# Written into every row: rows that an older harness judged by other rules are made again.
RULES = 3
WORST = 10
# How far from a new self-intersection one of the input's is looked for, in multiples of the error bound.
SEARCHED = 4
# Wall time, in multiples of the limit on CPU time, after which a run counts as hanging.
HANGS = 5

# Models that may be refused (exit code 3), and why.
REFUSED = {
    "open/beetle_binary.off": "binary OFF in the writer's byte order, without a mark: no reader could tell what it holds",
}

# data/gen/gen_mesh: name of the model -> arguments behind the file's name.
GENERATED = {
    "generated/lattice-500k.ply": ("lattice", "500000"),
    "generated/lattice-2m.ply": ("lattice", "2000000"),
    "generated/asteroid.ply": ("asteroid", "8"),
    "generated/parts-1000.ply": ("parts", "1000"),
    "generated/terrain.ply": ("terrain", "1000"),
    "generated/torus.ply": ("torus", "500000"),
}

# For ./tests/run: something of every class, each at one rho. A choice for speed, of what comes out right: what does not is for
# the whole survey to tell.
SUBSET = [
    ("scans/bunny.off", 0.5),                    # holes
    ("scans/nefertiti.obj.gz", 1.0),
    ("scans/turbineblade.ply", 1.0),             # thin edges
    ("scans/camel.off", 0.5),                    # meets itself
    ("scans/camel.off", 1.0),
    ("scans/feline_41k.obj.gz", 0.5),            # thin tail, genus 2
    ("genus/soccerball.obj.gz", 1.0),            # genus 31
    ("genus/knot-300-100.off.gz", 0.5),          # sheets close to each other
    ("genus/plane_thin_wings.obj.gz", 1.0),
    ("cad/casting.off", 1.0),                    # genus 9
    ("cad/couplingdown.off", 1.0),               # long triangles
    ("cad/fandisk.obj", 0.5),
    ("cad/screwdriver.ply", 1.0),                # big-endian
    ("open/beetle.off.gz", 1.0),                 # 11 loops
    ("open/beetle_binary.off", 1.0),             # refused
    ("open/mountain.obj.gz", 1.0),               # terrain
    ("open/many_small_holes.ply", 1.0),          # bow ties
    ("open/rangemap_lato000.ply", 1.0),          # raw scan, 9 parts
    ("open/teapot.obj", 1.0),                    # parts that cut each other
    ("assets/Suzanne.glb", 1.0),
    ("assets/Duck_gltf/Duck.gltf", 1.0),         # in three files
    ("assets/BoxVertexColors.glb", 0.5),         # 12 triangles
    ("assets/texturedknot.obj", 1.0),
    ("generated/lattice-500k.ply", 0.5),         # genus 48
]

# The issue's table: model -> [(rho, {what: bar})]. Every result must be manifold, keep components, genus and boundary loops, not
# intersect itself, and have triangles of this quality.
QUALITY = {"median": 0.97, "p0.5": 0.70, "min": 0.20}
BARS = {
    "bunny": ("scans/bunny.off", [(0.5, {"triangles": 37000, "hausdorff_pct": 0.25}), (1.0, {"triangles": 16000, "hausdorff_pct": 0.47}),
                                  (1.5, {"triangles": 10200, "hausdorff_pct": 0.57})]),
    "igea": ("scans/igea.ply", [(0.5, {}), (1.0, {})]),
    "nefertiti": ("scans/nefertiti.obj.gz", [(0.5, {}), (1.0, {})]),
    "armadillo": ("scans/armadillo.obj.gz", [(0.5, {}), (1.0, {})]),
    "rocker-arm": ("cad/rocker-arm.obj", [(0.5, {}), (1.0, {})]),
    "kitten": ("genus/kitten.obj", [(0.5, {}), (1.0, {})]),
    "fertility": ("genus/fertility.off", [(0.5, {}), (1.0, {})]),
    "turbineblade": ("scans/turbineblade.ply", [(0.5, {}), (1.0, {})]),
    "knot": ("genus/knot-300-100.off.gz", [(0.5, {})]),
    "spot": ("assets/spot.obj", [(0.5, {}), (1.0, {})]),
}


def run(command, timeout, out=None):
    """(exit code, first line of what it said beside warnings, seconds of CPU); the exit code of a run that takes too long is -1.

    Out: a file for its standard output, which then is not heard. It is time on the CPU that is limited, so that a busy machine fails
    nothing; one that hangs is ended as well.
    """
    def limited():
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(timeout), math.ceil(timeout) + 1))

    with tempfile.TemporaryFile() as heard:
        child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out or heard, stderr=heard, preexec_fn=limited)
        late = threading.Event()
        timer = threading.Timer(HANGS * timeout, lambda: (late.set(), child.kill()))
        timer.start()
        _, status, usage = os.wait4(child.pid, 0)
        timer.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
        heard.seek(0)
        lines = heard.read().decode(errors="replace").splitlines()
    cpu = round(usage.ru_utime + usage.ru_stime, 2)
    if late.is_set() or child.returncode == -signal.SIGXCPU:
        return -1, f"not done after {cpu:.0f} s on the CPU", cpu
    said = [line.strip() for line in lines if line.strip() and ": warning: " not in line]
    return child.returncode, said[0] if said else "", cpu


def quietly(*command):
    subprocess.run([str(word) for word in command], check=True, stdin=subprocess.DEVNULL, capture_output=True)


class Models:
    """The files to remesh, by name; the packed ones are unpacked and the generated ones made below OUT when first asked for."""

    def __init__(self, data, out):
        self.data, self.out, self.lock = data, out, threading.Lock()

    def names(self, only):
        found = [p.relative_to(self.data).as_posix() for folder in FOLDERS for p in sorted((self.data / folder).rglob("*"))
                 if p.is_file() and pathlib.Path(p.name.removesuffix(".gz")).suffix.lower() in SUFFIXES]
        return [name for name in found if not only or any(part in name for part in only)]

    def path(self, name):
        with self.lock:
            if name in GENERATED:
                return self.generated(name)
            return self.unpacked(name) if name.endswith(".gz") else self.data / name

    def unpacked(self, name):
        plain = self.out / "unpacked" / name.removesuffix(".gz")
        if not plain.exists():
            plain.parent.mkdir(parents=True, exist_ok=True)
            begun = plain.with_name(plain.name + ".begun")
            with gzip.open(self.data / name, "rb") as packed, open(begun, "wb") as out:
                shutil.copyfileobj(packed, out)
            begun.rename(plain)
        return plain

    def generated(self, name):
        made = self.out / name
        if not made.exists():
            made.parent.mkdir(parents=True, exist_ok=True)
            generator, begun = made.parent / "gen_mesh", made.with_name("begun-" + made.name)
            if not generator.exists():
                quietly("g++", "-O2", "-std=c++17", "-o", generator, self.data / "gen/gen_mesh.cpp")
            kind, *more = GENERATED[name]
            quietly(generator, kind, begun, *more)
            begun.rename(made)
        return made


def judged(judge, row, reference, work, *flags):
    """What the judge says of the result; None where it says nothing, which then is a problem of the row."""
    code, said, _ = run([judge, "report", str(work / "out.ply"), "--ref", str(reference), "--json", str(work / "judged.json"), *flags],
                        row["judge_timeout"])
    if code:
        note_unjudged(row, "judge", code, said)
        return None
    return json.loads((work / "judged.json").read_text())


def note_unjudged(row, who, code, said):
    row["problems"].append(f"{who}: {said[:300]}")
    if code == -1:
        row["late"] = "judge_timeout"


def may_be_in_time(row, options):
    """Whether it was too slow for less time than there is now. late: the option that was too short; empty where none was."""
    return row["late"] != "" and row[row["late"]] < getattr(options, row["late"])


class Corpus:
    # Where the rows are, what tells one from all others, and by which rules they are made; another class has its own.
    FILE, KEY, RULES = "rows.jsonl", ("model", "rho", "eta", "flags", "binary", "rules"), RULES

    def __init__(self, options):
        self.options = options
        self.out = pathlib.Path(options.out)
        self.out.mkdir(parents=True, exist_ok=True)
        self.models = Models(pathlib.Path(options.data), self.out)
        binary = pathlib.Path(options.meshfront)
        self.version = hashlib.sha256(binary.read_bytes()).hexdigest()[:12]
        self.judge = find_judge()
        self.lock = threading.Lock()

    def key(self, name, rho):
        return name, rho, self.options.eta, self.options.flags, self.version, self.RULES

    def begun(self, name, other):
        """A row of which nothing has been done, and an empty folder to do it in."""
        row = {**dict(zip(self.KEY, self.key(name, other))), "timeout": self.options.timeout,
               "judge_timeout": self.options.judge_timeout, "late": "", "problems": []}
        work = self.out / "work" / f"{name.replace('/', '_')}@{other}"
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir(parents=True)
        return row, work

    def remesh(self, row, model, work, *flags):
        """What it said."""
        files = ["--stats", str(work / "stats.json"), "--write-repaired", str(work / "repaired.ply")]
        row["exit"], said, row["cpu_seconds"] = run([self.options.meshfront, "remesh", str(model), str(work / "out.ply"), *files,
                                                     "--quiet", *flags], self.options.timeout)
        row["late"] = "timeout" if row["exit"] == -1 else ""
        return said.replace(str(work / "out.ply"), "the result").replace(str(model), row["model"])

    def sizing(self, rho):
        """The flags that a run's second key is about."""
        return ["--rho", str(rho), "--eta", str(self.options.eta)]

    def judge_flags(self, row):
        """What else the judge is to look at."""
        return []

    def row(self, name, rho):
        """One model at one rho: remeshed and judged."""
        row, work = self.begun(name, rho)
        model = self.models.path(name)
        said = self.remesh(row, model, work, *self.sizing(rho), "--threads", "1", *self.options.flags.split())
        if row["exit"] == 3 and name in REFUSED:
            row["refused"] = said
        elif row["exit"] != 0:
            row["problems"].append(failure(row, said))
        if (work / "out.ply").exists():
            self.judge_row(row, model, work)
        if not self.options.keep:
            shutil.rmtree(work)
        return row

    def judge_row(self, row, model, work):
        stats = json.loads((work / "stats.json").read_text())
        row["repairs"] = {repair["what"]: repair["count"] for repair in stats["input"]["repairs"]}
        found = judged(self.judge, row, work / "repaired.ply" if row["repairs"] else model, work, *self.judge_flags(row))
        if found is None:
            return
        counts, before, ratio = found["counts"], found["reference_counts"], found["quality"]["radius_ratio"]
        row.update(triangles=counts["faces"], input_triangles=before["faces"], closed=counts["closed"], manifold=counts["manifold"],
                   genus=counts["genus"], loops=counts["boundary_loops"], components=counts["components"],
                   self_intersections=found["self_intersections"]["pairs"], min=ratio["min"], median=ratio["median"],
                   hausdorff_pct=found["distance"]["symmetric_max_pct"], rms_pct=found["distance"]["forward"]["rms_pct"],
                   error_bound=stats["error_bound"], engine_seconds=stats["seconds"]["engine"],
                   total_seconds=stats["seconds"]["total"], peak_mb=round(stats["peak_rss_bytes"] / 1e6, 1))
        row["p0.5"] = ratio["p0.5"]
        row["us_per_triangle"] = 1e6 * row["engine_seconds"] / max(1, row["triangles"])
        row["beyond_bound"] = found["distance"]["forward"]["max"] > stats["error_bound"]
        row["problems"] += [*unsound(counts), *unlike(counts, before)]
        if row["exit"] == 0:
            row["problems"] += misreported(counts, stats["output"])
            row["problems"] += new_meetings(row, work)
        elif row["self_intersections"]:
            row["problems"].append(f"{row['self_intersections']} self-intersections")
        self.look_closer(row, found, stats)

    def look_closer(self, row, found, stats):
        """Of what was judged, what else there is to say."""

    def show(self, row):
        """Of every row, made now or known."""
        print(line_of(row), flush=True)

    def known(self):
        """Rows that are not to be made again, by what tells them apart."""
        file, found = self.out / self.FILE, {}
        for line in file.read_text().splitlines() if file.exists() and not self.options.fresh else []:
            row = json.loads(line)
            if row.get("rules") == self.RULES and not may_be_in_time(row, self.options):
                found[tuple(row[k] for k in self.KEY)] = row
        return found

    def rows(self, jobs):
        known = self.known()

        def one(job):
            row = known.get(self.key(*job))
            if row is None:
                row = self.row(*job)
                with self.lock, open(self.out / self.FILE, "a", encoding="utf-8") as out:
                    out.write(json.dumps(row) + "\n")
            with self.lock:
                self.show(row)
            return row

        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            return list(pool.map(one, jobs))


def failure(row, said):
    """The problem of a row whose exit code is none that it should be."""
    return said if row["exit"] == -1 else f"exit code {row['exit']}: {said[:300]}"


def unsound(counts):
    """What is wrong with a result whatever the input was."""
    wrong = ("nonmanifold_edges", "nonmanifold_vertices", "inconsistent_edges", "degenerate_faces", "duplicate_faces",
             "unreferenced_vertices", "nonfinite_vertices")
    return [f"{counts[what]} {what}" for what in wrong if counts[what]]


def unlike(counts, before):
    """What is not as it was in the input."""
    if not (before["manifold"] and before["orientable"]):
        return [f"the input, as it was meshed, has {before['nonmanifold_edges']} non-manifold edges, {before['nonmanifold_vertices']}"
                f" non-manifold vertices, {before['inconsistent_edges']} inconsistent edges"]
    found = [f"{what} {before[what]} -> {counts[what]}" for what in ("components", "genus", "boundary_loops") if counts[what] != before[what]]
    volumes = [c["signed_volume"] for c in (before, counts)]
    if None not in volumes and volumes[0] * volumes[1] < 0:
        found.append("inside out")
    return found


def misreported(counts, told):
    """Where --stats says of the result what the judge does not."""
    names = {"faces": "triangles", "components": "components", "boundary_loops": "boundary_loops", "genus": "genus", "closed": "closed",
             "manifold": "manifold"}
    return [f"--stats says {mine} {told[mine]}, the judge {counts[its]}" for its, mine in names.items() if counts[its] != told[mine]]


def new_meetings(row, work):
    """Self-intersections of the result that are not within its error bound of the input's."""
    if not row["self_intersections"]:
        return []
    found = intersections.pairs_of(intersections.read_ply(work / "out.ply"))
    if len(found) != row["self_intersections"]:
        return [f"{row['self_intersections']} self-intersections, of which {len(found)} have been located"]
    bound = row["error_bound"]
    near = intersections.NearestMeeting(intersections.read_ply(work / "repaired.ply"), SEARCHED * bound)
    away = [(max(map(near.distance, points)), points[0]) for _, _, points in found]
    far = [place for place in away if place[0] > bound]
    row["new_self_intersections"] = len(far)
    if not far:
        return []
    distance, point = max(far)
    most = f"{distance / bound:.2f} of it" if math.isfinite(distance) else f"more than {SEARCHED} of it"
    return [f"{len(far)} of {len(found)} self-intersections are not within {bound:.4g} of the input's, the furthest {most} away, at "
            + ", ".join(f"{x:.6g}" for x in point)]


def line_of(row):
    head = f"{row['model']:<36} {row['rho']:<4}"
    if "triangles" in row:
        head += (f" {row['triangles']:>8} tri  q {row['min']:.3f} {row['p0.5']:.3f} {row['median']:.3f}  H {row['hausdorff_pct']:.3f} %"
                 f"  {row['engine_seconds']:.2f} s  {row['peak_mb']:.0f} MB  {'closed' if row['closed'] else str(row['loops']) + ' loops'}"
                 f" genus {row['genus']}")
    well = f"refused: {row['refused']}" if "refused" in row else "ok"
    if row.get("self_intersections") and row.get("new_self_intersections") == 0:
        well += f", {row['self_intersections']} self-intersections where the input has them"
    return f"{head}  {'; '.join(row['problems']) or well}"


def missed_bars(row, bars):
    missed = [f"{row['model']} rho {row['rho']}: {problem}" for problem in row["problems"]]
    if "triangles" not in row:
        return missed
    for what, most in bars.items():
        if not row[what] <= most:
            missed.append(f"{row['model']} rho {row['rho']}: {what} is {row[what]:.4g}; the bar is <= {most}")
    for what, least in QUALITY.items():
        if not row[what] >= least:
            missed.append(f"{row['model']} rho {row['rho']}: 2r/R {what} is {row[what]:.4f}; the bar is >= {least}")
    return missed


def find_judge():
    judge = os.environ.get("MESHFRONT_JUDGE") or str(ROOT / "build/judge/meshjudge")
    return judge if os.access(judge, os.X_OK) else None


def build_judge():
    script = ROOT.parent / "shared/judge/build.sh"
    if find_judge():
        print(f"the judge is {find_judge()}")
        return 0
    if not script.exists():
        print("skipped: no judge beside the repository")
        return SKIPPED
    return subprocess.call([str(script), str(ROOT / "build/judge")], stdin=subprocess.DEVNULL)


def check_bars(corpus, name):
    model, cases = BARS[name]
    if not (corpus.models.data / model).exists():
        print(f"skipped: no {model}")
        return SKIPPED
    rows = corpus.rows([(model, rho) for rho, _ in cases])
    missed = [line for row, (_, bars) in zip(rows, cases) for line in missed_bars(row, bars)]
    print("\n".join(missed) if missed else "every bar is reached")
    return 1 if missed else 0


def chosen(corpus):
    """(model, rho) of every run, all models at one rho before the next."""
    if corpus.options.subset:
        return SUBSET
    names = list(GENERATED) if corpus.options.generated else corpus.models.names([n for n in corpus.options.only.split(",") if n])
    rhos = corpus.options.rho or ("0.5" if corpus.options.generated else "0.5,1.0,1.5")
    return [(name, float(rho)) for rho in rhos.split(",") for name in names]


def print_worst(done):
    for what, title, largest in (("min", "smallest 2r/R", False), ("p0.5", "0.5th percentile of 2r/R", False), ("median", "median 2r/R", False),
                                 ("hausdorff_pct", "Hausdorff distance, % of the diagonal", True), ("rms_pct", "rms distance, %", True),
                                 ("us_per_triangle", "microseconds per output triangle", True), ("peak_mb", "peak memory, MB", True)):
        print(f"\nworst by {title}")
        for row in sorted(done, key=lambda r: r[what], reverse=largest)[:WORST]:
            print(f"  {row[what]:>10.4f}  {row['model']} rho {row['rho']}  ({row['input_triangles']} -> {row['triangles']} triangles)")


def survey(corpus):
    rows = corpus.rows(chosen(corpus))
    wrong = [row for row in rows if row["problems"]]
    done = [row for row in rows if "triangles" in row]
    if corpus.options.worst:
        print_worst(done)
    print(f"{len(rows)} runs, {len(done)} results, {sum('refused' in r for r in rows)} refused with reason, {len(wrong)} with problems; "
          f"{sum(r['beyond_bound'] for r in done)} further from the input than their error bound; "
          f"{sum(r['triangles'] for r in done)} triangles in {sum(r['engine_seconds'] for r in done):.1f} s; "
          f"worst q {min((r['min'] for r in done), default=0):.3f}")
    return 1 if wrong else 0


def add_options(parser, timeout, judge_timeout):
    """Those of every script that has meshfront's results judged."""
    parser.add_argument("--meshfront", default=str(ROOT / "build/release/bin/meshfront"))
    parser.add_argument("--data", default=str(ROOT.parent / "shared/data"))
    parser.add_argument("--timeout", type=float, default=timeout, help="seconds of CPU for one remeshing")
    parser.add_argument("--judge-timeout", type=float, default=judge_timeout, help="seconds of CPU for judging one result")
    parser.add_argument("--fresh", action="store_true", help="make rows again that are there")


def add_survey_options(parser, out):
    """More, for surveys of many models. Returns the group of those of which only one may be given."""
    parser.add_argument("--out", default=str(ROOT / "build" / out))
    parser.add_argument("--only", default="", help="models whose name contains one of these, separated by commas")
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument("--keep", action="store_true", help="keep what goes in and comes out, below OUT")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--generated", action="store_true")
    what.add_argument("--subset", action="store_true")
    return what


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser, timeout=120, judge_timeout=600)
    what = add_survey_options(parser, "corpus")
    parser.add_argument("--rho", help="default: 0.5,1.0,1.5; of the generated ones 0.5")
    parser.add_argument("--eta", type=float, default=1.2)
    parser.add_argument("--flags", default="", help="more flags for meshfront remesh, in one word")
    what.add_argument("--bars", choices=sorted(BARS))
    what.add_argument("--build-judge", action="store_true")
    parser.add_argument("--worst", action="store_true")
    options = parser.parse_args()
    if not pathlib.Path(options.data).is_dir():
        print("skipped: no models beside the repository (../shared/data)")
        return SKIPPED
    if options.build_judge:
        return build_judge()
    corpus = Corpus(options)
    if corpus.judge is None:
        print("skipped: no judge (set MESHFRONT_JUDGE, or corpus.py --build-judge)")
        return SKIPPED
    return check_bars(corpus, options.bars) if options.bars else survey(corpus)


if __name__ == "__main__":
    sys.exit(main())
