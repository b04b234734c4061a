#!/usr/bin/env python3
"""Remeshes real models with the command-line client and has every result judged from outside.

    corpus.py                        every model below the data folder, one row each, a summary at the end
    corpus.py --rho 0.5,1.0 -j 2 --only bunny,igea
    corpus.py --bars bunny           the issue's table for one model: exit code 1 and the reasons where it is missed
    corpus.py --build-judge          builds the judge where it is missing

Rows go to OUT/rows.jsonl as they come, one JSON object a line; a row that is there already for the same binary and flags is not
made again, so a broken run goes on where it stopped. Exit code: 0 all well, 1 something is wrong, 77 no data or no judge.
The judge is $MESHFRONT_JUDGE, or build/judge/meshjudge.
"""
import argparse
import concurrent.futures
import gzip
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import threading

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ["scans", "genus", "cad", "thingi", "open", "assets"]
SUFFIXES = {".off", ".obj", ".ply", ".stl", ".glb", ".gltf"}
SKIPPED = 77

# The issue's table: model -> [(rho, {what: bar})]. Every result must be manifold, keep components, genus and boundary loops, not
# intersect itself, and have triangles of this quality.
QUALITY = {"median": 0.97, "p0.5": 0.70, "min": 0.20}
BARS = {
    "bunny": ("scans/bunny.off", [(0.5, {"triangles": 37000, "hausdorff_pct": 0.24}), (1.0, {"triangles": 16000, "hausdorff_pct": 0.47}),
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


def run(command, timeout):
    """(exit code, last line of what it said); the exit code of a run that takes too long is -1."""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=timeout)
    except subprocess.TimeoutExpired:
        return -1, f"not done after {timeout} s"
    lines = (done.stderr or done.stdout).strip().splitlines()
    return done.returncode, lines[-1] if lines else ""


def unpacked(model, work):
    """The judge does not read gzip."""
    if model.suffix != ".gz":
        return model
    plain = work / model.name[: -len(".gz")]
    with gzip.open(model, "rb") as packed, open(plain, "wb") as out:
        shutil.copyfileobj(packed, out)
    return plain


class Corpus:
    def __init__(self, options):
        self.options = options
        self.data = pathlib.Path(options.data)
        self.out = pathlib.Path(options.out)
        self.out.mkdir(parents=True, exist_ok=True)
        binary = pathlib.Path(options.meshfront)
        self.version = hashlib.sha256(binary.read_bytes()).hexdigest()[:12]
        self.judge = find_judge()
        self.lock = threading.Lock()

    def models(self):
        found = [p for folder in FOLDERS for p in sorted((self.data / folder).rglob("*"))
                 if p.is_file() and pathlib.Path(p.name.removesuffix(".gz")).suffix.lower() in SUFFIXES]
        names = [n for n in self.options.only.split(",") if n]
        return [p for p in found if not names or any(n in p.name for n in names)]

    def expected_after_welding(self):
        """Models whose file repeats vertices, by the manifest."""
        lines = (self.data / "MANIFEST.tsv").read_text(encoding="utf-8").splitlines()
        return {line.split("\t")[0] for line in lines if "after welding" in line}

    def remesh(self, model, work, rho):
        flags = ["--rho", str(rho), "--eta", str(self.options.eta), "--threads", "1", "--quiet", *self.options.flags.split()]
        return run([self.options.meshfront, "remesh", str(model), str(work / "out.ply"), "--stats", str(work / "stats.json"), *flags],
                   self.options.timeout)

    def judged(self, result, reference, work, *flags):
        code, said = run([self.judge, "report", str(result), "--json", str(work / "judged.json"), *flags,
                          *(["--ref", str(reference)] if reference else [])], self.options.timeout)
        return json.loads((work / "judged.json").read_text()) if code == 0 else said

    def row(self, name, rho):
        """One model at one rho: remeshed and judged."""
        row = {"model": name, "rho": rho, "eta": self.options.eta, "flags": self.options.flags, "binary": self.version}
        work = self.out / f"{name.replace('/', '_')}@{rho}"
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir(parents=True)
        model = self.data / name
        row["exit"], said = self.remesh(model, work, rho)
        row["problems"] = [] if row["exit"] == 0 else [f"exit code {row['exit']}: {said}"]
        if (work / "out.ply").exists():
            self.judge_row(row, unpacked(model, work), work)
        if not self.options.keep:
            shutil.rmtree(work)
        return row

    def judge_row(self, row, reference, work):
        weld = ["--weld-ref"] if row["model"] in self.expected_after_welding() else []
        judged = self.judged(work / "out.ply", reference, work, *weld)
        if isinstance(judged, str):
            row["problems"].append(f"judge: {judged}")
            return
        counts, before, ratio = judged["counts"], judged["reference_counts"], judged["quality"]["radius_ratio"]
        row.update(triangles=counts["faces"], closed=counts["closed"], manifold=counts["manifold"], genus=counts["genus"],
                   loops=counts["boundary_loops"], components=counts["components"],
                   self_intersections=judged["self_intersections"]["pairs"], min=ratio["min"], median=ratio["median"],
                   hausdorff_pct=judged["distance"]["symmetric_max_pct"], rms_pct=judged["distance"]["forward"]["rms_pct"])
        row["p0.5"] = ratio["p0.5"]
        stats = json.loads((work / "stats.json").read_text())
        row.update(engine_seconds=stats["seconds"]["engine"], total_seconds=stats["seconds"]["total"],
                   peak_mb=round(stats["peak_rss_bytes"] / 1e6, 1))
        self.compare(row, counts, before, reference, work)

    def compare(self, row, counts, before, reference, work):
        problems = row["problems"]
        if not counts["manifold"]:
            problems.append(f"{counts['nonmanifold_edges']} non-manifold edges, {counts['nonmanifold_vertices']} non-manifold vertices")
        if counts["inconsistent_edges"]:
            problems.append(f"{counts['inconsistent_edges']} inconsistently oriented edges")
        sound = before["manifold"] and before["orientable"]
        for what in ("components", "genus", "boundary_loops"):
            # What a non-manifold input is after repair is not for the judge to say.
            if sound and counts[what] != before[what]:
                problems.append(f"{what} {before[what]} -> {counts[what]}")
        pairs = row["self_intersections"]
        if pairs:
            own = self.judged(reference, None, work)
            row["input_self_intersections"] = own["self_intersections"]["pairs"] if isinstance(own, dict) else None
            problems.append(f"{pairs} self-intersections (input: {row['input_self_intersections']})")

    def rows(self, jobs):
        known = {}
        file = self.out / "rows.jsonl"
        for line in file.read_text().splitlines() if file.exists() else []:
            row = json.loads(line)
            known[tuple(row[k] for k in ("model", "rho", "eta", "flags", "binary"))] = row

        def one(job):
            key = (*job, self.options.eta, self.options.flags, self.version)
            row = known.get(key) if not self.options.fresh else None
            if row is None:
                row = self.row(*job)
                with self.lock, open(file, "a", encoding="utf-8") as out:
                    out.write(json.dumps(row) + "\n")
            with self.lock:
                print(line_of(row), flush=True)
            return row

        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            return list(pool.map(one, jobs))


def line_of(row):
    head = f"{row['model']:<36} {row['rho']:<4}"
    if "triangles" in row:
        head += (f" {row['triangles']:>8} tri  q {row['min']:.3f} {row['p0.5']:.3f} {row['median']:.3f}  H {row['hausdorff_pct']:.3f} %"
                 f"  {row['engine_seconds']:.2f} s  {row['peak_mb']:.0f} MB  {'closed' if row['closed'] else str(row['loops']) + ' loops'}"
                 f" genus {row['genus']}")
    return f"{head}  {'; '.join(row['problems']) or 'ok'}"


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
    if not (corpus.data / model).exists():
        print(f"skipped: no {model}")
        return SKIPPED
    rows = corpus.rows([(model, rho) for rho, _ in cases])
    missed = [line for row, (_, bars) in zip(rows, cases) for line in missed_bars(row, bars)]
    print("\n".join(missed) if missed else "every bar is reached")
    return 1 if missed else 0


def survey(corpus):
    rhos = [float(r) for r in corpus.options.rho.split(",")]
    rows = corpus.rows([(p.relative_to(corpus.data).as_posix(), rho) for p in corpus.models() for rho in rhos])
    wrong = [row for row in rows if row["problems"]]
    done = [row for row in rows if "triangles" in row]
    print(f"{len(rows)} runs, {len(done)} results, {len(wrong)} with problems; "
          f"{sum(r['triangles'] for r in done)} triangles in {sum(r['engine_seconds'] for r in done):.1f} s; "
          f"worst q {min((r['min'] for r in done), default=0):.3f}")
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--meshfront", default=str(ROOT / "build/release/bin/meshfront"))
    parser.add_argument("--data", default=str(ROOT.parent / "shared/data"))
    parser.add_argument("--out", default=str(ROOT / "build/corpus"))
    parser.add_argument("--rho", default="0.5,1.0")
    parser.add_argument("--eta", type=float, default=1.2)
    parser.add_argument("--flags", default="", help="more flags for meshfront remesh, in one word")
    parser.add_argument("--only", default="", help="models whose file name contains one of these, separated by commas")
    parser.add_argument("--bars", choices=sorted(BARS))
    parser.add_argument("--build-judge", action="store_true")
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=300, help="seconds for one remeshing or judging")
    parser.add_argument("--fresh", action="store_true", help="make rows again that are there")
    parser.add_argument("--keep", action="store_true", help="keep the results, below OUT")
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
