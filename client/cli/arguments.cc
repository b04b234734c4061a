#include "client/cli/arguments.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "absl/types/span.h"
#include "core/base/status_macros.h"
#include "core/remesh.h"
#include "proto/wire/host_port.h"

namespace meshfront {
namespace {

using Text = MeshingFlags::Text;

absl::Status WrongValue(absl::string_view flag, absl::string_view value, absl::string_view rule) {
  return absl::InvalidArgumentError(absl::StrCat(flag, " is ", value.empty() ? "empty" : value, "; it must be ", rule));
}

absl::Status NotYet(absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat(what, " is not yet built"));
}

absl::Status Contradiction(absl::string_view a, absl::string_view b) {
  return absl::InvalidArgumentError(absl::StrCat(a, " and ", b, " contradict each other; give one of them"));
}

// A finite number inside (low, high), or including an end where it is said to.
struct Range {
  double low, high;
  bool low_included, high_included;
  const char* rule;
  bool Contains(double x) const {
    return std::isfinite(x) && (low_included ? x >= low : x > low) && (high_included ? x <= high : x < high);
  }
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Range kRho{0, 2 * std::numbers::pi / 3, false, true, "a number in (0, 2π/3]"};
constexpr Range kEta{1, 2, false, false, "a number in (1, 2)"};
constexpr Range kPositive{0, kInfinity, false, false, "a positive, finite number"};
constexpr Range kBlend{0, 1000, true, true, "a number in [0, 1000]"};
constexpr Range kMlsRadius{2, 16, true, true, "a number in [2, 16]"};
constexpr Range kCreaseAngle{0, 180, false, false, "off or a number of degrees in (0, 180)"};

absl::StatusOr<double> ParseNumber(absl::string_view flag, absl::string_view text, const Range& range) {
  double value;
  if (!absl::SimpleAtod(text, &value) || !range.Contains(value)) return WrongValue(flag, text, range.rule);
  return value;
}

absl::Status CheckNumber(absl::string_view flag, const Text& text, const Range& range) {
  return text ? ParseNumber(flag, *text, range).status() : absl::OkStatus();
}

// "0.3", or "2%" of the diagonal.
absl::StatusOr<v1::Length> ParseLength(absl::string_view flag, absl::string_view text) {
  static constexpr Range range{0, kInfinity, false, false,
                               "a positive, finite length, or a percentage of the diagonal such as 2%"};
  absl::string_view digits = text;
  const bool relative = absl::ConsumeSuffix(&digits, "%");
  double value;
  if (!absl::SimpleAtod(digits, &value) || !range.Contains(value)) return WrongValue(flag, text, range.rule);
  v1::Length length;
  if (relative)
    length.set_diagonal_fraction(value / 100);
  else
    length.set_absolute(value);
  return length;
}

// Of triangles: a tetrahedron has four.
absl::StatusOr<uint64_t> ParseCount(absl::string_view flag, absl::string_view text) {
  constexpr uint64_t least = 4;
  uint64_t count;
  if (!absl::SimpleAtoi(text, &count) || count < least) return WrongValue(flag, text, "a whole number, at least 4");
  return count;
}

absl::StatusOr<bool> ParseSwitch(absl::string_view flag, absl::string_view text) {
  if (text == "on" || text == "off") return text == "on";
  return WrongValue(flag, text, "on or off");
}

absl::StatusOr<v1::Sizing> ParseSizing(const MeshingFlags& flags) {
  if (!flags.sizing) {
    if (flags.max_error) return v1::SIZING_ERROR;
    return flags.edge_length ? v1::SIZING_UNIFORM : v1::SIZING_ANGLE;
  }
  if (*flags.sizing == "angle") return v1::SIZING_ANGLE;
  if (*flags.sizing == "error") return v1::SIZING_ERROR;
  if (*flags.sizing == "uniform") return v1::SIZING_UNIFORM;
  if (*flags.sizing == "thickness") return v1::SIZING_THICKNESS;
  return WrongValue("--sizing", *flags.sizing, "angle, error, uniform or thickness");
}

// Values alone, also of flags that do nothing yet: a mistake is told before an absence.
absl::Status CheckValues(const MeshingFlags& flags) {
  MESHFRONT_RETURN_IF_ERROR(CheckNumber("--rho", flags.rho, kRho));
  MESHFRONT_RETURN_IF_ERROR(CheckNumber("--eta", flags.eta, kEta));
  MESHFRONT_RETURN_IF_ERROR(CheckNumber("--blend", flags.blend, kBlend));
  MESHFRONT_RETURN_IF_ERROR(CheckNumber("--mls-radius", flags.mls_radius, kMlsRadius));
  for (const auto& [name, length] : {std::pair{"--max-error", &flags.max_error},
                                     {"--edge-length", &flags.edge_length},
                                     {"--min-edge", &flags.min_edge},
                                     {"--max-edge", &flags.max_edge},
                                     {"--fill-gaps", &flags.fill_gaps}}) {
    if (*length) MESHFRONT_RETURN_IF_ERROR(ParseLength(name, **length).status());
  }
  if (flags.target_triangles) {
    MESHFRONT_RETURN_IF_ERROR(ParseCount("--target-triangles", *flags.target_triangles).status());
  }
  if (flags.crease_angle && *flags.crease_angle != "off") {
    MESHFRONT_RETURN_IF_ERROR(CheckNumber("--crease-angle", flags.crease_angle, kCreaseAngle));
  }
  if (flags.attributes && *flags.attributes != "keep" && *flags.attributes != "drop") {
    return WrongValue("--attributes", *flags.attributes, "keep or drop");
  }
  const Text& s = flags.surface;
  if (s && *s != "auto" && *s != "mesh" && *s != "mls" && *s != "imls") {
    return WrongValue("--surface", *s, "auto, mesh, mls or imls");
  }
  return absl::OkStatus();
}

constexpr char kFacesPrefix[] = "faces:";

absl::StatusOr<std::vector<double>> ParseNumbers(absl::string_view spec, absl::string_view list, size_t count,
                                                 absl::string_view rule) {
  std::vector<double> numbers;
  for (const absl::string_view text : absl::StrSplit(list, ',')) {
    double value;
    if (!absl::SimpleAtod(text, &value) || !std::isfinite(value)) return WrongValue("--region", spec, rule);
    numbers.push_back(value);
  }
  if (numbers.size() != count) return WrongValue("--region", spec, rule);
  return numbers;
}

void SetPoint(absl::Span<const double> coordinates, v1::Point* point) {
  point->set_x(coordinates[0]), point->set_y(coordinates[1]), point->set_z(coordinates[2]);
}

absl::Status ParseSphere(absl::string_view spec, absl::string_view list, v1::Region* region) {
  constexpr absl::string_view rule = "sphere:x,y,z,r with four finite numbers, the radius r positive";
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<double> n, ParseNumbers(spec, list, 4, rule));
  if (n[3] <= 0) return WrongValue("--region", spec, rule);
  SetPoint(absl::MakeConstSpan(n).first(3), region->mutable_sphere()->mutable_center());
  region->mutable_sphere()->set_radius(n[3]);
  return absl::OkStatus();
}

absl::Status ParseBox(absl::string_view spec, absl::string_view list, v1::Region* region) {
  constexpr absl::string_view rule =
      "box:x0,y0,z0,x1,y1,z1 with six finite numbers, none of the first three above its twin";
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<double> n, ParseNumbers(spec, list, 6, rule));
  if (n[0] > n[3] || n[1] > n[4] || n[2] > n[5]) return WrongValue("--region", spec, rule);
  SetPoint(absl::MakeConstSpan(n).first(3), region->mutable_box()->mutable_min());
  SetPoint(absl::MakeConstSpan(n).last(3), region->mutable_box()->mutable_max());
  return absl::OkStatus();
}

// Faces are read later, and counted then.
absl::Status FillRegion(const MeshingFlags& flags, v1::RemeshOptions* options) {
  if (flags.blend && !flags.region)
    return absl::InvalidArgumentError("--blend needs --region: it is the width of its border");
  if (flags.blend) {
    MESHFRONT_ASSIGN_OR_RETURN(const double blend, ParseNumber("--blend", *flags.blend, kBlend));
    options->set_blend(blend);
  }
  if (!flags.region) return absl::OkStatus();
  absl::string_view list = *flags.region;
  if (absl::ConsumePrefix(&list, "sphere:")) return ParseSphere(*flags.region, list, options->mutable_region());
  if (absl::ConsumePrefix(&list, "box:")) return ParseBox(*flags.region, list, options->mutable_region());
  if (absl::ConsumePrefix(&list, kFacesPrefix) && !list.empty()) return absl::OkStatus();
  return WrongValue("--region", *flags.region, "sphere:x,y,z,r or box:x0,y0,z0,x1,y1,z1 or faces:FILE");
}

// --lod goes with none of what else sizes or chooses.
absl::Status FillLevels(const MeshingFlags& flags, v1::RemeshOptions* options) {
  if (!flags.lod) return absl::OkStatus();
  if (flags.region) return Contradiction("--lod", "--region");
  const std::vector<absl::string_view> texts = absl::StrSplit(*flags.lod, ',');
  double last = 0;
  for (const absl::string_view text : texts) {
    MESHFRONT_ASSIGN_OR_RETURN(const double rho, ParseNumber("--lod", text, kRho));
    if (rho <= last) return WrongValue("--lod", *flags.lod, "a list of growing values of rho, such as 0.3,0.8,1.5");
    options->add_lod_rhos(last = rho);
  }
  if (texts.size() <= kMaxLevels) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--lod has ", texts.size(), " values; it must have at most ", kMaxLevels));
}

absl::Status CheckSizingFlags(const MeshingFlags& flags, v1::Sizing sizing) {
  const std::vector<std::pair<const char*, const Text*>> exclusive = {{"--rho", &flags.rho},
                                                                      {"--lod", &flags.lod},
                                                                      {"--max-error", &flags.max_error},
                                                                      {"--edge-length", &flags.edge_length},
                                                                      {"--target-triangles", &flags.target_triangles}};
  const char* first = nullptr;
  for (const auto& [name, text] : exclusive) {
    if (!*text) continue;
    if (first != nullptr) return Contradiction(first, name);
    first = name;
  }
  const std::string given = absl::StrCat("--sizing ", flags.sizing.value_or("angle"));
  if (flags.rho && sizing != v1::SIZING_ANGLE && sizing != v1::SIZING_THICKNESS) return Contradiction("--rho", given);
  if (flags.lod && sizing != v1::SIZING_ANGLE && sizing != v1::SIZING_THICKNESS) return Contradiction("--lod", given);
  if (flags.max_error && sizing != v1::SIZING_ERROR) return Contradiction("--max-error", given);
  if (flags.edge_length && sizing != v1::SIZING_UNIFORM) return Contradiction("--edge-length", given);
  if (sizing == v1::SIZING_UNIFORM && !flags.edge_length && !flags.target_triangles) {
    return absl::InvalidArgumentError("--sizing uniform needs a length: give --edge-length or --target-triangles too");
  }
  return absl::OkStatus();
}

absl::Status CheckBuilt(const MeshingFlags& flags) {
  if (flags.fill_gaps && flags.region) return Contradiction("--fill-gaps", "--region");
  if (!flags.seed_points.empty()) return NotYet("--seed-point");
  if (flags.region && (flags.surface == "mls" || flags.surface == "imls"))
    return NotYet(absl::StrCat("--region with --surface ", *flags.surface));
  return absl::OkStatus();
}

absl::Status CheckEdgeRange(const v1::RemeshOptions& options) {
  if (!options.has_min_edge() || !options.has_max_edge()) return absl::OkStatus();
  const v1::Length &low = options.min_edge(), &high = options.max_edge();
  const bool comparable = low.value_case() == high.value_case();
  if (!comparable || low.absolute() + low.diagonal_fraction() <= high.absolute() + high.diagonal_fraction())
    return absl::OkStatus();
  return absl::InvalidArgumentError("--min-edge is larger than --max-edge; it must not be");
}

absl::Status FillSwitches(const MeshingFlags& flags, v1::RemeshOptions* options) {
  using Setter = void (v1::RemeshOptions::*)(bool);
  struct Switch {
    const char* name;
    const Text& text;
    Setter set;
  };
  const Switch switches[] = {{"--flips", flags.flips, &v1::RemeshOptions::set_flips},
                             {"--smooth", flags.smooth, &v1::RemeshOptions::set_smooth},
                             {"--fit", flags.fit, &v1::RemeshOptions::set_fit},
                             {"--repair", flags.repair, &v1::RemeshOptions::set_repair}};
  for (const Switch& s : switches) {
    if (!s.text) continue;
    MESHFRONT_ASSIGN_OR_RETURN(const bool on, ParseSwitch(s.name, *s.text));
    (options->*s.set)(on);
  }
  return absl::OkStatus();
}

absl::Status FillNumbers(const MeshingFlags& flags, v1::RemeshOptions* options) {
  if (flags.rho) {
    MESHFRONT_ASSIGN_OR_RETURN(const double rho, ParseNumber("--rho", *flags.rho, kRho));
    options->set_rho(rho);
  }
  if (flags.eta) {
    MESHFRONT_ASSIGN_OR_RETURN(const double eta, ParseNumber("--eta", *flags.eta, kEta));
    options->set_eta(eta);
  }
  if (flags.max_error) {
    MESHFRONT_ASSIGN_OR_RETURN(*options->mutable_max_error(), ParseLength("--max-error", *flags.max_error));
  }
  if (flags.target_triangles) {
    MESHFRONT_ASSIGN_OR_RETURN(const uint64_t count, ParseCount("--target-triangles", *flags.target_triangles));
    options->set_target_triangles(count);
  }
  if (flags.edge_length) {
    MESHFRONT_ASSIGN_OR_RETURN(*options->mutable_edge_length(), ParseLength("--edge-length", *flags.edge_length));
  }
  if (flags.min_edge) {
    MESHFRONT_ASSIGN_OR_RETURN(*options->mutable_min_edge(), ParseLength("--min-edge", *flags.min_edge));
  }
  if (flags.max_edge) {
    MESHFRONT_ASSIGN_OR_RETURN(*options->mutable_max_edge(), ParseLength("--max-edge", *flags.max_edge));
  }
  if (flags.fill_gaps) {
    MESHFRONT_ASSIGN_OR_RETURN(*options->mutable_fill_gaps(), ParseLength("--fill-gaps", *flags.fill_gaps));
  }
  if (flags.threads) {
    constexpr uint32_t most = 1024;
    uint32_t threads;
    if (!absl::SimpleAtoi(*flags.threads, &threads) || threads > most) {
      return WrongValue("--threads", *flags.threads, "a whole number from 0 (all cores) to 1024");
    }
    options->set_threads(threads);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<v1::RemeshOptions> ParseMeshingFlags(const MeshingFlags& flags) {
  v1::RemeshOptions options;
  MESHFRONT_RETURN_IF_ERROR(CheckValues(flags));
  MESHFRONT_RETURN_IF_ERROR(FillSwitches(flags, &options));
  MESHFRONT_RETURN_IF_ERROR(FillNumbers(flags, &options));
  MESHFRONT_RETURN_IF_ERROR(CheckEdgeRange(options));
  MESHFRONT_ASSIGN_OR_RETURN(const v1::Sizing sizing, ParseSizing(flags));
  MESHFRONT_RETURN_IF_ERROR(CheckSizingFlags(flags, sizing));
  MESHFRONT_RETURN_IF_ERROR(CheckBuilt(flags));
  MESHFRONT_RETURN_IF_ERROR(FillRegion(flags, &options));
  MESHFRONT_RETURN_IF_ERROR(FillLevels(flags, &options));
  options.set_sizing(sizing);
  if (flags.crease_angle == "off") options.mutable_crease()->set_off(true);
  if (flags.crease_angle && *flags.crease_angle != "off") {
    MESHFRONT_ASSIGN_OR_RETURN(const double angle, ParseNumber("--crease-angle", *flags.crease_angle, kCreaseAngle));
    options.mutable_crease()->set_angle_degrees(angle);
  }
  if (flags.attributes == "drop") options.set_attributes(v1::ATTRIBUTE_POLICY_DROP);
  if (flags.surface == "mesh") options.set_surface(v1::SURFACE_TYPE_MESH);
  if (flags.surface == "mls") options.set_surface(v1::SURFACE_TYPE_MLS);
  if (flags.surface == "imls") options.set_surface(v1::SURFACE_TYPE_IMLS);
  if (flags.mls_radius) {
    MESHFRONT_ASSIGN_OR_RETURN(const double radius, ParseNumber("--mls-radius", *flags.mls_radius, kMlsRadius));
    options.set_mls_radius(radius);
  }
  return options;
}

absl::StatusOr<std::vector<uint32_t>> ReadRegionFaces(const Text& region) {
  std::vector<uint32_t> faces;
  absl::string_view path = region ? absl::string_view(*region) : "";
  if (!absl::ConsumePrefix(&path, kFacesPrefix)) return faces;
  std::ifstream file{std::string(path)};
  if (!file) return absl::InvalidArgumentError(absl::StrCat("--region names the file ", path, ", which can't be read"));
  std::string line;
  for (uint64_t number = 1; std::getline(file, line); ++number) {
    const absl::string_view text = absl::StripAsciiWhitespace(line);
    if (text.empty()) continue;
    uint32_t face;
    if (!absl::SimpleAtoi(text, &face)) {
      return absl::InvalidArgumentError(absl::StrCat(path, " has \"", text.substr(0, 40), "\" in line ", number,
                                                     "; it must be the number of a face"));
    }
    faces.push_back(face);
  }
  if (!faces.empty()) return faces;
  return absl::InvalidArgumentError(absl::StrCat(path, " names no face; --region needs at least one"));
}

absl::StatusOr<SessionFile> ReadSessionFile(const std::string& path) {
  constexpr std::streamsize kLongest = 256;
  std::string text(kLongest, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(text.data(), kLongest);
  text.resize(static_cast<size_t>(file.gcount()));
  const std::vector<std::string> words = absl::StrSplit(text, absl::ByAnyChar(" \r\n"), absl::SkipEmpty());
  const auto is_of_a_name = [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_';
  };
  const bool is_whole =
      !words.empty() && words.size() <= 2 && std::all_of(words[0].begin(), words[0].end(), is_of_a_name);
  if (is_whole && (words.size() == 1 || words[1] == kSessionWithAttributes))
    return SessionFile{words[0], words.size() == 2};
  return absl::InvalidArgumentError(
      absl::StrCat("--session is ", path, "; it must be a file that --keep-session wrote"));
}

absl::StatusOr<std::optional<uint64_t>> ParseSessionRevision(const Text& revision) {
  if (!revision) return std::nullopt;
  uint64_t number;
  if (absl::SimpleAtoi(*revision, &number)) return number;
  return absl::InvalidArgumentError(absl::StrCat("--session-revision is \"", revision->substr(0, 40),
                                                 "\"; it must be a whole number from 0 on, as --stats has it"));
}

absl::StatusOr<double> ParseTimeout(const Text& timeout) {
  if (!timeout) return kInfinity;
  return ParseNumber("--timeout", *timeout, {0, kInfinity, false, false, "a positive number of seconds"});
}

absl::Status CheckServerAddress(const std::string& address) { return CheckHostPort("--server", address, 1); }

absl::StatusOr<Format> FormatFor(const std::string& path, const Text& format, const std::string& flag) {
  if (format) {
    const Format named = FormatOfName(*format);
    if (named != Format::kUnknown) return named;
    return WrongValue(flag, *format, "off, obj, ply, stl, glb, gltf or xyz");
  }
  if (path == "-")
    return absl::InvalidArgumentError(absl::StrCat("- has no ending that tells its format: give ", flag));
  return FormatOfName(path);
}

}  // namespace meshfront
