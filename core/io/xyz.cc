#include "core/io/xyz.h"

#include <array>
#include <cmath>

#include "core/base/status_macros.h"
#include "core/io/text_scanner.h"

namespace meshfront {
namespace {

constexpr int kMostColumns = 7;

// The second triple of most lines has about the length of a direction. Zeros and NaN say nothing.
bool LookLikeNormals(const std::vector<Vec3>& normals) {
  uint64_t like = 0, unlike = 0;
  for (const Vec3& n : normals) {
    const double length = Norm(n);
    if (!(length > 0) || !std::isfinite(length)) continue;
    ++(length > 0.5 && length < 2 ? like : unlike);
  }
  return like >= unlike;
}

class XyzReader {
 public:
  explicit XyzReader(const Source& source) : source_(source), scanner_(source.text()) {}

  absl::StatusOr<ReadResult> Read() {
    MESHFRONT_RETURN_IF_ERROR(RefuseZeroBytes(source_));
    for (bool first = true; SkipToContent(); first = false) {
      MESHFRONT_RETURN_IF_ERROR(ReadLine());
      const bool is_count = first && found_ == 1;
      MESHFRONT_RETURN_IF_ERROR(is_count ? TakeCount() : TakePoint());
    }
    const uint64_t points = result_.mesh.positions.size();
    if (points == 0) return Refuse(source_, "has no points");
    if (promised_ >= 0 && points != static_cast<uint64_t>(promised_)) {
      return Refuse(source_, "the first line promises ", promised_, " points, but there are ", points);
    }
    if (!LookLikeNormals(result_.mesh.normals)) {
      result_.mesh.normals = {};
      NoteDropped(result_.mesh, "color");
      result_.warnings.push_back("columns 4 to 6 are no directions and were left out");
    }
    return std::move(result_);
  }

 private:
  template <class... Parts>
  absl::Status Fail(const Parts&... parts) {
    return RefuseAtLine(source_, scanner_.line(), parts...);
  }

  bool SkipToContent() {
    while (scanner_.SkipToContent()) {
      if (scanner_.Peek().substr(0, 2) != "//") return true;
      scanner_.SkipLine();
    }
    return false;
  }

  absl::Status ReadLine() {
    for (found_ = 0; !scanner_.AtLineEnd(); ++found_) {
      if (found_ == kMostColumns) return Fail("has more than ", kMostColumns, " numbers");
      if (!scanner_.ReadDouble(numbers_[found_])) return Fail(Quote(scanner_.Peek()), " is not a number");
    }
    return absl::OkStatus();
  }

  absl::Status TakeCount() {
    const double count = numbers_[0];
    if (!(count >= 0 && count <= 1e15) || count != std::floor(count)) {
      return Fail("one number alone must be the number of points, an integer that is not negative");
    }
    promised_ = static_cast<int64_t>(count);
    return absl::OkStatus();
  }

  absl::Status TakePoint() {
    if (columns_ == 0) columns_ = found_;
    if (columns_ != 3 && columns_ != 4 && columns_ != 6 && columns_ != 7) {
      return Fail("has ", found_, " numbers; a point has 3, or 6 with its normal (4 or 7 in PTS)");
    }
    if (found_ != columns_) return Fail("has ", found_, " numbers; the lines before it have ", columns_);
    TriangleMesh& mesh = result_.mesh;
    if (mesh.positions.size() + 1 >= Id<void>::kInvalid) return Fail("is one point too many; the most is 4294967294");
    mesh.positions.push_back({numbers_[0], numbers_[1], numbers_[2]});
    if (columns_ == 6) mesh.normals.push_back({numbers_[3], numbers_[4], numbers_[5]});
    if (columns_ == 4 || columns_ == 7) NoteDropped(mesh, "intensity");
    if (columns_ == 7) NoteDropped(mesh, "color");
    return absl::OkStatus();
  }

  const Source& source_;
  TextScanner scanner_;
  ReadResult result_;
  std::array<double, kMostColumns> numbers_ = {};
  int found_ = 0, columns_ = 0;
  int64_t promised_ = -1;
};

}  // namespace

absl::StatusOr<ReadResult> ReadXyz(const Source& source) { return XyzReader(source).Read(); }

absl::Status WriteXyz(const TriangleMesh& mesh, Output& output) {
  if (!mesh.IsPointSet()) {
    return absl::InvalidArgumentError(
        Concat("XYZ holds points only; the mesh has ", mesh.triangles.size(), " triangles"));
  }
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    output.Triple(mesh.positions[i]);
    if (!mesh.normals.empty()) output.Text(" "), output.Triple(mesh.normals[i]);
    output.Text("\n");
  }
  return absl::OkStatus();
}

}  // namespace meshfront
