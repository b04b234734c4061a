// Algorithm: 1. ParseArguments, before anything is touched; 2. CheckOutputs, so that a folder that can't be written is told before
// the work; 3. ReadMesh; 4. UseInput: the repaired copy and the left half of the picture, so that the input need not be kept;
// 5. Call: chunks go to the spool as they come; 6. WriteResult, picture and stats.
#include <algorithm>
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
#include "client/cli/feature_lines.h"
#include "client/cli/figures.h"
#include "client/cli/input.h"
#include "client/cli/levels.h"
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
    ExitCode code = ReportSession();
    for (size_t level = 0; level < level_count(); ++level) {
      if (!summaries_[level].complete()) code = ReportOpenPlaces(level);
    }
    return code;
  }

 private:
  ExitCode ParseArguments() {
    const absl::Status parsed = TryParseArguments();
    return parsed.ok() ? ExitCode::kDone : Fail(ExitCode::kUsage, parsed);
  }

  absl::Status TryParseArguments() {
    MESHFRONT_ASSIGN_OR_RETURN(call_.options, ParseMeshingFlags(arguments_.meshing));
    MESHFRONT_RETURN_IF_ERROR(ParseRegion());
    MESHFRONT_ASSIGN_OR_RETURN(features_, ReadFeatureLines(arguments_.meshing.features));
    call_.features = features_.lines;
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
    if (has_level_files() && arguments_.out == "-")
      return absl::InvalidArgumentError(
          "OUT is -; with --lod it must be a file, or GLB or glTF, which hold all levels");
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
    call_.update_session = arguments_.update_session;
    MESHFRONT_ASSIGN_OR_RETURN(call_.session_revision, ParseSessionRevision(arguments_.session_revision));
    if (call_.session_revision && session.empty())
      return absl::InvalidArgumentError("--session-revision needs --session, whose mesh it names");
    if (session.empty() && kept.empty()) {
      if (!arguments_.update_session) return absl::OkStatus();
      return absl::InvalidArgumentError("--update-session needs --session or --keep-session, whose mesh it replaces");
    }
    if (!remote()) {
      return absl::InvalidArgumentError(
          absl::StrCat(kept.empty() ? "--session" : "--keep-session", " needs --server: the session lives there"));
    }
    if (!session.empty() && !kept.empty())
      return absl::InvalidArgumentError("--session and --keep-session contradict each other; give one of them");
    if (has_levels()) {
      return absl::InvalidArgumentError(
          absl::StrCat("--lod and ", kept.empty() ? "--session" : "--keep-session", " contradict each other"));
    }
    call_.keep_session = !kept.empty();
    if (session.empty()) return absl::OkStatus();
    if (arguments_.in != "-")
      return absl::InvalidArgumentError(absl::StrCat("IN is ", arguments_.in, "; with --session it must be -"));
    if (!arguments_.picture.empty() || !arguments_.write_repaired.empty())
      return absl::InvalidArgumentError("--picture and --write-repaired need IN, which --session takes the place of");
    MESHFRONT_ASSIGN_OR_RETURN(const SessionFile file, ReadSessionFile(session));
    if (file.has_attributes && arguments_.meshing.attributes != "drop") {
      return absl::InvalidArgumentError(
          absl::StrCat("the mesh of session ", session,
                       " has attributes, materials or nodes, which can't be written "
                       "without IN; give IN in place of --session, or --attributes drop"));
    }
    call_.session_id = file.name;
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
    std::vector<NamedOutput> outputs = {
        {"--stats", arguments_.stats},     {"--trace", arguments_.trace},
        {"--picture", arguments_.picture}, {"--write-repaired", arguments_.write_repaired},
        {"--removed", arguments_.removed}, {"--keep-session", arguments_.keep_session}};
    for (const std::string& path : OutPaths()) outputs.push_back({"OUT", path});
    return outputs;
  }

  // One, or one for each level.
  std::vector<std::string> OutPaths() const {
    if (!has_level_files()) return {arguments_.out};
    std::vector<std::string> paths;
    for (size_t level = 0; level < level_count(); ++level) paths.push_back(LevelPath(arguments_.out, level));
    return paths;
  }

  // OUT may take the place of IN; nothing else may, nor anything that of the list of a region's faces or of lines.
  absl::Status CheckInputsStay() const {
    constexpr absl::string_view faces = "faces:";
    const std::string region = arguments_.meshing.region.value_or("");
    for (const NamedOutput& output : Outputs()) {
      if (arguments_.in != "-" && output.name != "OUT")
        MESHFRONT_RETURN_IF_ERROR(CheckNoneCollide({{"IN", arguments_.in}, output}));
      if (arguments_.meshing.features)
        MESHFRONT_RETURN_IF_ERROR(CheckNoneCollide({{"--features", *arguments_.meshing.features}, output}));
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
    figures_.front().read = absl::ToDoubleSeconds(absl::Now() - begin);
    asset_ = std::move(read->asset);
    ChooseAttributes();
    return ExitCode::kDone;
  }

  // What a session's attributes are called is known to who sent them.
  ExitCode LeaveAttributes() {
    call_.options.set_attributes(v1::ATTRIBUTE_POLICY_DROP);
    return ExitCode::kDone;
  }

  // What OUT has no place for is not sent, so that the surface is not cut along its seams.
  void ChooseAttributes() {
    const bool has_place = HoldsAttributes(out_format_);
    const bool wanted = arguments_.meshing.attributes != "drop";
    std::vector<std::string> left_out = input_.dropped_attributes;
    if (wanted && !has_place) {
      for (std::string& name : NamesForMessage(input_.attributes.channels)) left_out.push_back(std::move(name));
      if (!input_.attributes.groups.empty()) left_out.push_back("materials");
      if (asset_.gltf != nullptr) left_out.push_back("nodes, textures, animations and skins of the glTF");
    }
    if (!wanted || !has_place) {
      input_.attributes = {};
      asset_ = {};
    }
    channels_ = input_.attributes.channels;
    is_asset_ = !input_.attributes.empty() || (is_gltf() && asset_.gltf != nullptr);
    if (wanted && !left_out.empty())
      warnings_.push_back(absl::StrCat("not carried over: ", absl::StrJoin(left_out, ", ")));
    if (wanted) left_out_ = std::move(left_out);
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
    while (spools_.size() < level_count()) {
      absl::StatusOr<ChunkSpool> spool = ChunkSpool::Create(SpoolFolderFor(arguments_.out));
      if (!spool.ok()) return Fail(ExitCode::kOutput, spool.status());
      spools_.push_back(*std::move(spool));
    }
    const ExitCode code = CallIntoSpools();
    interruption_.OnSignal([] {});
    call_.canceller = nullptr;
    return code;
  }

  ExitCode CallIntoSpools() {
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
    ResultCollector collector(spools_, trace.get(), bar);
    absl::StatusOr<std::vector<v1::Summary>> summaries =
        (*connection)->client().RemeshLevels(std::move(input_), call_, collector);
    bar.Clear();
    removed_ = collector.removed_faces();
    // A trace of a failed job is worth keeping, and its own failure must not hide the job's.
    absl::Status finished = trace == nullptr ? absl::OkStatus() : trace->Commit();
    if (!collector.local_error().ok()) return Fail(ExitCode::kOutput, collector.local_error());
    if (!summaries.ok()) {
      return FailCall(WithFeatureLine(summaries.status(), arguments_.meshing.features.value_or(""), features_),
                      called_with());
    }
    summaries_ = *std::move(summaries);
    TakeFigures(collector);
    PrintWarnings(warnings_);
    for (size_t level = 0; level < level_count() && finished.ok(); ++level) {
      finished = spools_[level].Finish();
      if (finished.ok()) finished = LookAtPart(spools_[level], summaries_[level]);
    }
    if (absl::IsFailedPrecondition(finished)) return FailCall(finished, called_with());
    return finished.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, finished);
  }

  // Of all levels, with the warnings of each.
  void TakeFigures(const ResultCollector& collector) {
    const double read = figures_.front().read;
    figures_.assign(level_count(), {});
    figures_.front().read = read;
    for (size_t level = 0; level < level_count(); ++level) {
      collector.FillFigures(level, remote(), &figures_[level]);
      figures_[level].remote = remote();
      for (const std::string& warning : summaries_[level].warnings())
        warnings_.push_back(level_count() > 1 ? absl::StrCat("level ", level, ": ", warning) : warning);
    }
  }

  CalledWith called_with() const {
    const std::string& session = arguments_.session;
    return {session.empty() ? arguments_.in : absl::StrCat("session ", session), arguments_.call.server, timeout_};
  }

  // An older server may call an empty mesh a result; what it says of a partial one may be wrong.
  static absl::Status LookAtPart(const ChunkSpool& spool, v1::Summary& summary) {
    if (spool.triangle_count() == 0)
      return absl::FailedPreconditionError("not one triangle could be meshed; the server does not say why");
    if (summary.complete()) return absl::OkStatus();
    MESHFRONT_ASSIGN_OR_RETURN(const TriangleMesh part, spool.Load());
    *summary.mutable_output() = TopologyToProto(MeasureTopology(part));
    return absl::OkStatus();
  }

  ExitCode WriteResult() {
    const absl::Time begin = absl::Now();
    const absl::Status written = TryWriteResult();
    if (!written.ok()) return Fail(absl::IsCancelled(written) ? ExitCode::kCancelled : ExitCode::kOutput, written);
    figures_.front().write = absl::ToDoubleSeconds(absl::Now() - begin);
    figures_.front().total = SecondsSinceProcessStart();
    return ExitCode::kDone;
  }

  // All files are whole before the first gets its name.
  absl::Status TryWriteResult() {
    std::vector<std::unique_ptr<OutputFile>> files;
    for (const std::string& path : OutPaths()) {
      MESHFRONT_ASSIGN_OR_RETURN(std::unique_ptr<OutputFile> out, OutputFile::Create(path));
      files.push_back(std::move(out));
      MESHFRONT_RETURN_IF_ERROR(WriteTo(files.back()->sink(), files.size() - 1));
      MESHFRONT_RETURN_IF_ERROR(files.back()->Finish());
    }
    if (interruption_.requested()) return absl::CancelledError("cancelled");
    for (const std::unique_ptr<OutputFile>& file : files) MESHFRONT_RETURN_IF_ERROR(file->Commit());
    return absl::OkStatus();
  }

  absl::Status WriteTo(ByteSink& file, size_t level) {
    if (has_levels() && is_gltf()) return WriteLevels(file);
    return is_asset_ ? WriteAsset(spools_[level], file) : WriteSpool(spools_[level], out_format_, file);
  }

  ExitCode WriteRemoved() {
    if (arguments_.removed.empty()) return ExitCode::kDone;
    std::string lines;
    for (const uint32_t face : removed_) absl::StrAppend(&lines, face, "\n");
    const absl::Status written = WriteWholeFile(arguments_.removed, lines);
    return written.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, written);
  }

  // Where there is none, a warning has said why (ReportSession). Whoever can read its name may use it.
  ExitCode WriteSession() {
    if (arguments_.keep_session.empty() || !summaries_.front().has_session()) return ExitCode::kDone;
    const absl::Status written = WriteWholeFile(
        arguments_.keep_session, absl::StrCat(summaries_.front().session().id(),
                                              is_asset_ ? absl::StrCat(" ", kSessionWithAttributes) : "", "\n"));
    std::error_code ignored;  // a pipe is nobody else's
    if (std::filesystem::is_regular_file(arguments_.keep_session, ignored)) {
      constexpr std::filesystem::perms mine = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
      std::filesystem::permissions(arguments_.keep_session, mine, ignored);
    }
    return written.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, written);
  }

  // OUT is whole then, and there.
  ExitCode ReportSession() const {
    const std::string server = absl::StrCat("server ", arguments_.call.server, ": ");
    if (!arguments_.keep_session.empty() && !summaries_.front().has_session()) {
      return Fail(ExitCode::kServer,
                  absl::ResourceExhaustedError(absl::StrCat(server, "--keep-session was refused; ", arguments_.out,
                                                            " is whole, but ", arguments_.keep_session,
                                                            " was not written: it names no session of this mesh")));
    }
    const std::string& refusal = summaries_.front().session().update_refusal();
    if (refusal.empty()) return ExitCode::kDone;
    return Fail(ExitCode::kServer, absl::ResourceExhaustedError(
                                       absl::StrCat(server, "--update-session was refused (", refusal, "); ",
                                                    arguments_.out, " is whole, but the session has not got it")));
  }

  absl::Status WriteAsset(ChunkSpool& spool, ByteSink& file) {
    MESHFRONT_ASSIGN_OR_RETURN(const TriangleMesh mesh, spool.LoadWithAttributes(channels_));
    std::vector<std::string> left_out;
    return AppendFormatted(FormatAsset(mesh, out_format_, asset_, left_out), left_out, file);
  }

  absl::Status WriteLevels(ByteSink& file) {
    std::vector<TriangleMesh> meshes;
    for (ChunkSpool& spool : spools_) {
      MESHFRONT_ASSIGN_OR_RETURN(TriangleMesh mesh,
                                 is_asset_ ? spool.LoadWithAttributes(channels_) : spool.LoadWithNormals());
      meshes.push_back(std::move(mesh));
    }
    const std::vector<double> coverages = ScreenCoverages(summaries_);
    std::vector<DetailLevel> levels;
    for (size_t level = 0; level < meshes.size(); ++level) levels.push_back({&meshes[level], coverages[level]});
    std::vector<std::string> left_out;
    return AppendFormatted(FormatLevels(levels, out_format_, asset_, left_out), left_out, file);
  }

  absl::Status AppendFormatted(const absl::StatusOr<std::string>& bytes, const std::vector<std::string>& left_out,
                               ByteSink& file) {
    if (!bytes.ok())
      return absl::InternalError(absl::StrCat(file.name(), " can't be written: ", bytes.status().message()));
    std::vector<std::string> news;
    for (const std::string& name : left_out) {
      if (std::find(left_out_.begin(), left_out_.end(), name) == left_out_.end()) news.push_back(name);
    }
    if (!news.empty()) PrintWarnings({absl::StrCat("not carried over: ", absl::StrJoin(news, ", "))});
    left_out_.insert(left_out_.end(), news.begin(), news.end());
    return file.Append(*bytes);
  }

  ExitCode WritePicture() {
    if (!picture_) return ExitCode::kDone;
    const absl::Status drawn = TryWritePicture();
    return drawn.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, drawn);
  }

  absl::Status TryWritePicture() {
    MESHFRONT_ASSIGN_OR_RETURN(const TriangleMesh output, spools_.front().Load());
    picture_->DrawAfter(output);
    std::string png;
    MESHFRONT_RETURN_IF_ERROR(picture_->canvas().EncodePng(&png));
    return WriteWholeFile(arguments_.picture, png);
  }

  ExitCode WriteStats() {
    figures_.front().peak_rss_bytes = PeakRssBytes();
    nlohmann::ordered_json stats = StatsJson(kClientVersion, summaries_.front(), figures_.front());
    const std::vector<std::string> paths = OutPaths();
    for (size_t level = 0; has_levels() && level < level_count(); ++level)
      stats["lods"].push_back(LevelJson(paths[std::min(level, paths.size() - 1)], summaries_[level], figures_[level]));
    if (!arguments_.quiet && IsTerminal(std::cerr)) std::cerr << FiguresTable(stats);
    if (arguments_.stats.empty()) return ExitCode::kDone;
    const absl::Status written = WriteWholeFile(arguments_.stats, stats.dump(2) + "\n");
    return written.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, written);
  }

  ExitCode ReportOpenPlaces(size_t level) const {
    constexpr int shown = 20;
    const v1::Summary& summary = summaries_[level];
    const std::string what = has_levels() ? absl::StrCat("level ", level, " of ", arguments_.out) : arguments_.out;
    if (summary.open_place_count() == 0) {
      std::cerr << "meshfront: " << what << " is not what was asked for: see the warnings\n";
      return ExitCode::kPartial;
    }
    std::cerr << "meshfront: " << what << " is meshed only in part; it is open at " << summary.open_place_count()
              << " places:\n";
    for (int i = 0; i < std::min(shown, summary.open_places_size()); ++i) {
      const v1::Point& p = summary.open_places(i);
      std::cerr << "  " << PlaceText({p.x(), p.y(), p.z()}) << "\n";
    }
    if (summary.open_places_size() > shown) std::cerr << "  and more: see --stats\n";
    return ExitCode::kPartial;
  }

  bool has_levels() const { return arguments_.meshing.lod.has_value(); }
  size_t level_count() const { return std::max(call_.options.lod_rhos_size(), 1); }
  bool is_gltf() const { return out_format_ == Format::kGlb || out_format_ == Format::kGltf; }
  bool has_level_files() const { return has_levels() && !is_gltf(); }
  bool remote() const { return !arguments_.call.server.empty(); }

  static constexpr double kLongestTimeout = 1e9;  // seconds: longer is none

  const RemeshArguments& arguments_;
  Interruption interruption_;
  CallOptions call_;
  FeatureLines features_;
  double timeout_ = 0;
  Format in_format_ = Format::kUnknown, out_format_ = Format::kUnknown;
  TriangleMesh input_;
  MeshAsset asset_;                         // what OUT has beside the mesh
  std::vector<AttributeChannel> channels_;  // of the result
  bool is_asset_ = false;                   // OUT has attributes, or something beside the mesh
  std::vector<std::string> warnings_;
  std::vector<uint32_t> removed_;
  std::optional<BeforeAfterPicture> picture_;
  // Of each level, as far as they are there; without --lod there is one.
  std::vector<ChunkSpool> spools_;
  std::vector<v1::Summary> summaries_;
  std::vector<ClientFigures> figures_ = {{}};
  std::vector<std::string> left_out_;  // told so far
};

}  // namespace

ExitCode RunRemesh(const RemeshArguments& arguments) { return RemeshCommand(arguments).Run(); }

}  // namespace meshfront
