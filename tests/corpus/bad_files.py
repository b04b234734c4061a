#!/usr/bin/env python3
"""Every hostile file through the command-line client: what must be refused is, in one sentence and without an output.

    bad_files.py MESHFRONT DATA     DATA/bad/CASES.tsv says which files are to be rejected

Checks for every file: no crash, done within a minute, memory at most 20 times the file above what the bare program needs, and an
exit code of the contract. For those marked "reject": exit code 3, one line on stderr (beside warnings) that is a sentence,
nothing written.
Exit code 77 where there is no data.
"""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import threading

CONTRACT = {0, 3, 4}
SECONDS = 60


def run(command):
    """(exit code, stderr, peak memory in bytes)."""
    child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30)))
    timer = threading.Timer(SECONDS, child.kill)
    timer.start()
    said = child.stderr.read().decode(errors="replace")
    _, status, usage = os.wait4(child.pid, 0)
    timer.cancel()
    child.stderr.close()
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, said, usage.ru_maxrss * 1024


def problems_of(kind, path, code, said, peak, floor, output):
    found = []
    if code not in CONTRACT:
        found.append(f"exit code {code}")
    if peak > floor + 20 * max(path.stat().st_size, 1 << 20):
        found.append(f"{peak >> 20} MB of memory for {path.stat().st_size} bytes")
    if code == 3 and output.exists():
        found.append("an output was left behind")
    lines = [line for line in said.strip().splitlines() if not line.startswith("meshfront: warning: ")]
    if code == 3 and (len(lines) != 1 or len(lines[0]) < 20):
        found.append(f"not one sentence on stderr: {said.strip()[:300]!r}")
    if kind == "reject" and code != 3:
        found.append(f"not rejected (exit code {code})")
    return found


def main(meshfront, data):
    cases = pathlib.Path(data) / "bad/CASES.tsv"
    if not cases.exists():
        print("skipped: no hostile files beside the repository (../shared/data/bad)")
        return 77
    floor = run([meshfront, "version"])[2] + (16 << 20)
    wrong = count = 0
    with tempfile.TemporaryDirectory() as folder:
        for line in cases.read_text(encoding="utf-8").splitlines()[1:]:
            name, kind, _ = line.split("\t", 2)
            path = cases.parent / name
            if kind == "class" or not path.exists():
                continue
            output = pathlib.Path(folder) / f"{count}.ply"
            count += 1
            result = run([meshfront, "remesh", str(path), str(output), "--quiet", "--timeout", str(SECONDS // 2)])
            for problem in problems_of(kind, path, *result, floor, output):
                wrong += 1
                print(f"{name} ({kind}): {problem}")
    print(f"{count} hostile files, {wrong} problems")
    return 1 if wrong or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
