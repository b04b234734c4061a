#include "core/io/ply_header.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/base/status_macros.h"
#include "core/io/text_scanner.h"

namespace meshfront {
namespace {

constexpr size_t kMostElements = 256, kMostProperties = 1024;

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr std::array<TypeName, 16> kTypeNames = {{
    {"char", PlyType::kInt8},
    {"int8", PlyType::kInt8},
    {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},
    {"short", PlyType::kInt16},
    {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},
    {"uint16", PlyType::kUint16},
    {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},
    {"uint", PlyType::kUint32},
    {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat},
    {"float32", PlyType::kFloat},
    {"double", PlyType::kDouble},
    {"float64", PlyType::kDouble},
}};

class HeaderReader {
 public:
  explicit HeaderReader(const Source& source) : source_(source), scanner_(source.text(), {'\0', false}) {}

  absl::StatusOr<PlyHeader> Read() {
    if (scanner_.Token() != "ply") return Fail("the first line must be \"ply\"");
    NextLine();
    bool has_format = false;
    for (;;) {
      while (scanner_.AtLineEnd() && scanner_.remaining() > 0) NextLine();
      if (scanner_.remaining() == 0) return Fail("the file ends inside the header, before end_header");
      const std::string_view word = scanner_.Token();
      if (word == "end_header") break;
      if (word == "format") {
        MESHFRONT_RETURN_IF_ERROR(ReadFormat());
        has_format = true;
      } else if (word == "element") {
        MESHFRONT_RETURN_IF_ERROR(ReadElement());
      } else if (word == "property") {
        MESHFRONT_RETURN_IF_ERROR(ReadProperty());
      } else if (word != "comment" && word != "obj_info") {
        return Fail(Quote(word), " is no word of a PLY header");
      }
      NextLine();
    }
    if (!has_format) return Fail("the header has no format line");
    return FinishHeader();
  }

 private:
  template <class... Parts>
  absl::Status Fail(const Parts&... parts) {
    return RefuseAtLine(source_, scanner_.line(), parts...);
  }

  void NextLine() { scanner_.SkipLine(); }

  absl::StatusOr<PlyHeader> FinishHeader() {
    const bool cut = scanner_.AtLineEnd() && scanner_.remaining() == 0;
    NextLine();
    if (cut && !header_.elements.empty() && header_.elements[0].count > 0) {
      return Fail("the file ends after its header");
    }
    header_.body_offset = scanner_.offset();
    header_.lines = scanner_.line() - 1;
    return std::move(header_);
  }

  absl::Status ReadFormat() {
    const std::string_view name = scanner_.Token();
    if (name == "ascii")
      header_.encoding = PlyEncoding::kAscii;
    else if (name == "binary_little_endian")
      header_.encoding = PlyEncoding::kLittleEndian;
    else if (name == "binary_big_endian")
      header_.encoding = PlyEncoding::kBigEndian;
    else
      return Fail("the format is ", Quote(name), "; it must be ascii, binary_little_endian or binary_big_endian");
    const std::string_view version = scanner_.Token();
    if (version != "1.0") return Fail("the format's version is ", Quote(version), "; only 1.0 is known");
    return absl::OkStatus();
  }

  absl::Status ReadElement() {
    PlyElement element;
    element.name = std::string(scanner_.Token());
    element.line = scanner_.line();
    int64_t count = 0;
    if (element.name.empty()) return Fail("an element has no name");
    if (!scanner_.ReadInt(count)) {
      return Fail("the number of element ", Quote(element.name), " is ", Quote(scanner_.Peek()), ", not an integer");
    }
    if (count < 0) return Fail("the number of element ", Quote(element.name), " is ", count, "; it can't be negative");
    if (header_.elements.size() == kMostElements) return Fail("there are more than ", kMostElements, " elements");
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) return Fail("element ", Quote(element.name), " is defined twice");
    }
    element.count = static_cast<uint64_t>(count);
    header_.elements.push_back(std::move(element));
    return absl::OkStatus();
  }

  absl::Status ReadType(PlyType& type) {
    const std::string_view name = scanner_.Token();
    const auto* found =
        std::find_if(kTypeNames.begin(), kTypeNames.end(), [&](const TypeName& t) { return t.name == name; });
    if (found == kTypeNames.end()) return Fail(Quote(name), " is no type of a PLY property");
    type = found->type;
    return absl::OkStatus();
  }

  absl::Status ReadProperty() {
    if (header_.elements.empty()) return Fail("a property stands before the first element");
    std::vector<PlyProperty>& properties = header_.elements.back().properties;
    if (properties.size() == kMostProperties) return Fail("an element has more than ", kMostProperties, " properties");
    PlyProperty property;
    if (scanner_.Peek() == "list") {
      scanner_.Token();
      property.is_list = true;
      MESHFRONT_RETURN_IF_ERROR(ReadType(property.count_type));
      if (property.count_type >= PlyType::kFloat) return Fail("a list's count must have an integer type");
    }
    MESHFRONT_RETURN_IF_ERROR(ReadType(property.type));
    property.name = std::string(scanner_.Token());
    if (property.name.empty()) return Fail("a property has no name");
    properties.push_back(std::move(property));
    return absl::OkStatus();
  }

  const Source& source_;
  TextScanner scanner_;
  PlyHeader header_;
};

}  // namespace

int PlyTypeBytes(PlyType type) {
  constexpr std::array<int, 8> kBytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<size_t>(type)];
}

uint64_t PlyElement::LeastBytes(PlyEncoding encoding) const {
  if (encoding == PlyEncoding::kAscii) return 2 * properties.size();  // a digit and a blank each
  uint64_t bytes = 0;
  for (const PlyProperty& p : properties) bytes += PlyTypeBytes(p.is_list ? p.count_type : p.type);
  return bytes;
}

bool PlyElement::HasLists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

int PlyElement::Find(std::string_view property) const {
  for (size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return static_cast<int>(i);
  }
  return -1;
}

absl::StatusOr<PlyHeader> ReadPlyHeader(const Source& source) { return HeaderReader(source).Read(); }

}  // namespace meshfront
