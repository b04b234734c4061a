#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/cli/commands.h"
#include "client/cli/input.h"
#include "client/cli/picture/canvas.h"
#include "client/cli/picture/view.h"
#include "client/cli/picture/wireframe.h"
#include "client/output_file.h"
#include "core/base/status_macros.h"

namespace meshfront {
namespace {

constexpr Color kPaper{250, 250, 248};
// At the smallest the shape is about a pixel; at the largest a picture spans a millionth of it, a few steps of a float.
constexpr double kSmallestZoom = 1e-3, kLargestZoom = 1e6;

// What the flags ask of the view that the shape would have by itself.
struct Look {
  Format format = Format::kUnknown;
  int size = 800;  // pixels
  double zoom = 1;
  std::optional<Vec3> at;
  std::optional<UpAxis> up;
};

absl::Status WrongValue(absl::string_view flag, absl::string_view value, absl::string_view rule) {
  return absl::InvalidArgumentError(absl::StrCat(flag, " is ", value.empty() ? "empty" : value, "; it must be ", rule));
}

absl::StatusOr<Vec3> ParsePoint(const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, ',');
  std::array<double, 3> x{};
  bool valid = parts.size() == x.size();
  for (size_t i = 0; valid && i < x.size(); ++i) valid = absl::SimpleAtod(parts[i], &x[i]) && std::isfinite(x[i]);
  if (!valid) return WrongValue("--at", text, "three numbers x,y,z");
  return Vec3{x[0], x[1], x[2]};
}

absl::StatusOr<Look> ParseLook(const RenderArguments& arguments) {
  constexpr int smallest = 16, largest = 8192;
  Look look;
  if (arguments.out != "-" && !absl::EndsWithIgnoreCase(arguments.out, ".png")) {
    return WrongValue("OUT", arguments.out, "a file that ends in png");
  }
  MESHFRONT_ASSIGN_OR_RETURN(look.format, FormatFor(arguments.in, arguments.in_format, "--in-format"));
  const MeshingFlags::Text &size = arguments.size, &zoom = arguments.zoom;
  if (size && (!absl::SimpleAtoi(*size, &look.size) || look.size < smallest || look.size > largest)) {
    return WrongValue("--size", *size, "a whole number of pixels from 16 to 8192");
  }
  if (zoom && (!absl::SimpleAtod(*zoom, &look.zoom) || !(look.zoom >= kSmallestZoom && look.zoom <= kLargestZoom))) {
    return WrongValue("--zoom", *zoom, "a number from 0.001 to 1000000");
  }
  if (arguments.view_of == "-") return WrongValue("--view-of", "-", "a file: standard input is for IN alone");
  if (arguments.up && *arguments.up != "y" && *arguments.up != "z") return WrongValue("--up", *arguments.up, "y or z");
  if (arguments.up) look.up = *arguments.up == "z" ? UpAxis::kZ : UpAxis::kY;
  if (arguments.at) {
    MESHFRONT_ASSIGN_OR_RETURN(look.at, ParsePoint(*arguments.at));
  }
  return look;
}

// What is seen, and from where; the mesh that gives the view is not kept.
struct Scene {
  TriangleMesh mesh;
  View view;
};

absl::StatusOr<Scene> ReadScene(const RenderArguments& arguments, const Look& look) {
  Scene scene;
  std::vector<std::string> warnings;
  if (!arguments.view_of.empty()) {
    MESHFRONT_ASSIGN_OR_RETURN(ReadResult seen, ReadInput(arguments.view_of, Format::kUnknown));
    scene.view = ChooseView(seen.mesh, look.up);
    warnings = std::move(seen.warnings);
  }
  MESHFRONT_ASSIGN_OR_RETURN(ReadResult read, ReadInput(arguments.in, look.format));
  PrintWarnings(warnings);
  PrintWarnings(read.warnings);
  scene.mesh = std::move(read.mesh);
  if (arguments.view_of.empty()) scene.view = ChooseView(scene.mesh, look.up);
  if (look.at) scene.view.center = *look.at;
  scene.view.half_extent /= look.zoom;
  return scene;
}

absl::Status Draw(const Scene& scene, int size, const std::string& out) {
  Canvas canvas(size, size, kPaper);
  DrawWireframe(scene.mesh, scene.view, {0, 0, size, size}, canvas);
  std::string png;
  MESHFRONT_RETURN_IF_ERROR(canvas.EncodePng(&png));
  return WriteWholeFile(out, png);
}

}  // namespace

ExitCode RunRender(const RenderArguments& arguments) {
  const absl::StatusOr<Look> look = ParseLook(arguments);
  if (!look.ok()) return Fail(ExitCode::kUsage, look.status());
  const absl::Status creatable = CheckCanBeCreated(arguments.out);
  if (!creatable.ok()) return Fail(ExitCode::kOutput, creatable);
  const absl::StatusOr<Scene> scene = ReadScene(arguments, *look);
  if (!scene.ok()) return Fail(ExitCodeOfRead(scene.status()), scene.status());
  const absl::Status drawn = Draw(*scene, look->size, arguments.out);
  return drawn.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, drawn);
}

}  // namespace meshfront
