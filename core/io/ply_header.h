// The header of a PLY file: encoding, elements and their properties.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/io/source.h"

namespace meshfront {

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };
enum class PlyType : uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };
int PlyTypeBytes(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat;  // of the value, or of a list's values
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  // lists only
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  uint64_t line = 0;  // of the header that defines it
  std::vector<PlyProperty> properties;

  // The least bytes one of these takes in this encoding; a list takes its count only.
  uint64_t LeastBytes(PlyEncoding encoding) const;
  bool HasLists() const;
  // Its place in `properties`, or -1.
  int Find(std::string_view property) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  uint64_t body_offset = 0;  // in bytes
  uint64_t lines = 0;        // of the header
};

// Lines may end in LF, CR LF or CR. At most 256 elements and 1024 properties. InvalidArgument with the line.
absl::StatusOr<PlyHeader> ReadPlyHeader(const Source& source);

}  // namespace meshfront
