#include "client/mesh_upload.h"

#include <algorithm>
#include <bit>

#include "absl/strings/string_view.h"
#include "proto/wire/convert.h"
#include "proto/wire/crc32c.h"
#include "proto/wire/sha256.h"

namespace meshfront {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays on the wire are little-endian and sent as they lie");
static_assert(sizeof(Vec3) == 24 && sizeof(Triangle) == 12, "arrays are sent as they lie");

template <class Element>
absl::string_view BytesOf(const std::vector<Element>& array) {
  return {reinterpret_cast<const char*>(array.data()), array.size() * sizeof(Element)};
}

// Small enough that a block in flight costs little, large enough that messages do.
constexpr size_t kBlockBytes = 256 << 10;
static_assert(kBlockBytes <= kMaxBlockBytes);

bool UploadArray(v1::Array array, absl::string_view bytes, const BlockWriter& write, Sha256* digest) {
  v1::DataBlock block;
  block.set_array(array);
  for (size_t offset = 0; offset < bytes.size(); offset += kBlockBytes) {
    const absl::string_view data = bytes.substr(offset, kBlockBytes);
    block.set_offset(offset);
    block.set_data(data.data(), data.size());
    block.set_crc32c(Crc32c(data));
    digest->Update(data);
    if (!write(block)) return false;
  }
  return true;
}

}  // namespace

v1::Header HeaderFor(const TriangleMesh& mesh) {
  v1::Header header;
  const bool has_normals = !mesh.normals.empty() && mesh.normals.size() == mesh.positions.size();
  if (mesh.IsPointSet()) {
    v1::PointSet* points = header.mutable_points();
    points->set_point_count(mesh.positions.size());
    points->set_scalar_type(v1::SCALAR_TYPE_FLOAT64);
    points->set_has_normals(has_normals);
  } else {
    v1::MeshArrays* arrays = header.mutable_mesh();
    arrays->set_vertex_count(mesh.positions.size());
    arrays->set_triangle_count(mesh.triangles.size());
    arrays->set_scalar_type(v1::SCALAR_TYPE_FLOAT64);
    arrays->set_has_normals(has_normals);
    for (const AttributeChannel& channel : mesh.attributes.channels) {
      v1::AttributeChannel* announced = arrays->add_attributes();
      announced->set_name(channel.name);
      announced->set_components(channel.components);
    }
    arrays->set_wedge_count(mesh.attributes.wedge_count());
    arrays->set_has_groups(!mesh.attributes.groups.empty());
  }
  return header;
}

bool UploadArrays(const TriangleMesh& mesh, const std::vector<uint32_t>& region_faces, const Polylines& features,
                  const BlockWriter& write, v1::EndOfInput* end) {
  Sha256 digest;
  if (!UploadArray(v1::ARRAY_POSITIONS, BytesOf(mesh.positions), write, &digest)) return false;
  if (!UploadArray(v1::ARRAY_TRIANGLES, BytesOf(mesh.triangles), write, &digest)) return false;
  const bool has_normals = !mesh.normals.empty() && mesh.normals.size() == mesh.positions.size();
  if (has_normals && !UploadArray(v1::ARRAY_NORMALS, BytesOf(mesh.normals), write, &digest)) return false;
  if (!UploadArray(v1::ARRAY_REGION_FACES, BytesOf(region_faces), write, &digest)) return false;
  if (!features.segments.empty() &&
      (!UploadArray(v1::ARRAY_FEATURE_POSITIONS, BytesOf(features.points), write, &digest) ||
       !UploadArray(v1::ARRAY_FEATURE_SEGMENTS, BytesOf(features.segments), write, &digest)))
    return false;
  const MeshAttributes& a = mesh.attributes;
  if (!UploadArray(v1::ARRAY_WEDGE_VALUES, BytesOf(a.values), write, &digest) ||
      !UploadArray(v1::ARRAY_CORNER_WEDGES, BytesOf(a.corners), write, &digest) ||
      !UploadArray(v1::ARRAY_GROUPS, BytesOf(a.groups), write, &digest))
    return false;
  end->set_sha256(digest.Finish());
  return true;
}

}  // namespace meshfront
