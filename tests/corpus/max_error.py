#!/usr/bin/env python3
"""Remeshes real models with --max-error and has the judge look whether the results keep it.

    max_error.py                         every model below the data folder at 0.3 %, 0.1 % and 0.03 % of its diagonal
    max_error.py --max-error 0.1% -j 2 --only bunny,igea
    max_error.py --subset                a few small ones, in seconds

Rows go to OUT/max_error.jsonl, one JSON object a line; a row that is there already for the same binary and flags is not made again,
unless it was too slow for less time than there is now. Exit code: 0 all well, 1 something is wrong, 77 no data or no judge.

The promise is one-sided: no place of the result is farther from the input (as it was meshed: repaired, where repair changed it) than
--max-error. The judge looks for the farthest of two million samples, and certifies: it subdivides the result's triangles until their
greatest distance is known to a fiftieth of the bound (as its --max-certified does), and gives the upper end. Neither may be more than
the bound. A result that says itself that it does not keep the bound is a problem all the same. How far the input is from the result, the
other way, is written down (and part of the judge's --max-certified), but promised by nothing. What corpus.py asks of every
row must hold as well.
"""
import argparse
import pathlib
import sys

import corpus

# Written into every row: rows that were made or judged by other rules are made again.
RULES = 1
BOUNDS = "0.3%,0.1%,0.03%"
SUBSET = [("assets/spot.obj", "0.3%"), ("scans/bunny.off", "0.3%"), ("cad/fandisk.obj", "0.1%"), ("assets/BoxVertexColors.glb", "0.03%"),
          ("cad/casting.off", "0.1%")]
# How narrowly the judge encloses the greatest distance, in parts of the bound: what its check takes for --max-certified.
CERTIFIED_TO = 1 / 50


def percent(bound):
    return float(bound.removesuffix("%"))


class MaxError(corpus.Corpus):
    """Its rows: {model, max_error, what came out, forward_pct, certified_pct, backward_pct, problems}."""
    FILE, KEY, RULES = "max_error.jsonl", ("model", "max_error", "eta", "flags", "binary", "rules"), RULES

    def sizing(self, other):
        return ["--max-error", other, "--eta", str(self.options.eta)]

    def judge_flags(self, row):
        return ["--samples", str(self.options.samples), "--certify", str(CERTIFIED_TO * percent(row["max_error"]))]

    def look_closer(self, row, found, stats):
        distance = found["distance"]
        certified = distance["certified"]
        row.update(forward_pct=distance["forward"]["max_pct"], forward_at=distance["forward"]["max_at"],
                   certified_pct=certified["forward_upper_pct"], certified_to_the_end=certified["forward_converged"],
                   backward_pct=distance["backward"]["max_pct"], both_ways_pct=certified["symmetric_upper_pct"])
        row["problems"] += beyond(row)

    def show(self, row):
        print(line_of(row), flush=True)


def beyond(row):
    most = percent(row["max_error"])
    if row["forward_pct"] > most:
        place = ", ".join(f"{x:.6g}" for x in row["forward_at"])
        told = ", which --stats does not say" if row["beyond_bound"] else ""
        return [f"{row['forward_pct'] / most:.3f} of the bound away from the input, at {place}{told}"]
    if row["certified_pct"] > most:
        return [f"certified to {row['certified_pct'] / most:.3f} of the bound, {row['forward_pct'] / most:.3f} of it by samples"]
    return []


def line_of(row):
    head = f"{row['model']:<36} {row['max_error']:<6}"
    if "forward_pct" in row:
        most = percent(row["max_error"])
        head += (f" {row['triangles']:>8} tri  q {row['min']:.3f} {row['p0.5']:.3f} {row['median']:.3f}  forward {row['forward_pct'] / most:.3f}"
                 f"  certified {row['certified_pct'] / most:.3f}  backward {row['backward_pct'] / most:.2f}  {row['engine_seconds']:.2f} s")
    return f"{head}  {'; '.join(row['problems']) or row.get('refused', 'ok')}"


def chosen(checks, options):
    """(model, bound) of every run, all models at one bound before the next."""
    if options.subset:
        return [(name, bound) for name, bound in SUBSET if (checks.models.data / name).exists()]
    names = checks.models.names([part for part in options.only.split(",") if part])
    return [(name, bound) for bound in options.max_error.split(",") for name in names]


def summarise(rows):
    wrong = [row for row in rows if row["problems"]]
    done = [row for row in rows if "forward_pct" in row]
    print(f"{len(rows)} runs, {len(done)} results, {len(wrong)} with problems, {sum(bool(beyond(row)) for row in done)} of them beyond the "
          f"bound; {sum(row['both_ways_pct'] > percent(row['max_error']) for row in done)} are beyond it when looked at both ways; "
          f"{sum(row['triangles'] for row in done)} triangles in {sum(row['engine_seconds'] for row in done):.1f} s")
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    corpus.add_options(parser, timeout=300, judge_timeout=900)
    corpus.add_survey_options(parser, "max_error")
    parser.add_argument("--max-error", default=BOUNDS, help=f"in %% of the diagonal, separated by commas; default: {BOUNDS.replace('%', '%%')}")
    parser.add_argument("--samples", type=int, default=2000000, help="of the judge")
    parser.add_argument("--eta", type=float, default=1.2)
    parser.add_argument("--flags", default="", help="more flags for meshfront remesh, in one word")
    options = parser.parse_args()
    if not pathlib.Path(options.data).is_dir():
        print("skipped: no models beside the repository (../shared/data)")
        return corpus.SKIPPED
    if corpus.find_judge() is None:
        print("skipped: no judge (set MESHFRONT_JUDGE, or corpus.py --build-judge)")
        return corpus.SKIPPED
    checks = MaxError(options)
    jobs = chosen(checks, options)
    return summarise(checks.rows(jobs)) if jobs else corpus.SKIPPED


if __name__ == "__main__":
    sys.exit(main())
