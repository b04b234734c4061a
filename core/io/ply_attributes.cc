#include "core/io/ply_attributes.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace meshfront {
namespace {

constexpr int kFirstSlot = 6;

double LargestOf(PlyType type) {
  switch (type) {
    case PlyType::kUint8:
      return 255;
    case PlyType::kUint16:
      return 65535;
    case PlyType::kUint32:
      return 4294967295.0;
    default:
      return 1;
  }
}

}  // namespace

PlyAttributes::PlyAttributes(const PlyElement& vertex, std::vector<int>& slots) {
  static constexpr std::string_view kNormal[] = {"nx", "ny", "nz"}, kColour[] = {"red", "green", "blue", "alpha"};
  static constexpr std::string_view kTexcoords[][2] = {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}};
  Take(vertex, {"NORMAL", 3}, kNormal, slots);
  for (const auto& names : kTexcoords) {
    if (Take(vertex, {"TEXCOORD_0", 2}, names, slots)) break;
  }
  const absl::Span<const std::string_view> colour(kColour);
  if (!Take(vertex, {"COLOR_0", 4}, colour, slots)) Take(vertex, {"COLOR_0", 3}, colour.subspan(0, 3), slots);
  for (size_t i = 0; i < slots.size(); ++i) {
    const std::string_view name = vertex.properties[i].name;
    const bool is_plain = RoleOfName(name) == AttributeRole::kCustom && name.size() <= 64;
    if (slots[i] < 0 && is_plain) Take(vertex, {std::string(name), 1}, {&name, 1}, slots);
  }
}

bool PlyAttributes::Take(const PlyElement& vertex, const AttributeChannel& channel,
                         absl::Span<const std::string_view> properties, std::vector<int>& slots) {
  const bool is_colour = RoleOfName(channel.name) == AttributeRole::kColour;
  const auto is_there = [&](std::string_view name) {
    const int at = vertex.Find(name);
    return at >= 0 && !vertex.properties[at].is_list && slots[at] < kFirstSlot;
  };
  const auto is_known = [&](const AttributeChannel& c) { return c.name == channel.name; };
  if (attributes_.channels.size() >= kMaxAttributeChannels || channel.name.empty() ||
      !std::all_of(properties.begin(), properties.end(), is_there) ||
      std::any_of(attributes_.channels.begin(), attributes_.channels.end(), is_known))
    return false;
  for (const std::string_view name : properties) {
    const int at = vertex.Find(name);
    slots[at] = kFirstSlot + static_cast<int>(scales_.size());
    scales_.push_back(is_colour ? 1 / LargestOf(vertex.properties[at].type) : 1);
  }
  attributes_.channels.push_back(channel);
  return true;
}

void PlyAttributes::AddRow(absl::Span<const double> values) {
  for (size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<float>(scales_[i] * values[i]);
    attributes_.values.push_back(std::isfinite(value) ? value : 0);
    not_finite_ += !std::isfinite(value);
  }
}

// A vertex is a wedge.
void PlyAttributes::Finish(TriangleMesh& mesh) {
  if (attributes_.channels.empty() || mesh.triangles.empty()) return;
  attributes_.corners.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) attributes_.corners.push_back({t[0].index(), t[1].index(), t[2].index()});
  mesh.attributes = std::move(attributes_);
}

}  // namespace meshfront
