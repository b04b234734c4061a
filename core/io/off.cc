// 1. ReadHeader: the word with its prefixes, the counts, both checked against the bytes that follow.
// 2. ReadVertices: three numbers each (normal next when N stands in the word); what else stands on the line is a colour or a
//    texture coordinate and must be numbers.
// 3. ReadFaces: corner count, corners, perhaps a colour.
#include "core/io/off.h"

#include <algorithm>

#include "core/base/status_macros.h"
#include "core/io/polygon.h"
#include "core/io/text_scanner.h"

namespace meshfront {
namespace {

struct Header {
  bool texture = false, colour = false, normal = false, four = false, n_dimensional = false;
  uint64_t vertices = 0, faces = 0;
};

// Takes "STCN4nOFF" apart; false when the word is another.
bool ParseWord(std::string_view word, Header& header) {
  auto take = [&](std::string_view prefix) {
    if (word.substr(0, prefix.size()) != prefix) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  header.texture = take("ST");
  header.colour = take("C");
  header.normal = take("N");
  header.four = take("4");
  header.n_dimensional = take("n");
  return word == "OFF";
}

class OffReader {
 public:
  explicit OffReader(const Source& source) : source_(source), scanner_(source.text()) {}

  absl::StatusOr<ReadResult> Read() {
    MESHFRONT_RETURN_IF_ERROR(ReadHeader());
    MESHFRONT_RETURN_IF_ERROR(ReadVertices());
    MESHFRONT_RETURN_IF_ERROR(ReadFaces());
    if (small_faces_ > 0) {
      result_.warnings.push_back(Concat(small_faces_, " faces of fewer than three corners were skipped"));
    }
    if (scanner_.SkipToContent()) {
      result_.warnings.push_back(
          Concat("line ", scanner_.line(), ": text after the last of the ", header_.faces, " faces was not read"));
    }
    return std::move(result_);
  }

 private:
  template <class... Parts>
  absl::Status Fail(const Parts&... parts) {
    return RefuseAtLine(source_, scanner_.line(), parts...);
  }
  absl::Status Ends(std::string_view what, uint64_t at, uint64_t count) {
    return Fail("the file ends at ", what, " ", at, " of the ", count, " its header promises");
  }

  absl::Status ReadHeader() {
    if (!scanner_.SkipToContent()) return Refuse(source_, "holds nothing but blanks and comments");
    if (ParseWord(scanner_.Peek(), header_)) {
      const std::string_view word = scanner_.Token();
      if (header_.n_dimensional || header_.four) {
        return Fail(Quote(word), " has coordinates of another dimension; only three are read");
      }
      if (scanner_.Peek() == "BINARY") return Fail("binary OFF is not read; write it as text, or as binary PLY");
    }
    MESHFRONT_RETURN_IF_ERROR(RefuseZeroBytes(source_));
    MESHFRONT_RETURN_IF_ERROR(ReadCount("vertices", 6, header_.vertices));  // "0 0 0\n"
    MESHFRONT_RETURN_IF_ERROR(ReadCount("faces", 2, header_.faces));        // "0\n"
    int64_t edges = 0;
    if (!scanner_.AtLineEnd() && !scanner_.ReadInt(edges)) {
      return Fail("the number of edges is ", Quote(scanner_.Peek()), ", not an integer");
    }
    if (!scanner_.AtLineEnd()) return Fail("the counts are followed by ", Quote(scanner_.Peek()));
    if (header_.vertices == 0) return Fail("the header says 0 vertices; there is nothing to read");
    if (header_.texture) NoteDropped(result_.mesh, "texcoord_0");
    if (header_.colour) NoteDropped(result_.mesh, "color");
    if (header_.normal && header_.faces > 0) NoteDropped(result_.mesh, "normal");
    return absl::OkStatus();
  }

  // An element takes at least `least_bytes` (the last line may lack its end).
  absl::Status ReadCount(std::string_view what, uint64_t least_bytes, uint64_t& count) {
    int64_t value = 0;
    if (!scanner_.SkipToContent()) return Fail("the file ends before the number of ", what);
    if (!scanner_.ReadInt(value)) {
      return Fail("the number of ", what, " is ", Quote(scanner_.Peek()), ", not an integer of 64 bits");
    }
    if (value < 0) return Fail("the number of ", what, " is ", value, "; it can't be negative");
    count = static_cast<uint64_t>(value);
    if (count > (scanner_.remaining() + 1) / least_bytes) {
      return Fail("the header says ", count, " ", what, ", but only ", scanner_.remaining(), " bytes follow");
    }
    if (count >= Id<void>::kInvalid) return Fail("the header says ", count, " ", what, "; the most is 4294967294");
    return absl::OkStatus();
  }

  absl::Status ReadNumbers(std::string_view what, uint64_t at, Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      if (scanner_.ReadDouble(v[axis])) continue;
      if (!scanner_.SkipToContent()) return Ends(what, at, header_.vertices);
      if (!scanner_.ReadDouble(v[axis])) return Fail(what, " ", at, " has ", Quote(scanner_.Peek()), ", not a number");
    }
    return absl::OkStatus();
  }

  // Colours and texture coordinates are passed over, but must be numbers.
  absl::Status PassRestOfLine(std::string_view what, uint64_t at) {
    double ignored = 0;
    while (!scanner_.AtLineEnd()) {
      if (!scanner_.ReadDouble(ignored)) return Fail(what, " ", at, " has ", Quote(scanner_.Peek()), ", not a number");
    }
    return absl::OkStatus();
  }

  absl::Status ReadVertices() {
    TriangleMesh& mesh = result_.mesh;
    const bool keep_normals = header_.normal && header_.faces == 0;
    mesh.positions.reserve(header_.vertices);
    if (keep_normals) mesh.normals.reserve(header_.vertices);
    for (uint64_t i = 0; i < header_.vertices; ++i) {
      Vec3 v;
      MESHFRONT_RETURN_IF_ERROR(ReadNumbers("vertex", i, v));
      mesh.positions.push_back(v);
      if (header_.normal) MESHFRONT_RETURN_IF_ERROR(ReadNumbers("the normal of vertex", i, v));
      if (keep_normals) mesh.normals.push_back(v);
      if (scanner_.AtLineEnd()) continue;
      NoteDropped(mesh, header_.texture && !header_.colour ? "texcoord_0" : "color");
      MESHFRONT_RETURN_IF_ERROR(PassRestOfLine("vertex", i));
    }
    return absl::OkStatus();
  }

  absl::Status ReadCorner(uint64_t face, uint32_t& corner) {
    int64_t value = 0;
    if (!scanner_.ReadInt(value)) {
      if (!scanner_.SkipToContent()) return Ends("face", face, header_.faces);
      if (!scanner_.ReadInt(value)) return Fail("face ", face, " has ", Quote(scanner_.Peek()), ", not an integer");
    }
    if (value < 0 || static_cast<uint64_t>(value) >= header_.vertices) {
      return Fail("face ", face, " names vertex ", value, "; the vertices are 0 to ", header_.vertices - 1);
    }
    corner = static_cast<uint32_t>(value);
    return absl::OkStatus();
  }

  absl::Status ReadFaces() {
    result_.mesh.triangles.reserve(std::min<uint64_t>(header_.faces, scanner_.remaining() / 8 + 1));
    PolygonCutter cutter;
    std::vector<uint32_t> corners;
    for (uint64_t face = 0; face < header_.faces; ++face) {
      int64_t count = 0;
      if (!scanner_.SkipToContent()) return Ends("face", face, header_.faces);
      if (!scanner_.ReadInt(count)) {
        return Fail("face ", face, " begins with ", Quote(scanner_.Peek()), ", not with its number of corners");
      }
      if (count < 0 || static_cast<uint64_t>(count) > scanner_.remaining() / 2) {
        return Fail("face ", face, " says ", count, " corners, but only ", scanner_.remaining(), " bytes follow");
      }
      corners.resize(count);
      for (uint32_t& corner : corners) MESHFRONT_RETURN_IF_ERROR(ReadCorner(face, corner));
      if (!scanner_.AtLineEnd()) {
        NoteDropped(result_.mesh, "face color");
        MESHFRONT_RETURN_IF_ERROR(PassRestOfLine("face", face));
      }
      if (count < 3)
        ++small_faces_;
      else
        cutter.Append(corners, result_.mesh);
    }
    return absl::OkStatus();
  }

  const Source& source_;
  TextScanner scanner_;
  Header header_;
  ReadResult result_;
  uint64_t small_faces_ = 0;
};

}  // namespace

bool IsOff(const Source& source) {
  TextScanner scanner(source.text().substr(0, 64 << 10));  // comments may come first
  Header header;
  return scanner.SkipToContent() && ParseWord(scanner.Peek(), header);
}

absl::StatusOr<ReadResult> ReadOff(const Source& source) { return OffReader(source).Read(); }

absl::Status WriteOff(const TriangleMesh& mesh, Output& output) {
  const bool normals = !mesh.normals.empty();
  output.Text(normals ? "NOFF\n" : "OFF\n");
  output.Number(uint64_t{mesh.positions.size()}), output.Text(" ");
  output.Number(uint64_t{mesh.triangles.size()}), output.Text(" 0\n");
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    output.Triple(mesh.positions[i]);
    if (normals) output.Text(" "), output.Triple(mesh.normals[i]);
    output.Text("\n");
  }
  for (const Triangle& t : mesh.triangles) {
    output.Text("3");
    for (const VertexId v : t) output.Text(" "), output.Number(uint64_t{v.index()});
    output.Text("\n");
  }
  return absl::OkStatus();
}

}  // namespace meshfront
