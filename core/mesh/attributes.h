// What a mesh carries beside its shape: texture coordinates, normals, colours, skin weights, any named numbers, and the group
// (material, primitive) of each face.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// What the values of a channel mean, and so how they are interpolated.
enum class AttributeRole { kTexcoord, kNormal, kTangent, kColour, kJoints, kWeights, kMorph, kCustom };

// By glTF's names: "TEXCOORD_0", "NORMAL", "TANGENT", "COLOR_0", "JOINTS_0", "WEIGHTS_0", and MorphName's; anything else is custom.
AttributeRole RoleOfName(std::string_view name);

// What a morph target adds to an attribute or to POSITION, in the coordinates of the file's node: "MORPH_2_NORMAL".
struct MorphName {
  uint32_t target = 0;
  std::string_view attribute;
};
std::optional<MorphName> MorphNameOf(std::string_view name);
std::string NameOfMorph(uint32_t target, std::string_view attribute);

struct AttributeChannel {
  std::string name;
  uint32_t components = 0;  // 1 to kMaxAttributeComponents
  bool operator==(const AttributeChannel&) const = default;
};

inline constexpr uint32_t kMaxAttributeComponents = 16, kMaxAttributeChannels = 4096;

// The wedges of the three corners of a triangle.
using CornerWedges = std::array<uint32_t, 3>;

// A wedge is a set of values, one of each channel, that corners of triangles share: a vertex has one wedge where all is smooth, and
// several where a seam passes through it.
struct MeshAttributes {
  std::vector<AttributeChannel> channels;
  std::vector<float> values;          // of each wedge those of all channels, in their order: Stride() numbers
  std::vector<CornerWedges> corners;  // of each triangle; empty without channels
  std::vector<uint32_t> groups;       // of each triangle; empty: all 0

  bool empty() const { return corners.empty() && groups.empty(); }
  uint32_t Stride() const;
  uint32_t wedge_count() const { return channels.empty() ? 0 : static_cast<uint32_t>(values.size() / Stride()); }
  absl::Span<const float> WedgeAt(uint32_t wedge) const {
    return absl::MakeConstSpan(values).subspan(size_t{wedge} * Stride(), Stride());
  }
  uint32_t GroupOf(size_t face) const { return groups.empty() ? 0 : groups[face]; }
  // Where the values of a channel begin in those of a wedge; nothing when there is no such channel.
  std::optional<uint32_t> OffsetOf(std::string_view name) const;
};

// Names of channels for a message, all of morph targets as one.
std::vector<std::string> NamesForMessage(const std::vector<AttributeChannel>& channels);

// InvalidArgument naming what does not fit: their number, names and components.
absl::Status ValidateChannels(const std::vector<AttributeChannel>& channels);
// … or names, components, wedges out of range, values that are not finite.
absl::Status ValidateAttributes(const MeshAttributes& attributes, size_t triangles);

// A wedge with the values at share `t` of the way from wedge `a` to `b`, added behind the others. Joints are those of the nearer one.
uint32_t AddWedgeBetween(MeshAttributes& attributes, uint32_t a, uint32_t b, double t);

// A place on a mesh, on one side of every seam: the face, the weights of its second and third corner, and the unit normal there.
struct WedgeSource {
  uint32_t face = 0;
  double u = 0, v = 0;
  Vec3 normal;
};

// Values of a mesh's attributes at places on it. Texture coordinates, colours, morph targets and custom values are interpolated
// linearly; normals are linear and of unit length (`smooth_normals`: the surface's, where the mesh's are those of flat faces); tangents stay
// orthogonal to the normal, with the sign of the nearest corner; of the joints of all corners those of the largest weights are kept,
// and the weights sum up to 1. Immutable; `attributes` outlives it.
class AttributeInterpolator {
 public:
  AttributeInterpolator(const MeshAttributes& attributes, bool smooth_normals);
  // Appends Stride() numbers.
  void Append(const WedgeSource& source, std::vector<float>& out) const;

 private:
  struct Slot {
    AttributeRole role;
    uint32_t offset, components;
  };
  // Joints and weights of the same number.
  struct Skin {
    uint32_t joints, weights, components;
  };
  void SetNormals(const WedgeSource& source, float* out) const;
  void SetSkin(const CornerWedges& corners, const double* weights, float* out) const;

  const MeshAttributes& attributes_;
  const bool smooth_normals_;
  std::vector<Slot> slots_;
  std::vector<Skin> skins_;
  std::optional<uint32_t> normal_;
};

}  // namespace meshfront
