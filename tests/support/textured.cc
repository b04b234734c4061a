#include "tests/support/textured.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace meshfront::testing {

TriangleMesh WithChannel(TriangleMesh mesh, const std::string& name, uint32_t components,
                         const std::function<std::vector<float>(const Vec3&, const Vec3&)>& value) {
  MeshAttributes& a = mesh.attributes;
  MeshAttributes out = {a.channels, {}, {}, a.groups};
  out.channels.push_back({name, components});
  std::map<std::pair<uint32_t, std::vector<float>>, uint32_t> wedges;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const Vec3 centroid = (mesh.PositionAt(t[0]) + mesh.PositionAt(t[1]) + mesh.PositionAt(t[2])) / 3.0;
    CornerWedges corners;
    for (int i = 0; i < 3; ++i) {
      std::vector<float> values;
      if (!a.corners.empty()) values.assign(a.WedgeAt(a.corners[f][i]).begin(), a.WedgeAt(a.corners[f][i]).end());
      const std::vector<float> more = value(mesh.PositionAt(t[i]), centroid);
      values.insert(values.end(), more.begin(), more.end());
      const auto [at, is_new] =
          wedges.try_emplace({t[i].index(), values}, static_cast<uint32_t>(out.values.size() / values.size()));
      if (is_new) out.values.insert(out.values.end(), values.begin(), values.end());
      corners[i] = at->second;
    }
    out.corners.push_back(corners);
  }
  a = std::move(out);
  return mesh;
}

TriangleMesh Textured(TriangleMesh mesh, const std::function<std::array<double, 2>(const Vec3&, const Vec3&)>& map) {
  return WithChannel(std::move(mesh), "TEXCOORD_0", 2, [&](const Vec3& place, const Vec3& centroid) {
    const auto [u, v] = map(place, centroid);
    return std::vector<float>{static_cast<float>(u), static_cast<float>(v)};
  });
}

std::array<double, 2> AroundZ(const Vec3& place, const Vec3& centroid) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double middle = std::atan2(centroid.y, centroid.x) / kTurn;
  if (std::hypot(place.x, place.y) < 1e-12) return {middle, place.z};
  double u = std::atan2(place.y, place.x) / kTurn;
  if (u - middle > 0.5) u -= 1;
  if (u - middle < -0.5) u += 1;
  return {u, place.z};
}

}  // namespace meshfront::testing
