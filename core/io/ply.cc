// The header becomes a list of elements; each is walked row by row, property by property, by one of two value readers with the same
// three calls (Text, Binary). What is wanted of an element is a table of "property i goes to slot s"; the rest is passed over.
// Rejected: a compiled row layout with strides; it saves 10 ns a vertex and doubles the code.
#include "core/io/ply.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/base/status_macros.h"
#include "core/io/ply_attributes.h"
#include "core/io/ply_header.h"
#include "core/io/polygon.h"
#include "core/io/source.h"
#include "core/io/text_scanner.h"

namespace meshfront {
namespace {

// Values of a binary body. Next() needs a check that the bytes are there (Has) before it.
class BinaryValues {
 public:
  BinaryValues(const Source& source, const PlyHeader& header)
      : begin_(source.bytes.data()),
        at_(begin_ + header.body_offset),
        end_(begin_ + source.bytes.size()),
        swap_(header.encoding == PlyEncoding::kBigEndian) {}

  bool Next(PlyType type, double& value) {
    const int bytes = PlyTypeBytes(type);
    if (end_ - at_ < bytes) return false;
    switch (type) {
      case PlyType::kInt8:
        value = static_cast<int8_t>(*at_);
        break;
      case PlyType::kUint8:
        value = *at_;
        break;
      case PlyType::kInt16:
        value = static_cast<int16_t>(Load<uint16_t>());
        break;
      case PlyType::kUint16:
        value = Load<uint16_t>();
        break;
      case PlyType::kInt32:
        value = static_cast<int32_t>(Load<uint32_t>());
        break;
      case PlyType::kUint32:
        value = Load<uint32_t>();
        break;
      case PlyType::kFloat:
        value = std::bit_cast<float>(Load<uint32_t>());
        break;
      case PlyType::kDouble:
        value = std::bit_cast<double>(Load<uint64_t>());
        break;
    }
    at_ += bytes;
    return true;
  }
  uint64_t remaining() const { return end_ - at_; }
  bool AtEnd() { return at_ == end_; }
  std::string Place() const { return Concat("byte ", at_ - begin_); }
  std::string Problem() { return "the file ends"; }

 private:
  template <class T>
  T Load() const {
    T value;
    std::memcpy(&value, at_, sizeof(T));
    if (!swap_) return value;
    if constexpr (sizeof(T) == 2) return __builtin_bswap16(value);
    if constexpr (sizeof(T) == 4) return __builtin_bswap32(value);
    if constexpr (sizeof(T) == 8) return __builtin_bswap64(value);
  }

  const uint8_t *begin_, *at_, *end_;
  bool swap_;
};

// Values of an ascii body: tokens, wherever the lines end.
class TextValues {
 public:
  TextValues(const Source& source, const PlyHeader& header)
      : scanner_(source.text().substr(header.body_offset), {'\0', false}), lines_before_(header.lines) {}

  bool Next(PlyType, double& value) {
    return scanner_.ReadDouble(value) || (scanner_.SkipToContent() && scanner_.ReadDouble(value));
  }
  uint64_t remaining() const { return scanner_.remaining() + 1; }  // the last line may lack its end
  bool AtEnd() { return !scanner_.SkipToContent(); }
  std::string Place() const { return Concat("line ", lines_before_ + scanner_.line()); }
  std::string Problem() { return AtEnd() ? "the file ends" : Concat(Quote(scanner_.Peek()), " is not a number"); }

 private:
  TextScanner scanner_;
  uint64_t lines_before_;
};

// 2147483647 rather than 2.14748e+09.
std::string Integral(double value) {
  const bool integral = std::fabs(value) < 1e15 && value == std::floor(value);
  return integral ? Concat(static_cast<int64_t>(value)) : Concat(value);
}

std::string AttributeName(const PlyElement& element, const std::string& property) {
  const bool vertex = element.name == "vertex";
  if (property == "nx" || property == "ny" || property == "nz") return vertex ? "normal" : "face normal";
  if (property == "red" || property == "green" || property == "blue" || property == "alpha")
    return vertex ? "color" : "face color";
  if (vertex && (property == "s" || property == "t" || property == "u" || property == "v" || property == "texture_u" ||
                 property == "texture_v")) {
    return "texcoord_0";
  }
  return vertex ? property : Concat(element.name, " ", property);
}

template <class Values>
class BodyReader {
 public:
  BodyReader(const Source& source, const PlyHeader& header)
      : source_(source), header_(header), values_(source, header) {}

  absl::StatusOr<ReadResult> Read() {
    for (const PlyElement& element : header_.elements) {
      MESHFRONT_RETURN_IF_ERROR(CheckCount(element));
      if (element.name == "vertex")
        MESHFRONT_RETURN_IF_ERROR(ReadVertices(element));
      else if (element.name == "face")
        MESHFRONT_RETURN_IF_ERROR(ReadFaces(element));
      else if (element.name == "tristrips")
        MESHFRONT_RETURN_IF_ERROR(ReadStrips(element));
      else
        MESHFRONT_RETURN_IF_ERROR(PassOver(element));
    }
    if (!values_.AtEnd()) {
      result_.warnings.push_back(Concat(values_.Place(), ": what follows the last element was not read"));
    }
    if (small_faces_ > 0) {
      result_.warnings.push_back(Concat(small_faces_, " faces of fewer than three corners were skipped"));
    }
    FinishNormals();
    if (attributes_) FinishAttributes();
    return std::move(result_);
  }

 private:
  template <class... Parts>
  absl::Status Fail(const Parts&... parts) {
    return Refuse(source_, values_.Place(), ": ", parts...);
  }
  absl::Status FailRow(const PlyElement& element, uint64_t row) {
    return Fail(values_.Problem(), " in ", element.name, " ", row, " of ", element.count);
  }

  absl::Status CheckCount(const PlyElement& element) {
    const uint64_t least = element.LeastBytes(header_.encoding);
    if (least > 0 && element.count > values_.remaining() / least) {
      return RefuseAtLine(source_, element.line, "the header says ", element.count, " of element ", Quote(element.name),
                          ", but only ", values_.remaining(), " bytes follow");
    }
    if (element.name == "vertex" && element.count >= Id<void>::kInvalid) {
      return RefuseAtLine(source_, element.line, "the header says ", element.count,
                          " vertices; the most is 4294967294");
    }
    return absl::OkStatus();
  }

  // Passes over a property; for a list, count and values.
  absl::Status Skip(const PlyElement& element, const PlyProperty& property, uint64_t row) {
    uint64_t count = 1;
    if (property.is_list) MESHFRONT_RETURN_IF_ERROR(ReadListCount(element, property, row, count));
    double ignored = 0;
    for (; count > 0; --count) {
      if (!values_.Next(property.type, ignored)) return FailRow(element, row);
    }
    return absl::OkStatus();
  }

  absl::Status PassOver(const PlyElement& element) {
    if (element.properties.empty()) return absl::OkStatus();
    NoteDropped(result_.mesh, "element " + element.name);
    for (uint64_t row = 0; row < element.count; ++row) {
      for (const PlyProperty& property : element.properties) MESHFRONT_RETURN_IF_ERROR(Skip(element, property, row));
    }
    return absl::OkStatus();
  }

  absl::Status ReadListCount(const PlyElement& element, const PlyProperty& property, uint64_t row, uint64_t& count) {
    double value = 0;
    if (!values_.Next(property.count_type, value)) return FailRow(element, row);
    const uint64_t least = header_.encoding == PlyEncoding::kAscii ? 2 : PlyTypeBytes(property.type);
    if (!(value >= 0) || value != std::floor(value) || value > static_cast<double>(values_.remaining() / least)) {
      return Fail(element.name, " ", row, " has a list of ", Integral(value), " values, but only ", values_.remaining(),
                  " bytes follow");
    }
    count = static_cast<uint64_t>(value);
    return absl::OkStatus();
  }

  // Where each property of a vertex goes: 0 to 2 coordinates, 3 to 5 normal, from 6 on an attribute, -1 nowhere.
  std::vector<int> Slots(const PlyElement& element) {
    constexpr std::string_view kNames[] = {"x", "y", "z", "nx", "ny", "nz"};
    std::vector<int> slots(element.properties.size(), -1);
    for (int slot = 0; slot < 6; ++slot) {
      const int at = element.Find(kNames[slot]);
      if (at >= 0 && !element.properties[at].is_list) slots[at] = slot;
    }
    return slots;
  }

  absl::Status ReadVertices(const PlyElement& element) {
    const std::vector<int> slots = Slots(element);
    auto has = [&](int slot) { return std::find(slots.begin(), slots.end(), slot) != slots.end(); };
    if (!has(0) || !has(1) || !has(2)) return RefuseAtLine(source_, element.line, "element vertex lacks x, y or z");
    has_normals_ = has(3) && has(4) && has(5) && IsPointSet();
    std::vector<int> slots_of_all = slots;
    if (!IsPointSet()) attributes_.emplace(element, slots_of_all);
    const size_t numbers = 6 + (attributes_ ? attributes_->Stride() : 0);
    return ReadVertexRows(element, slots_of_all, numbers);
  }

  absl::Status ReadVertexRows(const PlyElement& element, const std::vector<int>& slots, size_t numbers) {
    for (size_t i = 0; i < slots.size(); ++i) {
      if (slots[i] < 0 || (slots[i] > 2 && slots[i] < 6 && !has_normals_)) {
        NoteDropped(result_.mesh, AttributeName(element, element.properties[i].name));
      }
    }
    TriangleMesh& mesh = result_.mesh;
    mesh.positions.reserve(element.count);
    if (has_normals_) mesh.normals.reserve(element.count);
    std::vector<double> v(numbers, 0);
    for (uint64_t row = 0; row < element.count; ++row) {
      for (size_t i = 0; i < slots.size(); ++i) {
        if (slots[i] < 0)
          MESHFRONT_RETURN_IF_ERROR(Skip(element, element.properties[i], row));
        else if (!values_.Next(element.properties[i].type, v[slots[i]]))
          return FailRow(element, row);
      }
      mesh.positions.push_back({v[0], v[1], v[2]});
      if (has_normals_) mesh.normals.push_back({v[3], v[4], v[5]});
      if (attributes_) attributes_->AddRow(absl::MakeConstSpan(v).subspan(6));
    }
    return absl::OkStatus();
  }

  bool IsPointSet() const {
    return std::none_of(header_.elements.begin(), header_.elements.end(),
                        [](const PlyElement& e) { return (e.name == "face" || e.name == "tristrips") && e.count > 0; });
  }
  uint64_t VertexCount() const {
    for (const PlyElement& e : header_.elements) {
      if (e.name == "vertex") return e.count;
    }
    return 0;
  }

  absl::StatusOr<int> FindIndices(const PlyElement& element) {
    int at = element.Find("vertex_indices");
    if (at < 0) at = element.Find("vertex_index");
    if (at < 0 || !element.properties[at].is_list) {
      return RefuseAtLine(source_, element.line, "element ", Quote(element.name), " lacks the list vertex_indices");
    }
    for (const PlyProperty& p : element.properties) {
      if (p.name != element.properties[at].name) NoteDropped(result_.mesh, AttributeName(element, p.name));
    }
    return at;
  }

  // One row into corners_; `take` decides about a value.
  template <class Take>
  absl::Status ReadIndexRow(const PlyElement& element, size_t indices, uint64_t row, const Take& take) {
    for (size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (i != indices) {
        MESHFRONT_RETURN_IF_ERROR(Skip(element, property, row));
        continue;
      }
      uint64_t count = 0;
      MESHFRONT_RETURN_IF_ERROR(ReadListCount(element, property, row, count));
      for (double value = 0; count > 0; --count) {
        if (!values_.Next(property.type, value)) return FailRow(element, row);
        if (!take(value)) {
          return Fail(element.name, " ", row, " names vertex ", Integral(value), "; there are ", VertexCount(),
                      ", counted from 0");
        }
      }
    }
    return absl::OkStatus();
  }

  absl::Status ReadFaces(const PlyElement& element) {
    if (element.count == 0) return absl::OkStatus();
    MESHFRONT_ASSIGN_OR_RETURN(const int indices, FindIndices(element));
    const double vertices = static_cast<double>(VertexCount());
    ReserveTriangles(element, indices);
    std::vector<uint32_t> corners;
    PolygonCutter cutter;
    for (uint64_t row = 0; row < element.count; ++row) {
      corners.clear();
      MESHFRONT_RETURN_IF_ERROR(ReadIndexRow(element, indices, row, [&](double value) {
        if (!(value >= 0 && value < vertices) || value != std::floor(value)) return false;
        corners.push_back(static_cast<uint32_t>(value));
        return true;
      }));
      if (corners.size() < 3)
        ++small_faces_;
      else
        cutter.Append(corners, result_.mesh);
    }
    return absl::OkStatus();
  }

  // Binary faces with indices of one or two bytes can become more triangles than their number says: room for what the rest of the
  // file can hold, so that the array is never copied.
  void ReserveTriangles(const PlyElement& element, int indices) {
    const uint64_t bytes = header_.encoding == PlyEncoding::kAscii ? 2 : PlyTypeBytes(element.properties[indices].type);
    const uint64_t possible = values_.remaining() / bytes;
    result_.mesh.triangles.reserve(
        bytes <= 2 && header_.encoding != PlyEncoding::kAscii ? possible : std::min(element.count, possible / 3));
  }

  absl::Status ReadStrips(const PlyElement& element) {
    if (element.count == 0) return absl::OkStatus();
    MESHFRONT_ASSIGN_OR_RETURN(const int indices, FindIndices(element));
    const double vertices = static_cast<double>(VertexCount());
    const uint64_t bytes = header_.encoding == PlyEncoding::kAscii ? 2 : PlyTypeBytes(element.properties[indices].type);
    std::vector<Triangle>& triangles = result_.mesh.triangles;
    triangles.reserve(triangles.size() + values_.remaining() / bytes);
    for (uint64_t row = 0; row < element.count; ++row) {
      uint64_t length = 0;
      VertexId before, last;
      MESHFRONT_RETURN_IF_ERROR(ReadIndexRow(element, indices, row, [&](double value) {
        if (value == -1) {
          length = 0;
          return true;
        }
        if (!(value >= 0 && value < vertices) || value != std::floor(value)) return false;
        const VertexId next(static_cast<uint32_t>(value));
        // Every second triangle of a strip is turned over; one that names a vertex twice only leads on.
        if (length >= 2 && before != last && last != next && next != before) {
          triangles.push_back(length % 2 == 0 ? Triangle{before, last, next} : Triangle{last, before, next});
        }
        before = last, last = next, ++length;
        return true;
      }));
    }
    return absl::OkStatus();
  }

  // Faces may have been there without a triangle among them.
  void FinishAttributes() {
    attributes_->Finish(result_.mesh);
    if (attributes_->not_finite() > 0) result_.warnings.push_back(NotFiniteAttributes(attributes_->not_finite()));
  }

  void FinishNormals() {
    if (has_normals_ && !result_.mesh.triangles.empty()) {
      result_.mesh.normals = {};
      NoteDropped(result_.mesh, "normal");
    }
  }

  const Source& source_;
  const PlyHeader& header_;
  Values values_;
  ReadResult result_;
  bool has_normals_ = false;
  std::optional<PlyAttributes> attributes_;
  uint64_t small_faces_ = 0;
};

}  // namespace

bool IsPly(const Source& source) {
  const std::string_view text = source.text();
  return text.size() >= 4 && text.substr(0, 3) == "ply" && (text[3] == '\n' || text[3] == '\r' || text[3] == ' ');
}

absl::StatusOr<ReadResult> ReadPly(const Source& source) {
  MESHFRONT_ASSIGN_OR_RETURN(const PlyHeader header, ReadPlyHeader(source));
  if (header.encoding == PlyEncoding::kAscii) return BodyReader<TextValues>(source, header).Read();
  return BodyReader<BinaryValues>(source, header).Read();
}

absl::Status WritePly(const TriangleMesh& mesh, Output& output) {
  output.Text("ply\nformat binary_little_endian 1.0\ncomment Meshfront\nelement vertex ");
  output.Number(uint64_t{mesh.positions.size()});
  output.Text("\nproperty double x\nproperty double y\nproperty double z\n");
  if (!mesh.normals.empty()) output.Text("property double nx\nproperty double ny\nproperty double nz\n");
  if (!mesh.IsPointSet()) {
    output.Text("element face "), output.Number(uint64_t{mesh.triangles.size()});
    output.Text("\nproperty list uchar uint vertex_indices\n");
  }
  output.Text("end_header\n");
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    output.Raw(mesh.positions[i]);
    if (!mesh.normals.empty()) output.Raw(mesh.normals[i]);
  }
  for (const Triangle& t : mesh.triangles) output.Raw(uint8_t{3}), output.Raw(t);
  return absl::OkStatus();
}

}  // namespace meshfront
