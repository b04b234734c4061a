#include "core/io/format_table.h"

#include "core/io/gltf.h"
#include "core/io/obj.h"
#include "core/io/off.h"
#include "core/io/ply.h"
#include "core/io/stl.h"
#include "core/io/xyz.h"

namespace meshfront {

const std::vector<FormatRow>& FormatTable() {
  static const std::vector<FormatRow>* const table = new std::vector<FormatRow>{
      {Format::kGlb, "GLB", {"glb"}, IsGlb, ReadGlb, WriteGlb},
      {Format::kPly, "PLY", {"ply"}, IsPly, ReadPly, WritePly},
      {Format::kOff, "OFF", {"off", "coff", "noff", "cnoff"}, IsOff, ReadOff, WriteOff},
      {Format::kGltf, "glTF", {"gltf"}, IsGltf, ReadGltf, WriteGltf},
      {Format::kStl, "STL", {"stl", "stla", "stlb"}, IsStl, ReadStl, WriteStl},
      {Format::kObj, "OBJ", {"obj"}, nullptr, ReadObj, WriteObj},
      {Format::kXyz, "XYZ", {"xyz", "xyzn", "pts", "asc"}, nullptr, ReadXyz, WriteXyz},
  };
  return *table;
}

const FormatRow* FindFormat(Format format) {
  for (const FormatRow& row : FormatTable()) {
    if (row.format == format) return &row;
  }
  return nullptr;
}

}  // namespace meshfront
