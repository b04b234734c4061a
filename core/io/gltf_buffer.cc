#include "core/io/gltf_buffer.h"

#include <algorithm>
#include <array>
#include <utility>

namespace meshfront {
namespace {

constexpr std::array<const char*, 4> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};

}  // namespace

uint64_t GltfBuffer::AddView(absl::string_view of_view, GltfTarget target) {
  bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
  Json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", of_view.size()}};
  if (target != kGltfNoTarget) view["target"] = target;
  bytes.append(of_view.data(), of_view.size());
  views.push_back(std::move(view));
  return views.size() - 1;
}

uint64_t GltfBuffer::AddAccessor(uint64_t view, GltfNumber type, uint64_t count, uint32_t components) {
  accessors.push_back(
      {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", kTypes[components - 1]}});
  return accessors.size() - 1;
}

uint64_t GltfBuffer::AddSparse(const std::vector<float>& values, uint32_t components) {
  const size_t count = values.size() / components;
  std::vector<uint32_t> indices;
  std::vector<float> moved;
  for (size_t i = 0; i < count; ++i) {
    const auto element = values.begin() + static_cast<ptrdiff_t>(i * components);
    if (std::all_of(element, element + components, [](float v) { return v == 0; })) continue;
    indices.push_back(static_cast<uint32_t>(i));
    moved.insert(moved.end(), element, element + components);
  }
  if (indices.empty()) indices.push_back(0), moved.assign(components, 0);  // there must be one
  if (indices.size() * (components + 1) >= values.size())
    return AddAccessor(AddArray(values, kGltfArrayBuffer), kGltfFloat, count, components);
  const uint64_t index_view = AddArray(indices, kGltfNoTarget), value_view = AddArray(moved, kGltfNoTarget);
  accessors.push_back({{"componentType", kGltfFloat},
                       {"count", count},
                       {"type", kTypes[components - 1]},
                       {"sparse",
                        {{"count", indices.size()},
                         {"indices", {{"bufferView", index_view}, {"componentType", kGltfUint32}}},
                         {"values", {{"bufferView", value_view}}}}}});
  return accessors.size() - 1;
}

void GltfBuffer::SetBounds(uint64_t accessor, const std::vector<float>& values, uint32_t components) {
  std::vector<float> least(values.begin(), values.begin() + components), most = least;
  for (size_t i = 0; i < values.size(); ++i) {
    least[i % components] = std::min(least[i % components], values[i]);
    most[i % components] = std::max(most[i % components], values[i]);
  }
  accessors[accessor]["min"] = least, accessors[accessor]["max"] = most;
}

}  // namespace meshfront
