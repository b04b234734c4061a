// The buffer of a glTF that is written, with the views and accessors that describe it.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "absl/types/span.h"

namespace meshfront {

// Component types of accessors, and targets of views.
enum GltfNumber { kGltfUint16 = 5123, kGltfUint32 = 5125, kGltfFloat = 5126 };
enum GltfTarget { kGltfNoTarget = 0, kGltfArrayBuffer = 34962, kGltfElementArrayBuffer = 34963 };

struct GltfBuffer {
  using Json = nlohmann::ordered_json;

  // Numbers of the view and accessor that are added. Views begin at multiples of four bytes.
  uint64_t AddView(absl::string_view bytes, GltfTarget target);
  template <class Element>
  uint64_t AddArray(const std::vector<Element>& array, GltfTarget target) {
    return AddView({reinterpret_cast<const char*>(array.data()), array.size() * sizeof(Element)}, target);
  }
  // `components`: 1 to 4.
  uint64_t AddAccessor(uint64_t view, GltfNumber type, uint64_t count, uint32_t components);
  // Floats, of which the elements that are all zero are left out where the others with their numbers take less room.
  uint64_t AddSparse(const std::vector<float>& values, uint32_t components);
  // `min` and `max` of an accessor: of its values, at least one.
  void SetBounds(uint64_t accessor, const std::vector<float>& values, uint32_t components);

  Json accessors = Json::array(), views = Json::array();
  std::string bytes;
};

}  // namespace meshfront
