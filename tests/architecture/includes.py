#!/usr/bin/env python3
"""Holds the #include lines and the CMake rooms against the table of who may see whom.

    includes.py [ROOT]     every source below core, server, client, proto and tests; one line per violation
    includes.py --try      shows the rules sources that break them, one each, and expects every one to be caught
"""
import pathlib
import re
import sys

# The arrows of the room graph, transitively: a room sees itself and these. "facade" is core/*.{h,cc}.
ROOMS = {
    "base": [],
    "geometry": ["base"],
    "mesh": ["base", "geometry"],
    "io": ["base", "geometry", "mesh"],
    "guidance": ["base", "geometry"],
    "surface": ["base", "geometry", "mesh"],
    "features": ["base", "geometry", "mesh", "guidance", "surface"],
    "front": ["base", "geometry", "mesh", "guidance", "surface"],
    "boolean": ["base", "geometry", "mesh", "guidance", "surface", "features"],
    "facade": ["base", "geometry", "mesh", "io", "guidance", "surface", "features", "front", "boolean"],
}
# Where a room sees another, it may be one or a few of its headers only.
ONLY_HEADERS = {
    ("front", "surface"): ["core/surface/surface.h", "core/surface/oriented_loop.h"],
}
# What the adapters see of core: values and the facade, nothing of how the engine works.
ADAPTERS_SEE = ["base", "geometry", "mesh", "io", "facade"]
# A library that one place hides from everyone else.
HIDDEN = {
    r"tiny_gltf|tinygltf": r"core/io/",
    r"nanoflann": r"core/geometry/",
    r"grpc|google/|\.pb\.h|protobuf": r"(server|client|proto)/",
    r"CLI/": r"(server|client)/",
    r"CGAL|gmp|mpfr": r"$^",
}
OWN = ("core/", "server/", "client/", "proto/", "tests/", "meshfront/v1/")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
NAMES_NETWORK = re.compile(r"grpc|protobuf", re.IGNORECASE)


def place_of(path):
    """('core', room), ('server', ''), ('client', 'cli'), … of a path relative to the root."""
    parts = path.split("/")
    if parts[0] == "core":
        return "core", parts[1] if len(parts) > 2 else "facade"
    return parts[0], parts[1] if len(parts) > 2 else ""


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL)


def wrong_in_core(path, room, target):
    if not target.startswith("core/"):
        return f"core may not see {target.split('/')[0]}" if target.startswith(OWN) else None
    seen = place_of(target)[1]
    if room not in ROOMS:
        return f"core/{room} is not in the table of tests/architecture/includes.py"
    if seen != room and seen not in ROOMS[room]:
        return f"{room} may not see {seen}"
    headers = ONLY_HEADERS.get((room, seen))
    if headers and target not in headers:
        return f"{room} sees of {seen} only {', '.join(headers)}"
    return None


def wrong_in_adapter(side, part, target):
    if target.startswith("core/"):
        seen = place_of(target)[1]
        return None if seen in ADAPTERS_SEE else f"{side} sees of core the facade and its values, not {seen}"
    other = {"server": "client/", "client": "server/"}[side]
    if target.startswith(other) and (side, part) != ("client", "cli"):
        return f"{side} may not see {other.rstrip('/')}"
    return f"{side} may not see tests" if target.startswith("tests/") else None


def wrong_include(path, quote, target):
    """Why this include breaks a rule, or None."""
    side, part = place_of(path)
    if target.startswith("."):
        return "includes are spelled from the repository's root"
    for library, home in HIDDEN.items():
        if side not in ("tests",) and re.search(library, target) and not re.match(home, path) and not target.startswith(OWN):
            return f"{target} may be named below {home} only"
    if side == "core":
        return wrong_in_core(path, part, target)
    if side in ("server", "client"):
        return wrong_in_adapter(side, part, target)
    return None


def violations(path, text, exists):
    """Violations in one source; `exists` tells whether a path from the root is a file of ours."""
    found = []
    for match in INCLUDE.finditer(text):
        quote, target = match.groups()
        line = text.count("\n", 0, match.start(2)) + 1
        reason = wrong_include(path, quote, target)
        if reason is None and quote == '"' and target.startswith(OWN) and not target.endswith(".pb.h") and not exists(target):
            reason = "no such file"
        if reason:
            found.append(f"{path}:{line}: includes {target}: {reason}")
    if path.startswith("core/") and NAMES_NETWORK.search(without_comments(text)):
        found.append(f"{path}: core has never heard of a network, but names gRPC or Protobuf")
    return found


def cmake_violations(text):
    """The rooms as CMake links them may not see more than the table."""
    found = []
    for match in re.finditer(r"^meshfront_room\((\w+)([^)]*)\)", text, re.MULTILINE):
        room, rest = match.groups()
        depends = re.search(r"DEPENDS([a-z_ ]+)", rest)
        for seen in depends.group(1).split() if depends else []:
            if seen not in ROOMS.get(room, []):
                found.append(f"core/CMakeLists.txt: {room} may not link {seen}")
    return found


def check(root):
    found, sources = [], 0
    for side in ("core", "server", "client", "proto", "tests"):
        for path in sorted((root / side).rglob("*")):
            if path.suffix in (".h", ".cc") and path.is_file():
                sources += 1
                name = path.relative_to(root).as_posix()
                found += violations(name, path.read_text(encoding="utf-8"), lambda target: (root / target).is_file())
    found += cmake_violations((root / "core/CMakeLists.txt").read_text(encoding="utf-8"))
    if sources == 0:
        found.append(f"{root}: no sources found")
    print("\n".join(found) if found else f"{sources} sources keep to the table")
    return 1 if found else 0


BROKEN = [
    ("core/mesh/a.cc", '#include "core/io/off.h"'),
    ("core/guidance/a.h", '#include "core/mesh/triangle_mesh.h"'),
    ("core/front/a.cc", '#include "core/surface/mesh_surface.h"'),
    ("core/front/a.cc", '#include "core/features/creases.h"'),
    ("core/attic/a.cc", '#include "core/mesh/repair.h"'),
    ("core/base/a.cc", '#include "core/remesh.h"'),
    ("core/remesh.cc", '#include "server/service.h"'),
    ("core/remesh.cc", "#include <grpcpp/grpcpp.h>"),
    ("core/base/a.h", "class grpc_call;"),
    ("core/mesh/a.cc", "#include <tiny_gltf.h>"),
    ("core/surface/a.cc", "#include <nanoflann.hpp>"),
    ("core/mesh/a.cc", '#include "../geometry/box.h"'),
    ("core/mesh/a.cc", '#include "core/mesh/missing.h"'),
    ("server/a.cc", '#include "client/client.h"'),
    ("server/a.cc", '#include "core/front/advancing_front.h"'),
    ("client/a.cc", '#include "server/service.h"'),
    ("client/a.cc", '#include "tests/support/shapes.h"'),
    ("server/a.cc", "#include <CGAL/Surface_mesh.h>"),
]
SOUND = [
    ("core/front/a.cc", '#include "core/surface/surface.h"\n#include "core/mesh/mesh_sink.h"\n#include <vector>'),
    ("core/mesh/a.h", '// for a gRPC stream\n#include "core/geometry/box.h"'),
    ("core/remesh.cc", '#include "core/front/advancing_front.h"'),
    ("client/cli/main.cc", '#include "server/service.h"\n#include "meshfront/v1/mesh.pb.h"\n#include <grpcpp/grpcpp.h>'),
    ("core/io/gltf.cc", "#include <tiny_gltf.h>"),
]


def try_rules():
    def exists(target):
        return "missing" not in target

    missed = [f"not caught: {path}: {text}" for path, text in BROKEN if not violations(path, text, exists)]
    missed += [f"wrongly caught: {found}" for path, text in SOUND for found in violations(path, text, exists)]
    if not cmake_violations("meshfront_room(guidance DEPENDS base mesh LINK x)"):
        missed.append("not caught: guidance linking mesh")
    print("\n".join(missed) if missed else f"{len(BROKEN) + 1} violations caught, {len(SOUND)} sound sources let through")
    return 1 if missed else 0


if __name__ == "__main__":
    here = pathlib.Path(__file__).resolve().parents[2]
    sys.exit(try_rules() if sys.argv[1:] == ["--try"] else check(pathlib.Path(sys.argv[1]) if sys.argv[1:] else here))
