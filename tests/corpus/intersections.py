"""Where a triangle mesh meets itself: every pair of faces with the points at which they do, decided exactly.

What counts as meeting is what counts for the judge: more than the shared vertex or edge, touching included, after welding equal
positions and without faces that have no area. The judge counts all pairs and names ten; here each has its place.

    mesh = read_ply("out.ply")
    for face, other, points in pairs_of(mesh): ...
    NearestMeeting(input_mesh, reach).distance(point)     to the closest place where the input meets itself, if within reach

Pairs are found in a uniform grid of the faces' boxes; orientations are computed in floating point with an error bound, in whole
numbers where it does not decide. Plain Python: ten seconds for 100,000 faces, so ask only where the judge counted pairs.
"""
import array
import collections
import itertools
import math
import sys

Mesh = collections.namedtuple("Mesh", "points faces")
# Bytes of a number in a PLY file.
SIZES = {"uchar": 1, "ushort": 2, "uint": 4, "float": 4, "double": 8}


def read_ply(path):
    """As read_parts, equal positions welded."""
    return welded(*read_parts(path))


def read_parts(path):
    """(points, faces) of a binary little-endian PLY of triangles, as meshfront writes it. Vertices may have more than coordinates."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii").splitlines()
    if "format binary_little_endian 1.0" not in header or sys.byteorder != "little":
        raise ValueError(f"{path.name} is no little-endian PLY")
    sizes = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element ")}
    kinds = [line.split()[1] for line in header if line.startswith("property ") and "list" not in line]
    lists = [line for line in header if line.startswith("property list ")]
    if kinds[:3] not in (["float"] * 3, ["double"] * 3) or not set(kinds) <= set(SIZES) or \
            len(lists) != 1 or not lists[0].startswith("property list uchar "):
        raise ValueError(f"{path.name} has more than coordinates, numbers and triangles")
    numbers = array.array("d" if kinds[0] == "double" else "f")
    stride, position = sum(SIZES[kind] for kind in kinds), 3 * numbers.itemsize
    middle = end + sizes["vertex"] * stride
    vertices = data[end:middle]
    if stride != position:
        vertices = b"".join(vertices[at:at + position] for at in range(0, len(vertices), stride))
    numbers.frombytes(vertices)
    points = list(zip(numbers[0::3], numbers[1::3], numbers[2::3]))
    corners = array.array("i")
    for at in range(middle, middle + 13 * sizes["face"], 13):
        if data[at] != 3:
            raise ValueError(f"{path.name} has a face of {data[at]} corners")
        corners.frombytes(data[at + 1:at + 13])
    return points, list(zip(corners[0::3], corners[1::3], corners[2::3]))


def welded(points, faces):
    first = {}
    to = [first.setdefault(p, i) for i, p in enumerate(points)]
    return Mesh(points, [(to[a], to[b], to[c]) for a, b, c in faces])


# ---- orientations: exact signs ----

def determinant(a, b, c, d):
    """Six times the volume of abcd, and how large its terms are."""
    ax, ay, az = a[0] - d[0], a[1] - d[1], a[2] - d[2]
    bx, by, bz = b[0] - d[0], b[1] - d[1], b[2] - d[2]
    cx, cy, cz = c[0] - d[0], c[1] - d[1], c[2] - d[2]
    p, q, r, s, t, u = by * cz, bz * cy, bz * cx, bx * cz, bx * cy, by * cx
    return (ax * (p - q) + ay * (r - s) + az * (t - u),
            abs(ax) * (abs(p) + abs(q)) + abs(ay) * (abs(r) + abs(s)) + abs(az) * (abs(t) + abs(u)))


def sign(value, size, exact):
    """Eight roundings at most lie between the coordinates and a determinant: 1e-15 of its terms is more than they can do."""
    if value > 1e-15 * size:
        return 1
    if value < -1e-15 * size:
        return -1
    value = exact()
    return (value > 0) - (value < 0)


def whole(*points):
    """The points in whole numbers: all times the same power of two, which changes no sign."""
    ratios = [[x.as_integer_ratio() for x in p] for p in points]
    scale = max(under for p in ratios for _, under in p)
    return [tuple(over * (scale // under) for over, under in p) for p in ratios]


def side(a, b, c, d):
    return sign(*determinant(a, b, c, d), lambda: determinant(*whole(a, b, c, d))[0])


def turn(a, b, c):
    """The sense of abc in the plane."""
    def double_area(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    size = abs((b[0] - a[0]) * (c[1] - a[1])) + abs((b[1] - a[1]) * (c[0] - a[0]))
    return sign(double_area(a, b, c), size, lambda: double_area(*whole(a, b, c)))


# ---- a segment and a triangle ----

def between(p, q, t):
    return tuple(x + t * (y - x) for x, y in zip(p, q))


def segment_in_plane(p, q, triangle):
    """Points at which the segment pq and a triangle in one plane meet: ends inside, crossings of edges."""
    a, b, c = triangle
    normal = [abs((b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i])) for i, j in ((1, 2), (2, 0), (0, 1))]
    drop = normal.index(max(normal))
    flat = [tuple(x for k, x in enumerate(point) if k != drop) for point in (p, q, a, b, c)]
    u, v, corners = flat[0], flat[1], flat[2:]
    found = []
    for point, shown in ((u, p), (v, q)):
        turns = {turn(corners[k], corners[(k + 1) % 3], point) for k in range(3)}
        if not {1, -1} <= turns:
            found.append(shown)
    for k in range(3):
        d, e = corners[k], corners[(k + 1) % 3]
        if turn(u, v, d) * turn(u, v, e) < 0 and turn(d, e, u) * turn(d, e, v) < 0:
            over = (d[0] - u[0]) * (e[1] - d[1]) - (d[1] - u[1]) * (e[0] - d[0])
            under = (v[0] - u[0]) * (e[1] - d[1]) - (v[1] - u[1]) * (e[0] - d[0])
            found.append(between(p, q, over / under if under else 0.5))
    return found


def segment_meets(p, q, triangle, at_p, at_q):
    """Points at which the segment pq meets a triangle that has an area. at_p, at_q: the sides of its plane that the ends are on."""
    a, b, c = triangle
    if at_p * at_q > 0:
        return []
    if at_p == at_q == 0:
        return segment_in_plane(p, q, triangle)
    if {1, -1} <= {side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)}:
        return []
    height, other = abs(determinant(a, b, c, p)[0]), abs(determinant(a, b, c, q)[0])
    return [between(p, q, height / (height + other) if height + other else 0.5)]


# ---- pairs of faces ----

def meeting(points, face, other):
    """Points at which two faces meet in more than what they share; none where they do not."""
    shared = [v for v in face if v in other]
    if len(shared) == 3:
        return [points[v] for v in shared]
    s, t = [points[v] for v in face], [points[v] for v in other]
    if len(shared) == 2:
        apex, its = (points[next(v for v in f if v not in shared)] for f in (face, other))
        a, b = (points[v] for v in shared)
        if side(a, b, apex, its) != 0:
            return []
        return folded(a, b, apex, its)
    at_s, at_t = sides_of(t, s, face, other), sides_of(s, t, other, face)
    if leave_the_plane(at_s, shared) or leave_the_plane(at_t, shared):
        return []  # As most pairs do, whose boxes overlap because they are neighbours.
    return edges_meet(s, face, at_s, t, other) + edges_meet(t, other, at_t, s, face)


def sides_of(triangle, corners, ids, its_ids):
    """The sides of a triangle's plane that the corners of another one are on; 0 in it, as what both share."""
    return [0 if v in its_ids else side(*triangle, p) for p, v in zip(corners, ids)]


def leave_the_plane(sides, shared):
    """Whether all corners but a shared one lie on one side of the other triangle's plane."""
    return abs(sum(sides)) == 3 - len(shared)


def edges_meet(corners, ids, sides, triangle, its_ids):
    """Points at which the edges of one triangle meet another one, but those that end at a shared vertex: they meet it there already."""
    free = [k for k in range(3) if ids[k] not in its_ids]
    ends = [(k, (k + 1) % 3) for k in free if (k + 1) % 3 in free]
    return [x for k, n in ends for x in segment_meets(corners[k], corners[n], triangle, sides[k], sides[n])]


def folded(a, b, apex, its):
    """Two triangles over the edge ab in one plane: they overlap where they lie on the same side of it."""
    drop = max(range(3), key=lambda k: sum(abs(determinant(a, b, p, tuple(x + (i == k) for i, x in enumerate(a)))[0]) for p in (apex, its)))
    flat = [tuple(x for k, x in enumerate(p) if k != drop) for p in (a, b, apex, its)]
    return [a, b] if turn(flat[0], flat[1], flat[2]) * turn(flat[0], flat[1], flat[3]) > 0 else []


def has_area(points, face):
    """As the judge has it: the double area is more than 1e-8 of the longest edge's square, and the corners are on no line."""
    a, b, c = (points[v] for v in face)
    if len(set(face)) < 3 or not all(math.isfinite(x) for p in (a, b, c) for x in p):
        return False
    e, f = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
    double_area = math.hypot(e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0])
    return double_area > 1e-8 * max(math.dist(p, q) for p, q in ((a, b), (b, c), (c, a))) ** 2


def box_of(corners, grow=0.0):
    low = [min(axis) - grow for axis in zip(*corners)]
    high = [max(axis) + grow for axis in zip(*corners)]
    return (*low, *high)


def overlap(a, b):
    return (a[0] <= b[3] and b[0] <= a[3] and a[1] <= b[4] and b[1] <= a[4] and a[2] <= b[5] and b[2] <= a[5])


class Grid:
    """The boxes of the faces that have an area, by cells twice as wide as the middle one of them."""

    def __init__(self, mesh):
        self.boxes = {i: box_of([mesh.points[v] for v in f]) for i, f in enumerate(mesh.faces) if has_area(mesh.points, f)}
        widths = sorted(max(b[3] - b[0], b[4] - b[1], b[5] - b[2]) for b in self.boxes.values())
        largest = widths[-1] if widths else 1.0
        # A face far larger than the middle one must not fill the whole table.
        self.cell = max(2 * widths[len(widths) // 2], largest / 64) if widths else 1.0
        self.faces = collections.defaultdict(list)
        for i, box in self.boxes.items():
            for cell in self.cells(box):
                self.faces[cell].append(i)

    def cells(self, box):
        spans = [range(math.floor(box[k] / self.cell), math.floor(box[k + 3] / self.cell) + 1) for k in range(3)]
        return itertools.product(*spans)

    def touching(self, box):
        return {i for cell in self.cells(box) for i in self.faces.get(cell, ()) if overlap(self.boxes[i], box)}


def pairs_of(mesh):
    """Every pair of faces that meet, as (face, other, points)."""
    grid = Grid(mesh)
    found = []
    for i, box in grid.boxes.items():
        for j in grid.touching(box):
            if j > i:
                points = meeting(mesh.points, mesh.faces[i], mesh.faces[j])
                if points:
                    found.append((i, j, points))
    return found


# ---- how far from such a place ----

def distance_to_segment(p, a, b):
    along = [y - x for x, y in zip(a, b)]
    length2 = sum(x * x for x in along)
    t = sum((x - y) * z for x, y, z in zip(p, a, along)) / length2 if length2 else 0.0
    return math.dist(p, between(a, b, min(1.0, max(0.0, t))))


def distance_to_triangle(p, a, b, c):
    def from_to(u, v):
        return [y - x for x, y in zip(u, v)]

    def cross(u, v):
        return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]

    def dot(u, v):
        return sum(x * y for x, y in zip(u, v))
    normal = cross(from_to(a, b), from_to(a, c))
    length2 = dot(normal, normal)
    if length2 > 0 and all(dot(normal, cross(from_to(u, v), from_to(u, p))) >= 0 for u, v in ((a, b), (b, c), (c, a))):
        return abs(dot(normal, from_to(a, p))) / math.sqrt(length2)
    return min(distance_to_segment(p, u, v) for u, v in ((a, b), (b, c), (c, a)))


def distance_to_box(p, box):
    return math.hypot(*(max(low - x, x - high, 0.0) for x, low, high in zip(p, box, box[3:])))


class NearestMeeting:
    """How far it is to the next place where a mesh meets itself; looks only at the faces within reach of a point."""
    # Most points that are asked for lie close to such a place: the first look goes so much less far.
    FIRST = 2 ** -6

    def __init__(self, mesh, reach):
        self.mesh, self.reach, self.grid, self.parts, self.distances = mesh, reach, Grid(mesh), {}, {}

    def distance(self, point):
        """Infinite where there is none within reach."""
        if point not in self.distances:
            reach = self.reach * self.FIRST
            while (found := self.within(point, reach)) == math.inf and reach < self.reach:
                reach = min(2 * reach, self.reach)
            self.distances[point] = found
        return self.distances[point]

    def within(self, point, reach):
        least = math.inf
        for away, i in sorted((distance_to_box(point, self.grid.boxes[i]), i) for i in self.grid.touching(box_of([point], reach))):
            if away >= least:
                break
            for box, part in self.parts_of(i):
                if distance_to_box(point, box) < least:
                    least = min(least, distance_to_triangle(point, *part))
        return least if least <= reach else math.inf

    def parts_of(self, i):
        """Where face i meets another one, as boxes of triangles, perhaps flat: two faces in one plane meet in all that lies between the points."""
        if i not in self.parts:
            meet = (self.ends_of(i, j) for j in self.grid.touching(self.grid.boxes[i]) if j != i)
            self.parts[i] = [(box_of(part), part) for ends in meet if ends
                             for part in itertools.combinations(ends + ends[:1] * max(0, 3 - len(ends)), 3)]
        return self.parts[i]

    def ends_of(self, i, j):
        """Of what two faces that meet have in common: it reaches to the vertices that they share."""
        points, face, other = self.mesh.points, self.mesh.faces[i], self.mesh.faces[j]
        ends = meeting(points, face, other)
        return ends and list(dict.fromkeys([*ends, *(points[v] for v in face if v in other)]))
