#include "client/cli/figures.h"

#include <fstream>
#include <iostream>

#include "absl/strings/str_format.h"
#include "client/cli/commands.h"
#include "client/cli/text.h"

namespace meshfront {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
T Get(const Json& stats, const char* pointer, T otherwise) {
  const Json::json_pointer at(pointer);
  if (!stats.contains(at) || !stats.at(at).is_number()) return otherwise;
  return stats.at(at).get<T>();
}

std::string Count(const Json& stats, const char* pointer) { return WithThousands(Get<uint64_t>(stats, pointer, 0)); }

std::string TopologyText(const Json& part) {
  const std::string genus = part.contains("genus") && part["genus"].is_number() ? part["genus"].dump() : "undefined";
  return absl::StrFormat("%d components, %d boundary loops, genus %s", Get<uint64_t>(part, "/components", 0),
                         Get<uint64_t>(part, "/boundary_loops", 0), genus);
}

// The parameter that the sizing has, and eta.
std::string ParametersText(const Json& stats) {
  for (const auto& [name, pointer] : {std::pair{"rho", "/parameters/rho"},
                                      {"max error", "/parameters/max_error"},
                                      {"edge length", "/parameters/edge_length"}}) {
    const double value = Get<double>(stats, pointer, 0);
    if (value > 0) return absl::StrFormat("%s %g, eta %g", name, value, Get<double>(stats, "/parameters/eta", 0));
  }
  return absl::StrFormat("eta %g", Get<double>(stats, "/parameters/eta", 0));
}

}  // namespace

std::string FiguresTable(const Json& stats) {
  const double diagonal = Get<double>(stats, "/input/diagonal", 0), bound = Get<double>(stats, "/error_bound", 0);
  const uint64_t triangles = Get<uint64_t>(stats, "/output/triangles", 0);
  const double mesh_seconds = Get<double>(stats, "/seconds/mesh", 0);
  std::string table;
  const auto row = [&table](const char* name, const std::string& text) {
    absl::StrAppendFormat(&table, "  %-12s %s\n", name, text);
  };
  row("before", Count(stats, "/input/triangles") + " triangles, " + TopologyText(stats.value("input", Json::object())));
  row("after", WithThousands(triangles) + " triangles, " + TopologyText(stats.value("output", Json::object())));
  row("predicted", Count(stats, "/predicted_triangles") + " triangles");
  row("parameters", ParametersText(stats));
  row("shape", absl::StrFormat("radius ratio (1 = equilateral): median %.3f, worst 0.5%% below %.3f, minimum %.3f",
                               Get<double>(stats, "/quality/radius_ratio_median", 0),
                               Get<double>(stats, "/quality/radius_ratio_p0_5", 0),
                               Get<double>(stats, "/quality/radius_ratio_min", 0)));
  if (diagonal > 0)
    row("error", absl::StrFormat("at most %.3g (%.2g%% of the diagonal)", bound, 100 * bound / diagonal));
  row("stream", absl::StrFormat("%s chunks, the first after %.2f s", Count(stats, "/chunks"),
                                Get<double>(stats, "/seconds/first_chunk", 0)));
  row("time", absl::StrFormat("engine %.2f s (%s triangles/s while meshing), in all %.2f s",
                              Get<double>(stats, "/seconds/engine", 0),
                              WithThousands(mesh_seconds > 0 ? static_cast<uint64_t>(triangles / mesh_seconds) : 0),
                              Get<double>(stats, "/seconds/total", 0)));
  if (stats.contains("session"))
    row("session", absl::StrFormat("revision %d, %s", Get<uint64_t>(stats, "/session/revision", 0),
                                   WithByteUnit(Get<uint64_t>(stats, "/session/bytes", 0))));
  std::string memory = WithByteUnit(Get<uint64_t>(stats, "/peak_rss_bytes", 0));
  if (stats.contains("server_peak_rss_bytes")) {
    memory = "client " + memory + ", server " + WithByteUnit(Get<uint64_t>(stats, "/server_peak_rss_bytes", 0));
  }
  row("memory", memory);
  return table;
}

ExitCode RunFigures(const std::string& path) {
  std::ifstream file(path);
  const Json stats = Json::parse(file, nullptr, /*allow_exceptions=*/false);
  if (!file || !stats.is_object()) {
    return Fail(ExitCode::kInput, absl::InvalidArgumentError(path + " is not a file that --stats wrote"));
  }
  std::cout << FiguresTable(stats);
  return ExitCode::kDone;
}

}  // namespace meshfront
