// One pass, a statement a line. A face may name vertices that come later in the file: its indices are checked at the end, against
// the largest one seen, whose line is remembered.
// Rejected: collecting all faces first, for the sake of ear clipping in those; a polygon that comes before its vertices is rare,
// and becomes a fan.
#include "core/io/obj.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "core/base/status_macros.h"
#include "core/io/obj_attributes.h"
#include "core/io/polygon.h"
#include "core/io/text_scanner.h"

namespace meshfront {
namespace {

// What the format defines and a triangle mesh has no place for. The second column goes into dropped_attributes.
constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kLeftOut = {{
    {"l", "lines"},
    {"p", "points"},
    {"curv", "free-form"},
    {"curv2", "free-form"},
    {"surf", "free-form"},
    {"o", ""},
    {"g", ""},
    {"s", ""},
    {"mg", ""},
    {"vp", ""},
    {"end", ""},
}};

class ObjReader {
 public:
  explicit ObjReader(const Source& source) : source_(source), scanner_(source.text(), {'#', true}) {}

  absl::StatusOr<ReadResult> Read() {
    MESHFRONT_RETURN_IF_ERROR(RefuseZeroBytes(source_));
    while (scanner_.SkipToContent()) {
      MESHFRONT_RETURN_IF_ERROR(ReadStatement());
      scanner_.SkipLine();
    }
    if (mesh().positions.empty()) return Refuse(source_, "has no vertex (no line that begins with v)");
    if (largest_.index >= mesh().positions.size()) {
      return RefuseAtLine(source_, largest_.line, "a face names vertex ", largest_.index + 1, "; the file has ",
                          mesh().positions.size(), " vertices");
    }
    FinishNormals();
    FinishAttributes();
    Warn();
    return std::move(result_);
  }

 private:
  struct Largest {
    uint64_t index = 0, line = 0;
  };

  template <class... Parts>
  absl::Status Fail(const Parts&... parts) {
    return RefuseAtLine(source_, scanner_.line(), parts...);
  }
  TriangleMesh& mesh() { return result_.mesh; }

  absl::Status ReadStatement() {
    const std::string_view word = scanner_.Token();
    if (word == "v") return ReadVertex();
    if (word == "f" || word == "fo") return ReadFace();
    if (word == "vn") return ReadNormal();
    if (word == "vt") return ReadTexcoord();
    if (word == "usemtl" || word == "mtllib") return ReadMaterial(word == "usemtl");
    for (const auto& [known, attribute] : kLeftOut) {
      if (word != known) continue;
      if (!attribute.empty()) NoteDropped(mesh(), std::string(attribute));
      return absl::OkStatus();
    }
    const bool is_word =
        std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; });
    if (!is_word || !std::isalpha(static_cast<unsigned char>(word[0]))) {
      return Fail(Quote(word), " is no statement of an OBJ file");
    }
    if (unknown_++ == 0) first_unknown_ = Concat(Quote(word), " in line ", scanner_.line());
    return absl::OkStatus();
  }

  absl::Status ReadTriple(std::string_view what, uint64_t number, Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      if (scanner_.AtLineEnd()) return Fail(what, " ", number, " has ", axis, " numbers; it needs 3");
      if (!scanner_.ReadDouble(v[axis]))
        return Fail(what, " ", number, " has ", Quote(scanner_.Peek()), ", not a number");
    }
    return absl::OkStatus();
  }

  absl::Status ReadVertex() {
    Vec3 v;
    const uint64_t number = mesh().positions.size() + 1;
    MESHFRONT_RETURN_IF_ERROR(ReadTriple("vertex", number, v));
    if (number >= Id<void>::kInvalid) return Fail("vertex ", number, " is one too many; the most is 4294967294");
    mesh().positions.push_back(v);
    int extra = 0;
    for (double ignored = 0; !scanner_.AtLineEnd(); ++extra) {
      if (!scanner_.ReadDouble(ignored))
        return Fail("vertex ", number, " has ", Quote(scanner_.Peek()), ", not a number");
    }
    if (extra >= 3) NoteDropped(mesh(), "color");  // one more number is a weight
    if (extra > 5)
      return Fail("vertex ", number, " has ", extra + 3, " numbers; the most is 8 (with weight and colour)");
    return absl::OkStatus();
  }

  // Kept only while this can be a point set: nothing but normals in step with the vertices, and no faces.
  absl::Status ReadNormal() {
    Vec3 n;
    MESHFRONT_RETURN_IF_ERROR(ReadTriple("normal", ++normals_, n));
    if (mesh().triangles.empty()) mesh().normals.push_back(n);
    attributes_.AddNormal(n);
    return absl::OkStatus();
  }

  absl::Status ReadTexcoord() {
    double t[2] = {0, 0};
    for (double& value : t) {
      if (scanner_.AtLineEnd()) break;
      if (!scanner_.ReadDouble(value)) return Fail("a vt has ", Quote(scanner_.Peek()), ", not a number");
    }
    attributes_.AddTexcoord(t[0], t[1]);
    return absl::OkStatus();
  }

  absl::Status ReadMaterial(bool is_used) {
    const std::string name(scanner_.RestOfLine());
    if (is_used)
      attributes_.UseMaterial(name);
    else if (result_.asset.material_libraries.size() < 64)
      result_.asset.material_libraries.push_back(name);
    return absl::OkStatus();
  }

  absl::Status ReadFace() {
    corners_.clear(), wedges_.clear();
    while (!scanner_.AtLineEnd()) MESHFRONT_RETURN_IF_ERROR(ReadCorner());
    if (corners_.size() < 3)
      ++small_faces_;
    else
      cutter_.Append(corners_, mesh());
    attributes_.AddFace(corners_, wedges_, mesh());
    has_faces_ = true;
    return absl::OkStatus();
  }

  absl::Status ReadCorner() {
    const std::string_view token = scanner_.Peek();
    int64_t value = 0;
    std::string_view rest;
    if (!scanner_.ReadLeadingInt(value)) return Fail("a face has the corner ", Quote(token), ", not a vertex number");
    if (!scanner_.AtTokenEnd()) {
      rest = scanner_.Token();
      if (rest[0] != '/' || rest.find_first_not_of("0123456789-/") != std::string_view::npos) {
        return Fail("a face has the corner ", Quote(token), "; it should be v, v/vt, v//vn or v/vt/vn");
      }
    }
    const int64_t count = static_cast<int64_t>(mesh().positions.size());
    if (value == 0) return Fail("a face names vertex 0; OBJ counts from 1");
    if (value < 0 && -value > count)
      return Fail("a face names vertex ", value, ", but only ", count, " come before it");
    const uint64_t index = value > 0 ? value - 1 : count + value;
    if (index >= Id<void>::kInvalid) return Fail("a face names vertex ", value, "; the most is 4294967294");
    if (index >= largest_.index) largest_ = {index, scanner_.line()};
    corners_.push_back(static_cast<uint32_t>(index));
    wedges_.push_back(attributes_.WedgeOf(rest));
    return absl::OkStatus();
  }

  void FinishNormals() {
    if (!has_faces_ && normals_ == mesh().positions.size()) return;
    mesh().normals = {};
  }

  void FinishAttributes() {
    if (!has_faces_) {
      if (normals_ > 0 && mesh().normals.empty()) NoteDropped(mesh(), "normal");
      return;
    }
    mesh().attributes = attributes_.Take(mesh().triangles.size());
    result_.asset.group_names = attributes_.TakeMaterials();
    if (attributes_.missing() > 0) {
      result_.warnings.push_back(Concat(attributes_.missing(),
                                        " kinds of corners have no texture coordinate or normal where ",
                                        "others have one; theirs are 0"));
    }
  }

  void Warn() {
    if (small_faces_ > 0) {
      result_.warnings.push_back(Concat(small_faces_, " faces of fewer than three corners were skipped"));
    }
    if (unknown_ > 0) {
      result_.warnings.push_back(Concat(unknown_, " lines of unknown kinds were skipped, the first ", first_unknown_));
    }
  }

  const Source& source_;
  TextScanner scanner_;
  ReadResult result_;
  PolygonCutter cutter_;
  std::vector<uint32_t> corners_, wedges_;
  ObjAttributes attributes_;
  Largest largest_;
  bool has_faces_ = false;
  uint64_t normals_ = 0, small_faces_ = 0, unknown_ = 0;
  std::string first_unknown_;
};

}  // namespace

absl::StatusOr<ReadResult> ReadObj(const Source& source) { return ObjReader(source).Read(); }

absl::Status WriteObj(const TriangleMesh& mesh, Output& output) {
  const bool normals = !mesh.normals.empty();
  for (const Vec3& p : mesh.positions) output.Text("v "), output.Triple(p), output.Text("\n");
  for (const Vec3& n : mesh.normals) output.Text("vn "), output.Triple(n), output.Text("\n");
  for (const Triangle& t : mesh.triangles) {
    output.Text("f");
    for (const VertexId v : t) {
      output.Text(" "), output.Number(uint64_t{v.index()} + 1);
      if (normals) output.Text("//"), output.Number(uint64_t{v.index()} + 1);
    }
    output.Text("\n");
  }
  return absl::OkStatus();
}

}  // namespace meshfront
