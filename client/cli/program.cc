#include "client/cli/program.h"

#include <signal.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <string>

#include "absl/strings/str_cat.h"
#include "client/cli/commands.h"
#include "client/cli/version.h"
#include "core/base/exceptions.h"
#include "server/serve_main.h"

namespace meshfront {
namespace {

// Everything that the command line can say.
struct CommandLine {
  RemeshArguments remesh;
  EstimateArguments estimate;
  MeasureArguments measure;
  RenderArguments render;
  std::string info_path, sample_path, figures_path;
  CallFlags info_flags;
};

void AddMeshingFlags(CLI::App* command, MeshingFlags* flags) {
  command->add_option("--rho", flags->rho, "angle an edge subtends on the osculating circle, radians, (0, 2π/3] [0.8]");
  command->add_option("--eta", flags->eta, "bound on the ratio of incident edges, (1, 2) [1.2]");
  command->add_option("--sizing", flags->sizing, "what is held constant: angle, error, uniform or thickness [angle]");
  command->add_option("--max-error", flags->max_error,
                      "distance to the surface held constant, absolute or % of the diagonal; --sizing error [0.1%]");
  command->add_option("--edge-length", flags->edge_length,
                      "the median edge, the same everywhere, absolute or % of the diagonal; --sizing uniform");
  command->add_option("--target-triangles", flags->target_triangles,
                      "how many triangles, within 3%: solves for the parameter of --sizing, and takes some out where "
                      "that makes more; with --region, new ones");
  command->add_option("--min-edge", flags->min_edge,
                      "lower clamp of the edge length, absolute or % of the diagonal [derived]");
  command->add_option("--max-edge", flags->max_edge,
                      "upper clamp of the edge length, absolute or % of the diagonal [derived]");
  command->add_option("--flips", flags->flips, "on, off: streaming edge flips behind the front [on]");
  command->add_option("--smooth", flags->smooth, "on, off: guarded smoothing behind the front [on]");
  command->add_option("--fit", flags->fit,
                      "on, off: vertices moved along the normal to fit the surface between them [on]");
  command->add_option("--repair", flags->repair, "on, off: mend the input before meshing [on]");
  command->add_option("--threads", flags->threads, "0: all cores; the output is the same for every number [0]");
  command->add_option("--crease-angle", flags->crease_angle,
                      "edges that turn by more degrees than this stay sharp, or off: none does [40]");
  command->add_option("--attributes", flags->attributes,
                      "keep, drop: UV, normals, colours, materials, …; their seams become feature curves [keep]");
  command->add_option("--surface", flags->surface, "auto, mesh, imls, mls [auto]");
  command->add_option("--features", flags->features, "OBJ with lines (v and l) on the surface to be kept like creases");
  command->add_option("--region", flags->region,
                      "remesh only the faces inside sphere:x,y,z,r or box:x0,y0,z0,x1,y1,z1, or faces:FILE (numbers "
                      "from 0, one a line, of the triangles that polygons are cut into)");
  command->add_option("--blend", flags->blend,
                      "width of the size transition at the region's border, in edges of the border [8]");
  command->add_option("--mls-radius", flags->mls_radius, "radius of a point's weight in local spacings, 2 to 16 [4]");
  command->add_option(
      "--fill-gaps", flags->fill_gaps,
      "close gaps before meshing, holes of a mesh or rims of a point set: boundary loops of at most this "
      "diameter, absolute or % of the diagonal [none]");
  command->add_option("--seed-point", flags->seed_points, "a point near an intersection curve (not yet)");
}

void AddCallFlags(CLI::App* command, CallFlags* flags) {
  command->add_option("--server", flags->server, "HOST:PORT of a remote server [the same service inside this process]");
  command->add_option("--timeout", flags->timeout, "deadline of the call in seconds [none]");
  command->add_option("--in-format", flags->in_format,
                      "format of IN when it is - (off, obj, ply, stl, glb, gltf, xyz)");
}

void AddRemesh(CLI::App* program, RemeshArguments* arguments) {
  CLI::App* command = program->add_subcommand("remesh", "A mesh in, a remeshed one out");
  command->add_option("IN", arguments->in, "OFF OBJ PLY STL GLB glTF XYZ, or - for standard input")->required();
  command->add_option("OUT", arguments->out, "OFF OBJ PLY STL GLB glTF, or - for standard output")->required();
  AddMeshingFlags(command, &arguments->meshing);
  command->add_option("--lod", arguments->meshing.lod,
                      "levels of detail, by growing values of rho (0.3,0.8,1.5): one glTF (MSFT_lod), else "
                      "OUT.lod0, OUT.lod1, …");
  AddCallFlags(command, &arguments->call);
  command->add_option("--out-format", arguments->call.out_format, "format of OUT when it is -");
  command->add_option("--stats", arguments->stats, "write what was done, and how well, as JSON");
  command->add_option("--trace", arguments->trace, "write one JSON line per chunk received");
  command->add_option("--picture", arguments->picture, "write a before/after wireframe picture (PNG)");
  command->add_flag("--patch-only", arguments->patch_only, "write the new triangles of the region alone");
  command->add_option("--removed", arguments->removed,
                      "with --patch-only: write the numbers of the faces they replace");
  command->add_option("--keep-session", arguments->keep_session,
                      "with --server: it keeps IN for further calls; write the name of that session to a file");
  command->add_option("--session", arguments->session,
                      "with --server: the file that --keep-session wrote, in place of IN, which is - and not read");
  command->add_option("--session-revision", arguments->session_revision,
                      "with --session: the revision of the mesh that is meant, as --stats has it; refused where the "
                      "session has another [whichever it has]");
  command->add_flag("--update-session", arguments->update_session,
                    "with --session or --keep-session: the result takes the place of the mesh that the server keeps");
  command->add_option("--write-repaired", arguments->write_repaired, "write the input as it was meshed, after repair");
  command->add_flag("--quiet", arguments->quiet, "no progress bar (also when standard error is no terminal)");
}

void AddEstimate(CLI::App* program, EstimateArguments* arguments) {
  CLI::App* command =
      program->add_subcommand("estimate", "Predict triangles, edge lengths, error bound and memory; mesh nothing");
  command->add_option("IN", arguments->in, "a mesh, or - for standard input")->required();
  AddMeshingFlags(command, &arguments->meshing);
  AddCallFlags(command, &arguments->call);
  command->add_flag("--json", arguments->json, "print JSON");
}

void AddMeasure(CLI::App* program, MeasureArguments* arguments) {
  CLI::App* command = program->add_subcommand("measure", "Quality, topology and two-sided distance of a mesh");
  command->add_option("OUT", arguments->out, "the mesh to measure")->required();
  command->add_option("--ref", arguments->reference, "the mesh to measure the distance to");
  command->add_option("--in-format", arguments->call.in_format, "format of OUT when it is -");
  command->add_flag("--json", arguments->json, "print JSON");
}

void AddRender(CLI::App* program, RenderArguments* arguments) {
  CLI::App* command = program->add_subcommand("render", "A picture of a mesh: shaded faces and their edges");
  command->add_option("IN", arguments->in, "a mesh or point set, or - for standard input")->required();
  command->add_option("OUT", arguments->out, "PNG, or - for standard output")->required();
  command->add_option("--view-of", arguments->view_of, "seen as this mesh is, so that pictures can be compared [IN]");
  command->add_option("--up", arguments->up, "y, z: what is up in the picture [what shows more]");
  command->add_option("--at", arguments->at, "x,y,z of the point in the middle [that of the shape]");
  command->add_option("--zoom", arguments->zoom, "how many times larger than the whole shape, 0.001 to 1000000 [1]");
  command->add_option("--size", arguments->size, "width and height in pixels, from 16 to 8192 [800]");
  command->add_option("--in-format", arguments->in_format, "format of IN when it is -");
}

void AddOthers(CLI::App* program, CommandLine* line) {
  CLI::App* info = program->add_subcommand("info", "What is in a file, and what is wrong with it, with locations");
  info->add_option("FILE", line->info_path, "a mesh or point set, or - for standard input")->required();
  info->add_option("--in-format", line->info_flags.in_format, "format of FILE when it is -");
  CLI::App* sample = program->add_subcommand("sample", "Write the sample that the quickstart remeshes");
  sample->add_option("OUT", line->sample_path, "OFF OBJ PLY STL GLB glTF")->required();
  CLI::App* figures = program->add_subcommand("figures", "Print a file that --stats wrote as a table");
  figures->add_option("STATS", line->figures_path, "JSON of --stats")->required();
  program->add_subcommand("serve", "Run the server, with the options of meshfrontd (meshfront serve --help)");
  program->add_subcommand("version", "Print the version");
}

ExitCode Usage(const std::string& message) {
  std::cerr << "meshfront: " << message << "\n";
  return ExitCode::kUsage;
}

ExitCode RunParsed(const CLI::App& program, const CommandLine& line) {
  if (program.got_subcommand("remesh")) return RunRemesh(line.remesh);
  if (program.got_subcommand("estimate")) return RunEstimate(line.estimate);
  if (program.got_subcommand("measure")) return RunMeasure(line.measure);
  if (program.got_subcommand("render")) return RunRender(line.render);
  if (program.got_subcommand("info")) return RunInfo(line.info_path, line.info_flags);
  if (program.got_subcommand("sample")) return RunSample(line.sample_path);
  if (program.got_subcommand("figures")) return RunFigures(line.figures_path);
  std::cout << "meshfront " << kClientVersion << "\n";
  return ExitCode::kDone;
}

ExitCode ParseAndRun(int argc, char** argv) {
  CLI::App program("Remeshes by an advancing front; exit codes and flags are those of the manual.", "meshfront");
  program.require_subcommand(1);
  CommandLine line;
  AddRemesh(&program, &line.remesh);
  AddEstimate(&program, &line.estimate);
  AddMeasure(&program, &line.measure);
  AddRender(&program, &line.render);
  AddOthers(&program, &line);
  const std::string command = argc > 1 ? argv[1] : "";
  const auto is_it = [&command](const CLI::App* subcommand) { return subcommand->get_name() == command; };
  const CLI::App& known = program;
  if (!command.empty() && command[0] != '-' && known.get_subcommands(is_it).empty())
    return Usage(absl::StrCat(command, " is no subcommand; it must be one of those that meshfront --help lists"));
  try {
    program.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return static_cast<ExitCode>(program.exit(help));
  } catch (const CLI::ParseError& error) {
    return Usage(absl::StrCat(error.what(), " (meshfront --help)"));
  }
  return RunParsed(program, line);
}

// The Booleans have no flags of their own yet, and `serve` hands its on: neither goes through the parser.
bool IsBoolean(const std::string& command) {
  return command == "union" || command == "intersection" || command == "difference" || command == "cut";
}

int Run(int argc, char** argv) {
  signal(SIGPIPE, SIG_IGN);  // a reader of standard output that leaves is exit code 7, not a death
  const std::string command = argc > 1 ? argv[1] : "";
  if (command == "--version") argv[1] = const_cast<char*>("version");
  if (command == "serve") {
    argv[1] = const_cast<char*>("meshfront serve");
    return ServeMain(argc - 1, argv + 1);
  }
  if (IsBoolean(command)) return static_cast<int>(Usage(absl::StrCat(command, " is not yet built")));
  return static_cast<int>(ParseAndRun(argc, argv));
}

}  // namespace

int RunProgram(int argc, char** argv) {
  try {
    return Run(argc, argv);
  } catch (...) {
    return static_cast<int>(Fail(ExitCode::kInternalError, StatusOfException()));
  }
}

}  // namespace meshfront
