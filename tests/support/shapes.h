// Shapes made in code, for every test that needs one. All are oriented manifolds (outward where closed) without unreferenced
// vertices, and functions of their arguments alone: the same bits on every run.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry/box.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront::testing {

// --- Closed -------------------------------------------------------------------------------------------------------------

// 20 · 4^subdivisions triangles, vertices on the sphere around the origin.
TriangleMesh Icosphere(int subdivisions, double radius = 1);
// An icosphere scaled along the axes.
TriangleMesh Ellipsoid(int subdivisions, const Vec3& semi_axes);
// `around` vertices on each of `rings` circles of latitude, and two poles.
TriangleMesh UvSphere(int around, int rings, double radius = 1);
// Around the z axis; `around` vertices the long way, `along` the short way. Genus 1.
TriangleMesh Torus(double major_radius, double minor_radius, int around, int along);
// The zero set of `f` (negative inside) by marching tetrahedra on a grid of `cells` cells along the longest side of `box`,
// where grid vertices close to the surface are moved onto it first; vertices lie on the surface to rounding. Closed if the
// zero set stays inside the box. Triangles are as uneven as an iso-surface's are.
TriangleMesh IsoSurface(const std::function<double(const Vec3&)>& f, const Box3& box, int cells);
// A row of three tori melted together, 6.4 long: genus 3. 96 cells give about 25k triangles.
TriangleMesh GenusThree(int cells = 96);
// A cube [-1, 1]³ with n × n squares a face; its edges are sharp.
TriangleMesh Cube(int n);
// The points within `radius` of the box [-half, half]: `core` squares along each side of that box (one along a side of
// length 0 is left out) and `rim` along each quarter circle. Smooth where radius > 0.
TriangleMesh RoundedBox(const Vec3& half, double radius, int core, int rim);
// A cylinder of `length` along z with half spheres at its ends: 8 · rim vertices around, `core` squares along.
TriangleMesh Capsule(double length, double radius, int core, int rim);
// A plate 2 × 2 × `thickness` (2 % of its side) with a round rim, n squares along a side.
TriangleMesh ThinSlab(int n = 60, double thickness = 0.04, int rim = 4);
// A cylinder with flat caps, its rims sharp.
TriangleMesh CappedCylinder(double radius, double height, int around, int along);
// The solid cells of the grid of unit cubes [0, cells), n × n squares on each of their free faces. No two solid cells may touch
// in an edge or a corner alone.
TriangleMesh Blocks(const std::array<int, 3>& cells, const std::function<bool(int x, int y, int z)>& is_solid,
                    int n = 1);
// The solid below an open mesh that faces up: the mesh itself, `height` higher, a copy that faces down, and walls of `rows` rows.
TriangleMesh Extruded(const TriangleMesh& flat, double height, int rows = 1);
// [-1, 1]² × [0, height] with a round hole along z; n squares along a side. Genus 1.
TriangleMesh PlateWithRoundHole(int n = 24, double radius = 0.4, double height = 0.3);
// [0, 2] along z; in the plane a triangle with a corner of `angle` radians at the origin between two sides of length 2, the first
// along x; n edges along each side.
TriangleMesh Wedge(double angle, int n = 1);
// A prism over a half disk: one straight and one bent edge between the same two corners, at the top and at the bottom.
TriangleMesh HalfDiskPrism();
// A prism over a drop, whose only corner is at (2, 0): its caps' edges run from a corner to itself.
TriangleMesh DropPrism();
// A triangle with a sharp rim, raised by 0.1 in its middle above and below: six faces.
TriangleMesh Pillow();
// Two spherical caps on a common circle of radius 1, `height` high each; their edge has no corner.
TriangleMesh Lens(double height, int n = 24);
// A pyramid over the square [-1, 1]², in four triangles and two.
TriangleMesh Pyramid(double height);
// A prism over a star of `points` points, radii 1 and `inner`.
TriangleMesh StarPrism(int points, double inner, double height);
// A fan of triangles around the first point, which sees all others; counter-clockwise from above.
TriangleMesh Fan(const std::vector<Vec3>& points);
// Two unit spheres, 3 apart.
TriangleMesh TwoSpheres(int subdivisions);
// Two capsules side by side along z, radius 1, with `gap` between them (1 % of the radius).
TriangleMesh ParallelTubes(double gap = 0.01, double length = 4, int core = 30, int rim = 8);
// A unit sphere with a cavity: the inner sphere's triangles face its centre. Two components of genus 0.
TriangleMesh ConcentricShells(int subdivisions, double inner_radius = 0.9);

// --- Open ---------------------------------------------------------------------------------------------------------------

// [-1, 1]² at z = 0 in n × n squares, facing up.
TriangleMesh Sheet(int n);
// The same with z = `height`(x, y).
TriangleMesh HeightField(int n, const std::function<double(double x, double y)>& height);
// Hills of height 0.15, two waves along a side.
TriangleMesh WavyTerrain(int n);
// A gently domed disk of radius 1 with `holes` round holes of radius 0.15 on a circle of radius 0.55: holes + 1 boundary loops.
TriangleMesh DiskWithHoles(int n = 60, int holes = 3);
// The upper half of the unit sphere.
TriangleMesh Hemisphere(int subdivisions);
// A tube around the z axis, open at both ends.
TriangleMesh OpenCylinder(double radius, double height, int around, int along);
// What of the mesh lies where f ≤ 0, cut along the zero line, whose vertices are exact; vertices close to the line are moved
// onto it, so that no slivers are made.
TriangleMesh Clipped(const TriangleMesh& mesh, const std::function<double(const Vec3&)>& f);

// --- Changed ------------------------------------------------------------------------------------------------------------

// Both, side by side in one mesh.
TriangleMesh Joined(TriangleMesh a, const TriangleMesh& b);
TriangleMesh Mapped(TriangleMesh mesh, const std::function<Vec3(const Vec3&)>& map);
TriangleMesh Moved(TriangleMesh mesh, const Vec3& shift);
TriangleMesh Scaled(TriangleMesh mesh, double factor);
// By `angle` radians, right-handed around `axis` (need not be a unit vector).
TriangleMesh Rotated(TriangleMesh mesh, const Vec3& axis, double angle);
// Inside out.
TriangleMesh Reversed(TriangleMesh mesh);
// Every vertex moved by at most `amplitude` along each axis.
TriangleMesh WithNoise(TriangleMesh mesh, double amplitude, uint64_t seed);
// The same surface with vertices, faces and each face's first corner in another order.
TriangleMesh Permuted(const TriangleMesh& mesh, uint64_t seed);
// Vertices that no triangle uses are dropped; the others are numbered in the order of their first use.
TriangleMesh WithoutUnreferenced(const TriangleMesh& mesh);
// A point set: `count` places at random on the mesh, evenly spread by area, with the normals of their faces.
TriangleMesh Sampled(const TriangleMesh& mesh, size_t count, uint64_t seed = 1);
// Every triangle with three vertices of its own, as an STL file holds it.
TriangleMesh Soup(const TriangleMesh& mesh);

}  // namespace meshfront::testing
