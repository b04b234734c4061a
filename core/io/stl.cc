#include "core/io/stl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "absl/strings/match.h"
#include "core/base/status_macros.h"
#include "core/io/text_scanner.h"
#include "core/io/weld.h"

namespace meshfront {
namespace {

constexpr size_t kHeaderBytes = 84;    // 80 of text, 4 of count
constexpr size_t kTriangleBytes = 50;  // normal, three corners, two attribute bytes

bool IsWord(std::string_view token, absl::string_view word) {
  return absl::EqualsIgnoreCase(absl::string_view(token.data(), token.size()), word);
}

uint32_t HeaderCount(const Source& source) {
  uint32_t count = 0;
  std::memcpy(&count, source.bytes.data() + 80, sizeof(count));
  return count;
}

bool HasBinarySize(const Source& source) {
  return source.bytes.size() >= kHeaderBytes &&
         source.bytes.size() == kHeaderBytes + kTriangleBytes * uint64_t{HeaderCount(source)};
}

// "solid" first, and the second line begins with a word of the format.
bool IsAscii(const Source& source) {
  TextScanner scanner(source.text().substr(0, 64 << 10), {'\0', false});
  if (!scanner.SkipToContent() || !IsWord(scanner.Token(), "solid")) return false;
  scanner.SkipLine();
  if (!scanner.SkipToContent()) return false;
  const std::string_view word = scanner.Peek();
  return IsWord(word, "facet") || IsWord(word, "endsolid") || IsWord(word, "color");
}

Vec3 CornerAt(const uint8_t* bytes) {
  std::array<float, 3> f;
  std::memcpy(f.data(), bytes, sizeof(f));
  return {f[0], f[1], f[2]};
}

absl::StatusOr<ReadResult> ReadBinary(const Source& source) {
  const size_t size = source.bytes.size();
  if (size < kHeaderBytes) {
    return Refuse(source, "is neither ascii STL nor long enough for a binary one: ", size,
                  " bytes, the header alone has 84");
  }
  const uint64_t promised = HeaderCount(source), present = (size - kHeaderBytes) / kTriangleBytes;
  const uint64_t rest = (size - kHeaderBytes) % kTriangleBytes;
  if (promised > present) {
    return Refuse(source, "byte 80: the header says ", promised, " triangles, but the file ends after ", present,
                  " (binary STL has 50 bytes a triangle)");
  }
  ReadResult result;
  // Whole triangles to the last byte are taken for triangles, whatever the header says; anything else is something else.
  const uint64_t count = rest == 0 ? present : promised;
  if (count == 0) return Refuse(source, "byte 80: the header says 0 triangles; there is nothing to read");
  if (promised < count) {
    result.warnings.push_back(
        Concat("the header says ", promised, " triangles, the file has ", count, "; all were read"));
  } else if (rest != 0) {
    result.warnings.push_back(
        Concat(size - kHeaderBytes - count * kTriangleBytes, " bytes after the last triangle were not read"));
  }
  TriangleMesh& mesh = result.mesh;
  mesh.triangles.reserve(count);
  mesh.positions.reserve(count / 2 + 3);
  Welder welder(mesh.positions);
  const uint8_t* at = source.bytes.data() + kHeaderBytes;
  for (uint64_t i = 0; i < count; ++i, at += kTriangleBytes) {
    Triangle t;
    for (int corner = 0; corner < 3; ++corner) t[corner] = welder.Add(CornerAt(at + 12 * (corner + 1)));
    mesh.triangles.push_back(t);
  }
  return result;
}

// facet … outer loop, three vertex lines, endloop, endfacet: the corners of the open facet are counted, the words checked.
class AsciiReader {
 public:
  explicit AsciiReader(const Source& source)
      : source_(source), scanner_(source.text(), {'\0', false}), welder_(result_.mesh.positions) {}

  absl::StatusOr<ReadResult> Read() {
    while (scanner_.SkipToContent()) {
      MESHFRONT_RETURN_IF_ERROR(ReadLine());
      scanner_.SkipLine();
    }
    if (in_solid_) return Fail("the file ends without endsolid, after ", result_.mesh.triangles.size(), " triangles");
    if (result_.mesh.triangles.empty()) return Refuse(source_, "has no triangles");
    return std::move(result_);
  }

 private:
  template <class... Parts>
  absl::Status Fail(const Parts&... parts) {
    return RefuseAtLine(source_, scanner_.line(), parts...);
  }

  absl::Status ReadLine() {
    const std::string_view word = scanner_.Token();
    if (IsWord(word, "vertex")) return ReadVertex();
    if (IsWord(word, "facet")) return in_solid_ && !in_facet_ ? Begin() : Fail("facet stands where it can't begin");
    if (IsWord(word, "endfacet")) return End();
    if (IsWord(word, "outer") || IsWord(word, "endloop"))
      return in_facet_ ? absl::OkStatus() : Fail(word, " outside of a facet");
    if (IsWord(word, "solid")) return Open();
    if (IsWord(word, "endsolid")) return Close();
    if (IsWord(word, "color")) return absl::OkStatus();
    return Fail(Quote(word), " is no word of an ascii STL file");
  }

  absl::Status Open() {
    if (in_solid_) return Fail("a solid begins inside another");
    in_solid_ = true;
    return absl::OkStatus();
  }
  absl::Status Close() {
    if (!in_solid_ || in_facet_) return Fail("endsolid stands where no solid can end");
    in_solid_ = false;
    return absl::OkStatus();
  }
  absl::Status Begin() {
    in_facet_ = true, corners_ = 0;
    return absl::OkStatus();
  }
  absl::Status End() {
    if (!in_facet_ || corners_ != 3) return Fail("a facet ends after ", corners_, " vertices; it needs 3");
    result_.mesh.triangles.push_back(triangle_);
    in_facet_ = false;
    return absl::OkStatus();
  }

  absl::Status ReadVertex() {
    Vec3 v;
    if (!in_facet_ || corners_ == 3) return Fail("a vertex stands outside of a facet, or is its fourth");
    for (int axis = 0; axis < 3; ++axis) {
      if (!scanner_.ReadDouble(v[axis])) return Fail("a vertex has ", Quote(scanner_.Peek()), ", not a number");
    }
    if (!scanner_.AtLineEnd()) return Fail("a vertex is followed by ", Quote(scanner_.Peek()));
    triangle_[corners_++] = welder_.Add(v);
    return absl::OkStatus();
  }

  const Source& source_;
  TextScanner scanner_;
  ReadResult result_;
  Welder welder_;
  Triangle triangle_;
  int corners_ = 0;
  bool in_solid_ = false, in_facet_ = false;
};

}  // namespace

bool IsStl(const Source& source) { return HasBinarySize(source) || IsAscii(source); }

absl::StatusOr<ReadResult> ReadStl(const Source& source) {
  if (!HasBinarySize(source) && IsAscii(source)) return AsciiReader(source).Read();
  return ReadBinary(source);
}

absl::Status WriteStl(const TriangleMesh& mesh, Output& output) {
  if (mesh.IsPointSet())
    return absl::InvalidArgumentError("STL holds triangles only; a point set can't be written to it");
  if (mesh.triangles.size() > std::numeric_limits<uint32_t>::max()) {
    return absl::InvalidArgumentError(
        Concat("STL counts 4294967295 triangles at most; the mesh has ", mesh.triangles.size()));
  }
  std::array<char, 80> header = {};
  std::memcpy(header.data(), "Meshfront", 9);
  output.Raw(header);
  output.Raw(static_cast<uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.PositionAt(t[0]), b = mesh.PositionAt(t[1]), c = mesh.PositionAt(t[2]);
    const Vec3 normal = Normalized(Cross(b - a, c - a));
    for (const Vec3& v : {IsFinite(normal) ? normal : Vec3{}, a, b, c}) {
      for (int axis = 0; axis < 3; ++axis) {
        if (std::isfinite(v[axis]) && std::fabs(v[axis]) > std::numeric_limits<float>::max()) {
          return absl::InvalidArgumentError(
              Concat("STL has 32-bit floats; the coordinate ", v[axis], " is beyond them"));
        }
        output.Raw(static_cast<float>(v[axis]));
      }
    }
    output.Raw(uint16_t{0});
  }
  return absl::OkStatus();
}

}  // namespace meshfront
