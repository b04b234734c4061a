"""Shapes made in code, in place of models that can't be had: scans of statues, and an iso-surface of a bone.

    write_ply(path, *statue(255, seed=1))         20 f² triangles: a sphere with bumps of every size, and a scanner's noise
    write_ply(path, *bone(0.0158))                marching tetrahedra of this cell size, full of slivers

Both are closed and oriented outwards; the same arguments give the same bytes.
"""
import array
import collections
import itertools
import math
import random

# ---- a statue ----

# Bumps: radians to a unit of length, amplitude. The coarse ones are everywhere; the fine ones, as of hair or cloth, come and go.
COARSE = [(2.0, 0.18), (5.0, 0.07), (12.0, 0.02)]
FINE = [(30.0, 0.02), (70.0, 0.012), (160.0, 0.0065)]
WAVES = 4  # in each of them
# Bumps finer than this many edges are left out: a coarse statue has none.
EDGES_TO_A_BUMP = 6
EDGE = 1.1  # of an icosahedron, on the unit sphere
NOISE = 0.01  # of a scanner, radially, in lengths of an edge


def statue(frequency, seed):
    """(points, triangles): each face of an icosahedron divided into frequency² triangles, and moved along its radius."""
    chance = random.Random(seed)
    edge = EDGE / frequency

    def waves(octaves):
        made = [(amplitude / math.sqrt(WAVES), *(turns * x for x in direction(chance)), chance.uniform(0, 2 * math.pi))
                for turns, amplitude in octaves for _ in range(WAVES)]
        finest = 2 * math.pi / (EDGES_TO_A_BUMP * edge)
        return [wave for wave in made if math.hypot(*wave[1:4]) <= finest]

    def height(bumps):
        return sum(amplitude * sin(u * x + v * y + w * z + phase) for amplitude, u, v, w, phase in bumps)

    sin = math.sin
    coarse, fine = waves(COARSE), waves(FINE)
    where = [3 * x for x in direction(chance)]
    directions, triangles = geodesic_sphere(frequency)
    points = []
    for x, y, z in directions:
        share = 0.5 + 0.5 * sin(where[0] * x + where[1] * y + where[2] * z)
        radius = 1 + height(coarse) + NOISE * edge * chance.gauss(0, 1)
        radius += share ** 2 * height(fine)
        points.append((radius * x, 1.35 * radius * y, radius * z))
    return points, triangles


def direction(chance):
    x = [chance.gauss(0, 1) for _ in range(3)]
    return [a / math.hypot(*x) for a in x]


def geodesic_sphere(frequency):
    golden = (1 + math.sqrt(5)) / 2
    corners = [p for a, b in itertools.product((-1, 1), (-golden, golden)) for p in ((0, a, b), (a, b, 0), (b, 0, a))]
    faces = [f for f in itertools.combinations(range(12), 3)
             if all(math.isclose(math.dist(corners[a], corners[b]), 2) for a, b in itertools.combinations(f, 2))]
    points, index, triangles = [], {}, []

    def vertex(face, weights):
        """One for all faces that have it: by the corners that it lies between, and how near it is to each."""
        key = tuple(sorted((c, w) for c, w in zip(face, weights) if w))
        if key not in index:
            index[key] = len(points)
            p = [sum(w * corners[c][k] for c, w in key) for k in range(3)]
            length = math.hypot(*p)
            points.append((p[0] / length, p[1] / length, p[2] / length))
        return index[key]

    for face in faces:
        a, b, c = face if volume(*(corners[v] for v in face)) > 0 else (face[0], face[2], face[1])
        row = [vertex((a, b, c), (frequency, 0, 0))]
        for i in range(1, frequency + 1):
            above, row = row, [vertex((a, b, c), (frequency - i, i - j, j)) for j in range(i + 1)]
            triangles += [(above[j], row[j], row[j + 1]) for j in range(i)]
            triangles += [(above[j], row[j + 1], above[j + 1]) for j in range(i - 1)]
    return points, triangles


def volume(a, b, c):
    """Six times that of the tetrahedron between a triangle and the origin."""
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]))


# ---- a bone ----

# Soft balls along curves: two rings that touch in front, and a bar behind that joins them. Three tunnels, as in a pelvis.
RING, BAR = 16, 6
LEVEL = 0.55


def balls():
    for side in (-1, 1):
        for i in range(RING):
            angle = 2 * math.pi * i / RING
            yield (side * (0.62 + 0.42 * math.cos(angle)), 0.55 * math.sin(angle), 0.5 * math.cos(angle)), 0.19 + 0.03 * math.sin(angle)
        yield (side * 0.95, 0.75, -0.35), 0.26
        yield (side * 0.75, 0.8, -0.7), 0.24
        yield (side * 0.1, 0, -0.42), 0.18
    for i in range(BAR):
        yield (-0.5 + i / (BAR - 1), 0.75, -0.85), 0.24


def bone(cell):
    parts = [(*center, -1 / radius ** 2) for center, radius in balls()]
    exp = math.exp

    def height(x, y, z):  # below 0 inside
        return LEVEL - sum(exp(k * ((x - a) * (x - a) + (y - b) * (y - b) + (z - c) * (z - c))) for a, b, c, k in parts)

    return iso_surface(height, cell, (0.75, 0.8, -0.7))


# A cell's six tetrahedra run along its edges in each order of the axes.
ORDERS = list(itertools.permutations(range(3)))
# Vertices keep this far, relative to a grid edge, from its ends, that no two fall together; farther, and they would make needles stand up.
GAP = 1e-7


def iso_surface(height, cell, inside):
    """The zero set around the point `inside`, from one cell that it passes through to the next."""
    values, vertices, points, triangles = {}, {}, [], []

    def at(g):
        if g not in values:
            values[g] = height(g[0] * cell, g[1] * cell, g[2] * cell)
        return values[g]

    def vertex(a, b):
        a, b = min(a, b), max(a, b)
        if (a, b) not in vertices:
            t = min(1 - GAP, max(GAP, values[a] / (values[a] - values[b])))
            vertices[a, b] = len(points)
            points.append(tuple(cell * (p + t * (q - p)) for p, q in zip(a, b)))
        return vertices[a, b]

    def cut(corners):
        """One corner apart: a triangle around it. Two and two: a quadrilateral, as two triangles."""
        below = [c for c in corners if values[c] < 0]
        above = [c for c in corners if values[c] >= 0]
        if len(below) == 2:
            (a, b), (c, d) = below, above
            found = [vertex(a, c), vertex(a, d), vertex(b, d), vertex(b, c)]
            found = [(found[0], found[1], found[2]), (found[0], found[2], found[3])]
        elif len(below) in (1, 3):
            apart, others = (below[0], above) if len(below) == 1 else (above[0], below)
            found = [tuple(vertex(apart, c) for c in others)]
        else:
            return
        outward = [sum(c[k] for c in above) / len(above) - sum(c[k] for c in below) / len(below) for k in range(3)]
        triangles.extend(t if faces(t, outward) else (t[0], t[2], t[1]) for t in found)

    def faces(triangle, outward):
        a, b, c = (points[v] for v in triangle)
        u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
        normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        return sum(x * y for x, y in zip(normal, outward)) > 0

    start = tuple(math.floor(x / cell) for x in inside)
    while at(start) < 0:  # straight on until the surface is passed
        start = (start[0], start[1] + 1, start[2])
    waiting = collections.deque([(start[0], start[1] - 1, start[2])])
    seen = set(waiting)
    while waiting:
        x, y, z = base = waiting.popleft()
        corners = [(x + i, y + j, z + k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
        signs = [at(g) < 0 for g in corners]
        if all(signs) or not any(signs):
            continue
        for order in ORDERS:
            walk = [base]
            for axis in order:
                walk.append(tuple(v + (k == axis) for k, v in enumerate(walk[-1])))
            cut(walk)
        for axis, step in itertools.product(range(3), (-1, 1)):
            beside = tuple(v + step * (k == axis) for k, v in enumerate(base))
            if beside not in seen:
                seen.add(beside)
                waiting.append(beside)
    return points, triangles


# ---- files ----

def write_ply(path, points, triangles):
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty double x\nproperty double y\n"
              f"property double z\nelement face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    numbers = array.array("d", itertools.chain.from_iterable(points))
    corners = bytearray()
    for triangle in triangles:
        corners += b"\3"
        corners += array.array("i", triangle).tobytes()
    path.write_bytes(header.encode() + numbers.tobytes() + corners)
