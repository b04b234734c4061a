// What the tests of this room share.
#pragma once

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "core/io/mesh_io.h"
#include "gtest/gtest.h"

namespace meshfront::testing {

inline absl::Span<const uint8_t> BytesOf(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

inline absl::StatusOr<ReadResult> ReadText(const std::string& text, Format format = Format::kUnknown) {
  // A copy on the heap without a spare byte, so that AddressSanitizer sees a read past the end.
  const std::vector<uint8_t> bytes(text.begin(), text.end());
  return ReadMesh(bytes, format, "test");
}

// "0 0 0; 1 0 0; 0 1 0 | 0 1 2" as a mesh.
inline TriangleMesh OneTriangle() {
  return {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{VertexId(0), VertexId(1), VertexId(2)}}};
}

// A folder of its own for the test that is running; removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "meshfront_io_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string File(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }
  size_t Entries() const {
    return std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator());
  }

 private:
  std::string path_;
};

// A GLB made by hand: the JSON and the BIN chunk as they are.
inline std::string Glb(std::string json, std::string binary = "") {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  auto u32 = [](uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  std::string body = u32(static_cast<uint32_t>(json.size())) + "JSON" + json;
  if (!binary.empty()) body += u32(static_cast<uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
  return "glTF" + u32(2) + u32(static_cast<uint32_t>(body.size() + 12)) + body;
}

template <class T>
std::string Raw(std::initializer_list<T> values) {
  return std::string(reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(T));
}

}  // namespace meshfront::testing
