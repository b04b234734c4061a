// One announced array of an upload, written block by block into the vector it belongs to.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/mesh/triangle_mesh.h"
#include "meshfront/v1/mesh.pb.h"

namespace meshfront {

// Elements may straddle blocks. The vector grows with what came, never beyond what was announced.
class ArrayWriter {
 public:
  // Three doubles (or floats, widened) an element. The vector outlives the writer, as in the others.
  static ArrayWriter ForPoints(v1::Array array, std::vector<Vec3>* out, uint64_t count, v1::ScalarType scalar_type);
  static ArrayWriter ForTriangles(std::vector<Triangle>* out, uint64_t count);
  // Numbers of four bytes, or triples of them.
  static ArrayWriter ForFloats(v1::Array array, std::vector<float>* out, uint64_t count);
  static ArrayWriter ForNumbers(v1::Array array, std::vector<uint32_t>* out, uint64_t count);
  static ArrayWriter ForTriples(v1::Array array, std::vector<CornerWedges>* out, uint64_t count);
  static ArrayWriter ForFile(std::vector<uint8_t>* out, uint64_t bytes);
  // Counted and checked, but not kept.
  static ArrayWriter ForNothing(v1::Array array, uint64_t bytes);

  v1::Array array() const { return array_; }
  uint64_t announced_bytes() const { return announced_; }
  uint64_t received_bytes() const { return received_; }
  // The memory that the whole array will take: floats as the doubles they become.
  uint64_t announced_memory() const { return announced_ / memory_.wire_bytes * memory_.element_bytes; }
  // The memory that is allocated now, also where nothing was written yet.
  uint64_t allocated_bytes() const { return memory_.capacity() * memory_.element_bytes; }
  // What Write would allocate beside that for `bytes` more: the array is copied when it grows.
  uint64_t GrowthFor(uint64_t bytes) const;
  bool whole() const { return received_ == announced_; }

  // InvalidArgument when `offset` is not what was received so far, or `data` is empty or goes beyond what was
  // announced.
  absl::Status Write(uint64_t offset, absl::string_view data);

 private:
  using Store = std::function<void(uint64_t offset, absl::string_view data)>;
  // An element on the wire and in memory, and how many there is room for.
  struct Memory {
    uint64_t wire_bytes, element_bytes;
    std::function<uint64_t()> capacity;
  };
  ArrayWriter(v1::Array array, uint64_t announced, Memory memory, Store store)
      : array_(array), announced_(announced), memory_(std::move(memory)), store_(std::move(store)) {}

  v1::Array array_;
  uint64_t announced_;
  uint64_t received_ = 0;
  Memory memory_;
  Store store_;
};

}  // namespace meshfront
