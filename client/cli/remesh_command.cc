// Algorithm: 1. ParseArguments, before anything is touched; 2. CheckOutputs, so that a folder that can't be written is told before
// the work; 3. ReadMesh; 4. UseInput: the repaired copy and the left half of the picture, so that the input need not be kept;
// 5. Call: chunks go to the spool as they come; 6. WriteResult, picture and stats.
#include <filesystem>
#include <iostream>
#include <optional>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "client/cli/call_failure.h"
#include "client/cli/commands.h"
#include "client/cli/connection.h"
#include "client/cli/figures.h"
#include "client/cli/input.h"
#include "client/cli/picture/before_after.h"
#include "client/cli/process.h"
#include "client/cli/result_collector.h"
#include "client/cli/stats.h"
#include "client/cli/terminal.h"
#include "client/cli/text.h"
#include "client/cli/version.h"
#include "client/spool_writer.h"
#include "core/base/context.h"
#include "core/base/status_macros.h"
#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "core/remesh.h"
#include "proto/wire/convert.h"

namespace meshfront {
namespace {

class RemeshCommand {
 public:
  explicit RemeshCommand(const RemeshArguments& arguments) : arguments_(arguments) {}

  ExitCode Run() {
    using Step = ExitCode (RemeshCommand::*)();
    constexpr Step steps[] = {&RemeshCommand::ParseArguments, &RemeshCommand::CheckOutputs,
                              &RemeshCommand::ReadMesh,       &RemeshCommand::UseInput,
                              &RemeshCommand::Call,           &RemeshCommand::WriteResult,
                              &RemeshCommand::WriteRemoved,   &RemeshCommand::WriteSession,
                              &RemeshCommand::WritePicture,   &RemeshCommand::WriteStats};
    for (const Step step : steps) {
      const ExitCode code = (this->*step)();
      if (code != ExitCode::kDone) return code;
    }
    return summary_.complete() ? ExitCode::kDone : ReportOpenPlaces();
  }

 private:
  ExitCode ParseArguments() {
    const absl::Status parsed = TryParseArguments();
    return parsed.ok() ? ExitCode::kDone : Fail(ExitCode::kUsage, parsed);
  }

  absl::Status TryParseArguments() {
    MESHFRONT_ASSIGN_OR_RETURN(call_.options, ParseMeshingFlags(arguments_.meshing));
    MESHFRONT_RETURN_IF_ERROR(ParseRegion());
    MESHFRONT_ASSIGN_OR_RETURN(timeout_, ParseTimeout(arguments_.call.timeout));
    if (remote()) MESHFRONT_RETURN_IF_ERROR(CheckServerAddress(arguments_.call.server));
    MESHFRONT_RETURN_IF_ERROR(ParseSession());
    if (call_.session_id.empty()) {
      MESHFRONT_ASSIGN_OR_RETURN(in_format_, FormatFor(arguments_.in, arguments_.call.in_format, "--in-format"));
    }
    MESHFRONT_ASSIGN_OR_RETURN(out_format_, FormatFor(arguments_.out, arguments_.call.out_format, "--out-format"));
    if (out_format_ == Format::kUnknown) {
      return absl::InvalidArgumentError(absl::StrCat(
          "OUT is ", arguments_.out, "; its ending must be off, obj, ply, stl, glb or gltf, or give --out-format"));
    }
    MESHFRONT_RETURN_IF_ERROR(CheckWritable(out_format_));
    MESHFRONT_RETURN_IF_ERROR(CheckEndings());
    MESHFRONT_RETURN_IF_ERROR(CheckNoneCollide(Outputs()));
    MESHFRONT_RETURN_IF_ERROR(CheckInputsStay());
    call_.output.set_scalar_type(v1::SCALAR_TYPE_FLOAT64);
    call_.output.set_normals(HoldsNormals(out_format_));
    return absl::OkStatus();
  }

  absl::Status ParseRegion() {
    if (arguments_.patch_only && !arguments_.meshing.region)
      return absl::InvalidArgumentError("--patch-only needs --region: the patch is what is made of that");
    if (!arguments_.removed.empty() && !arguments_.patch_only)
      return absl::InvalidArgumentError("--removed needs --patch-only; without it the rest is in OUT already");
    MESHFRONT_ASSIGN_OR_RETURN(call_.region_faces, ReadRegionFaces(arguments_.meshing.region));
    if (arguments_.patch_only) call_.options.mutable_region()->set_patch_only(true);
    return absl::OkStatus();
  }

  absl::Status ParseSession() {
    const std::string &session = arguments_.session, &kept = arguments_.keep_session;
    if (session.empty() && kept.empty()) return absl::OkStatus();
    if (!remote()) {
      return absl::InvalidArgumentError(
          absl::StrCat(kept.empty() ? "--session" : "--keep-session", " needs --server: the session lives there"));
    }
    if (!session.empty() && !kept.empty())
      return absl::InvalidArgumentError("--session and --keep-session contradict each other; give one of them");
    call_.keep_session = !kept.empty();
    if (session.empty()) return absl::OkStatus();
    if (arguments_.in != "-")
      return absl::InvalidArgumentError(absl::StrCat("IN is ", arguments_.in, "; with --session it must be -"));
    if (!arguments_.picture.empty() || !arguments_.write_repaired.empty())
      return absl::InvalidArgumentError("--picture and --write-repaired need IN, which --session takes the place of");
    MESHFRONT_ASSIGN_OR_RETURN(call_.session_id, ReadSessionName(session));
    return absl::OkStatus();
  }

  absl::Status CheckEndings() const {
    const std::string &repaired = arguments_.write_repaired, &picture = arguments_.picture;
    const Format format = FormatOfName(repaired);
    if (!repaired.empty() && (format == Format::kUnknown || !CheckWritable(format).ok())) {
      return absl::InvalidArgumentError(
          absl::StrCat("--write-repaired is ", repaired, "; its ending must be off, obj, ply, stl, glb or gltf"));
    }
    if (!picture.empty() && picture != "-" && !absl::EndsWithIgnoreCase(picture, ".png"))
      return absl::InvalidArgumentError(absl::StrCat("--picture is ", picture, "; its ending must be png"));
    return absl::OkStatus();
  }

  std::vector<NamedOutput> Outputs() const {
    return {{"OUT", arguments_.out},
            {"--stats", arguments_.stats},
            {"--trace", arguments_.trace},
            {"--picture", arguments_.picture},
            {"--write-repaired", arguments_.write_repaired},
            {"--removed", arguments_.removed},
            {"--keep-session", arguments_.keep_session}};
  }

  // OUT may take the place of IN; nothing else may, nor anything that of the list of a region's faces.
  absl::Status CheckInputsStay() const {
    constexpr absl::string_view faces = "faces:";
    const std::string region = arguments_.meshing.region.value_or("");
    for (const NamedOutput& output : Outputs()) {
      if (arguments_.in != "-" && output.name != "OUT")
        MESHFRONT_RETURN_IF_ERROR(CheckNoneCollide({{"IN", arguments_.in}, output}));
      if (absl::StartsWith(region, faces))
        MESHFRONT_RETURN_IF_ERROR(CheckNoneCollide({{"--region", region.substr(faces.size())}, output}));
      if (!arguments_.session.empty())
        MESHFRONT_RETURN_IF_ERROR(CheckNoneCollide({{"--session", arguments_.session}, output}));
    }
    return absl::OkStatus();
  }

  ExitCode CheckOutputs() {
    for (const auto& [name, path] : Outputs()) {
      if (path.empty()) continue;
      const absl::Status status = CheckCanBeCreated(path);
      if (!status.ok()) return Fail(ExitCode::kOutput, status);
    }
    return ExitCode::kDone;
  }

  ExitCode ReadMesh() {
    if (!call_.session_id.empty()) return LeaveAttributes();
    const absl::Time begin = absl::Now();
    absl::StatusOr<ReadResult> read = ReadInput(arguments_.in, in_format_);
    if (!read.ok()) return Fail(ExitCodeOfRead(read.status()), read.status());
    input_ = std::move(read->mesh);
    warnings_ = std::move(read->warnings);
    figures_.read = absl::ToDoubleSeconds(absl::Now() - begin);
    asset_ = std::move(read->asset);
    ChooseAttributes();
    return ExitCode::kDone;
  }

  // What a session's attributes are called is known to who sent them.
  ExitCode LeaveAttributes() {
    call_.options.set_attributes(v1::ATTRIBUTE_POLICY_DROP);
    if (arguments_.meshing.attributes == "keep")
      warnings_.push_back("not carried over: attributes, since there is no IN");
    return ExitCode::kDone;
  }

  // What OUT has no place for is not sent, so that the surface is not cut along its seams.
  void ChooseAttributes() {
    const bool has_place = HoldsAttributes(out_format_);
    const bool wanted = arguments_.meshing.attributes != "drop";
    std::vector<std::string> left_out = input_.dropped_attributes;
    if (wanted && !has_place) {
      for (const AttributeChannel& c : input_.attributes.channels) left_out.push_back(c.name);
      if (!input_.attributes.groups.empty()) left_out.push_back("materials");
      if (asset_.gltf != nullptr) left_out.push_back("nodes, textures, animations and skins of the glTF");
    }
    if (!wanted || !has_place) {
      input_.attributes = {};
      asset_ = {};
    }
    channels_ = input_.attributes.channels;
    const bool is_gltf = out_format_ == Format::kGlb || out_format_ == Format::kGltf;
    is_asset_ = !input_.attributes.empty() || (is_gltf && asset_.gltf != nullptr);
    if (wanted && !left_out.empty())
      warnings_.push_back(absl::StrCat("not carried over: ", absl::StrJoin(left_out, ", ")));
    const std::vector<std::string> files = is_asset_ ? FilesBeside(asset_) : std::vector<std::string>();
    if (!files.empty() && !LieInOneFolder(arguments_.in, arguments_.out)) {
      warnings_.push_back(absl::StrCat(arguments_.out, " names files that lie beside ", arguments_.in,
                                       ", and that are not copied: ", absl::StrJoin(files, ", ")));
    }
  }

  ExitCode UseInput() {
    if (!arguments_.picture.empty()) picture_.emplace().DrawBefore(input_);
    if (arguments_.write_repaired.empty()) return ExitCode::kDone;
    if (input_.IsPointSet()) {
      return Fail(ExitCode::kUsage, absl::InvalidArgumentError(absl::StrCat("--write-repaired needs triangles; ",
                                                                            arguments_.in, " is a point set")));
    }
    const bool repair = arguments_.meshing.repair != "off";
    Context context;
    const absl::StatusOr<RemeshOptions> options = OptionsFromProto(call_.options);
    if (!options.ok()) return Fail(ExitCode::kUsage, options.status());
    const auto mended = [&] {
      return arguments_.meshing.region ? RepairInputOfRegion(input_, context) : RepairInput(input_, *options, context);
    };
    absl::StatusOr<RepairResult> repaired = repair ? mended() : RepairResult{input_, {}};
    if (!repaired.ok()) return FailCall(repaired.status(), called_with());
    const absl::Status written = WriteMeshFile(arguments_.write_repaired, repaired->mesh);
    return written.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, written);
  }

  ExitCode Call() {
    CallCanceller canceller;
    call_.canceller = &canceller;
    interruption_.OnSignal([&canceller] { canceller.Cancel(); });
    absl::StatusOr<ChunkSpool> spool = ChunkSpool::Create(SpoolFolderFor(arguments_.out));
    if (!spool.ok()) return Fail(ExitCode::kOutput, spool.status());
    spool_.emplace(*std::move(spool));
    const ExitCode code = CallInto(*spool_);
    interruption_.OnSignal([] {});
    call_.canceller = nullptr;
    return code;
  }

  ExitCode CallInto(ChunkSpool& spool) {
    std::unique_ptr<OutputFile> trace;
    if (!arguments_.trace.empty()) {
      absl::StatusOr<std::unique_ptr<OutputFile>> file = OutputFile::Create(arguments_.trace);
      if (!file.ok()) return Fail(ExitCode::kOutput, file.status());
      trace = *std::move(file);
    }
    const absl::StatusOr<std::unique_ptr<Connection>> connection =
        Connect(arguments_.call.server, call_.options.threads());
    if (!connection.ok()) return Fail(ExitCode::kInternalError, connection.status());
    if (timeout_ < kLongestTimeout) call_.deadline = absl::Now() + absl::Seconds(timeout_);
    ProgressBar bar(std::cerr, !arguments_.quiet && IsTerminal(std::cerr));
    ResultCollector collector(spool, trace.get(), bar);
    absl::StatusOr<v1::Summary> summary = (*connection)->client().Remesh(std::move(input_), call_, collector);
    bar.Clear();
    collector.FillFigures(remote(), &figures_);
    removed_ = collector.removed_faces();
    // A trace of a failed job is worth keeping, and its own failure must not hide the job's.
    absl::Status finished = trace == nullptr ? absl::OkStatus() : trace->Commit();
    if (!collector.local_error().ok()) return Fail(ExitCode::kOutput, collector.local_error());
    if (!summary.ok()) return FailCall(summary.status(), called_with());
    summary_ = *std::move(summary);
    warnings_.insert(warnings_.end(), summary_.warnings().begin(), summary_.warnings().end());
    PrintWarnings(warnings_);
    if (finished.ok()) finished = spool.Finish();
    if (finished.ok()) finished = LookAtPart();
    if (absl::IsFailedPrecondition(finished)) return FailCall(finished, called_with());
    return finished.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, finished);
  }

  CalledWith called_with() const { return {arguments_.in, arguments_.call.server, timeout_}; }

  // An older server may call an empty mesh a result; what it says of a partial one may be wrong.
  absl::Status LookAtPart() {
    if (spool_->triangle_count() == 0)
      return absl::FailedPreconditionError("not one triangle could be meshed; the server does not say why");
    if (summary_.complete()) return absl::OkStatus();
    MESHFRONT_ASSIGN_OR_RETURN(const TriangleMesh part, spool_->Load());
    *summary_.mutable_output() = TopologyToProto(MeasureTopology(part));
    return absl::OkStatus();
  }

  ExitCode WriteResult() {
    const absl::Time begin = absl::Now();
    const absl::Status written = TryWriteResult();
    if (!written.ok()) return Fail(absl::IsCancelled(written) ? ExitCode::kCancelled : ExitCode::kOutput, written);
    figures_.write = absl::ToDoubleSeconds(absl::Now() - begin);
    figures_.total = SecondsSinceProcessStart();
    return ExitCode::kDone;
  }

  absl::Status TryWriteResult() {
    MESHFRONT_ASSIGN_OR_RETURN(const std::unique_ptr<OutputFile> out, OutputFile::Create(arguments_.out));
    MESHFRONT_RETURN_IF_ERROR(is_asset_ ? WriteAsset(out->sink()) : WriteSpool(*spool_, out_format_, out->sink()));
    if (interruption_.requested()) return absl::CancelledError("cancelled");
    return out->Commit();
  }

  ExitCode WriteRemoved() {
    if (arguments_.removed.empty()) return ExitCode::kDone;
    std::string lines;
    for (const uint32_t face : removed_) absl::StrAppend(&lines, face, "\n");
    const absl::Status written = WriteWholeFile(arguments_.removed, lines);
    return written.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, written);
  }

  // Where there is none, a warning has said why. Whoever can read its name may use it.
  ExitCode WriteSession() {
    if (arguments_.keep_session.empty() || !summary_.has_session()) return ExitCode::kDone;
    const absl::Status written = WriteWholeFile(arguments_.keep_session, summary_.session().id() + "\n");
    std::error_code ignored;  // a pipe is nobody else's
    if (std::filesystem::is_regular_file(arguments_.keep_session, ignored)) {
      constexpr std::filesystem::perms mine = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
      std::filesystem::permissions(arguments_.keep_session, mine, ignored);
    }
    return written.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, written);
  }

  absl::Status WriteAsset(ByteSink& file) {
    MESHFRONT_ASSIGN_OR_RETURN(const TriangleMesh mesh, spool_->LoadWithAttributes(channels_));
    std::vector<std::string> left_out;
    const absl::StatusOr<std::string> bytes = FormatAsset(mesh, out_format_, asset_, left_out);
    if (!bytes.ok())
      return absl::InternalError(absl::StrCat(file.name(), " can't be written: ", bytes.status().message()));
    if (!left_out.empty()) PrintWarnings({absl::StrCat("not carried over: ", absl::StrJoin(left_out, ", "))});
    return file.Append(*bytes);
  }

  ExitCode WritePicture() {
    if (!picture_) return ExitCode::kDone;
    const absl::Status drawn = TryWritePicture();
    return drawn.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, drawn);
  }

  absl::Status TryWritePicture() {
    MESHFRONT_ASSIGN_OR_RETURN(const TriangleMesh output, spool_->Load());
    picture_->DrawAfter(output);
    std::string png;
    MESHFRONT_RETURN_IF_ERROR(picture_->canvas().EncodePng(&png));
    return WriteWholeFile(arguments_.picture, png);
  }

  ExitCode WriteStats() {
    figures_.remote = remote();
    figures_.peak_rss_bytes = PeakRssBytes();
    const nlohmann::ordered_json stats = StatsJson(kClientVersion, summary_, figures_);
    if (!arguments_.quiet && IsTerminal(std::cerr)) std::cerr << FiguresTable(stats);
    if (arguments_.stats.empty()) return ExitCode::kDone;
    const absl::Status written = WriteWholeFile(arguments_.stats, stats.dump(2) + "\n");
    return written.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, written);
  }

  ExitCode ReportOpenPlaces() const {
    constexpr int shown = 20;
    if (summary_.open_place_count() == 0) {
      std::cerr << "meshfront: " << arguments_.out << " is not what was asked for: see the warnings\n";
      return ExitCode::kPartial;
    }
    std::cerr << "meshfront: " << arguments_.out << " is meshed only in part; it is open at "
              << summary_.open_place_count() << " places:\n";
    for (int i = 0; i < std::min(shown, summary_.open_places_size()); ++i) {
      const v1::Point& p = summary_.open_places(i);
      std::cerr << "  " << PlaceText({p.x(), p.y(), p.z()}) << "\n";
    }
    if (summary_.open_places_size() > shown) std::cerr << "  and more: see --stats\n";
    return ExitCode::kPartial;
  }

  bool remote() const { return !arguments_.call.server.empty(); }

  static constexpr double kLongestTimeout = 1e9;  // seconds: longer is none

  const RemeshArguments& arguments_;
  Interruption interruption_;
  CallOptions call_;
  double timeout_ = 0;
  Format in_format_ = Format::kUnknown, out_format_ = Format::kUnknown;
  TriangleMesh input_;
  MeshAsset asset_;                         // what OUT has beside the mesh
  std::vector<AttributeChannel> channels_;  // of the result
  bool is_asset_ = false;                   // OUT has attributes, or something beside the mesh
  std::vector<std::string> warnings_;
  std::vector<uint32_t> removed_;
  std::optional<BeforeAfterPicture> picture_;
  std::optional<ChunkSpool> spool_;
  v1::Summary summary_;
  ClientFigures figures_;
};

}  // namespace

ExitCode RunRemesh(const RemeshArguments& arguments) { return RemeshCommand(arguments).Run(); }

}  // namespace meshfront
