#include "core/region_selection.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace meshfront {
namespace {

std::string Text(const Vec3& p) { return absl::StrCat("(", p.x, ", ", p.y, ", ", p.z, ")"); }

bool Holds(const RegionSphere& sphere, const Vec3& p) { return Distance(sphere.center, p) <= sphere.radius; }
bool Holds(const Box3& box, const Vec3& p) {
  return p.x >= box.min.x && p.x <= box.max.x && p.y >= box.min.y && p.y <= box.max.y && p.z >= box.min.z &&
         p.z <= box.max.z;
}

std::string Describe(const RegionSphere& s) {
  return absl::StrCat("the sphere around ", Text(s.center), " of radius ", s.radius);
}
std::string Describe(const Box3& box) { return absl::StrCat("the box from ", Text(box.min), " to ", Text(box.max)); }

absl::Status Empty(const std::string& where, uint64_t vertices, const TriangleMesh& mesh) {
  const Box3 box = BoundingBox(mesh);
  return absl::InvalidArgumentError(
      absl::StrCat("options.region is empty: ", where, " holds ", vertices, " vertices of the ",
                   "mesh and no face with all three; the mesh lies between ", Text(box.min), " and ", Text(box.max),
                   "; take a larger or another part"));
}

template <class Shape>
absl::StatusOr<std::vector<uint32_t>> SelectInside(const TriangleMesh& mesh, const Shape& shape) {
  std::vector<uint8_t> inside(mesh.positions.size());
  for (size_t v = 0; v < inside.size(); ++v) inside[v] = Holds(shape, mesh.positions[v]);
  std::vector<uint32_t> chosen;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    if (inside[t[0].index()] & inside[t[1].index()] & inside[t[2].index()]) chosen.push_back(f);
  }
  if (chosen.empty()) return Empty(Describe(shape), std::count(inside.begin(), inside.end(), 1), mesh);
  return chosen;
}

absl::StatusOr<std::vector<uint32_t>> SelectNumbered(const TriangleMesh& mesh, const RegionFaces& faces,
                                                     uint64_t input_faces) {
  std::vector<bool> named(input_faces, false);
  for (size_t i = 0; i < faces.size(); ++i) {
    if (faces[i] >= input_faces) {
      return absl::InvalidArgumentError(absl::StrCat("options.region.faces names face ", faces[i], " (entry ", i,
                                                     "); the input has ", input_faces, " faces, counted from 0"));
    }
    named[faces[i]] = true;
  }
  std::vector<uint32_t> chosen;
  for (uint32_t f = 0; f < mesh.face_origins.size(); ++f) {
    if (named[mesh.face_origins[f]]) chosen.push_back(f);
  }
  if (!chosen.empty()) return chosen;
  return absl::InvalidArgumentError(absl::StrCat("options.region is empty: of the ", faces.size(),
                                                 " faces that it names none is left after repair; name others"));
}

}  // namespace

absl::Status ValidateRegion(const Region& region) {
  if (const auto* sphere = std::get_if<RegionSphere>(&region.shape)) {
    if (!IsFinite(sphere->center)) return absl::InvalidArgumentError("options.region.sphere.center is not finite");
    if (std::isfinite(sphere->radius) && sphere->radius > 0) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat("options.region.sphere.radius is ", sphere->radius, "; it must be finite and positive"));
  }
  if (const auto* box = std::get_if<Box3>(&region.shape)) {
    if (!IsFinite(box->min) || !IsFinite(box->max)) {
      return absl::InvalidArgumentError("options.region.box has a corner that is not finite");
    }
    if (box->min.x <= box->max.x && box->min.y <= box->max.y && box->min.z <= box->max.z) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrCat("options.region.box.min is ", Text(box->min),
                                                   "; no coordinate may exceed that of options.region.box.max, ",
                                                   Text(box->max)));
  }
  if (!std::get<RegionFaces>(region.shape).empty()) return absl::OkStatus();
  return absl::InvalidArgumentError("options.region.faces is empty; it must name at least one face");
}

absl::StatusOr<std::vector<uint32_t>> SelectFaces(const TriangleMesh& mesh, const Region& region,
                                                  uint64_t input_faces) {
  if (const auto* sphere = std::get_if<RegionSphere>(&region.shape)) return SelectInside(mesh, *sphere);
  if (const auto* box = std::get_if<Box3>(&region.shape)) return SelectInside(mesh, *box);
  return SelectNumbered(mesh, std::get<RegionFaces>(region.shape), input_faces);
}

}  // namespace meshfront
