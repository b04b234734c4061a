#include "client/cli/result_collector.h"

#include <iostream>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "proto/wire/convert.h"

namespace meshfront {
namespace {

double Seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

void ResultCollector::OnUploaded() { uploaded_ = Clock::now(); }

void ResultCollector::OnProgress(const v1::Progress& progress) {
  progress_.stage = StageName(ProgressFromProto(progress).stage);
  if (progress.predicted_triangles() > 0) progress_.predicted_triangles = progress.predicted_triangles();
  progress_.triangles = std::max(progress_.triangles, progress.triangles());
  bar_.Update(progress_);
}

void ResultCollector::OnDefect(const v1::Defect& defect) {
  bar_.Clear();
  constexpr uint64_t shown = 20;
  if (++defects_ <= shown) std::cerr << "meshfront: " << defect.message() << "\n";
}

void ResultCollector::OnLevelEnd(const v1::Summary&) {
  levels_.push_back({0, {}, levels_.back().last_triangles});
  progress_ = {};
}

absl::Status ResultCollector::OnChunk(const v1::Chunk& chunk, const ChunkDecoder& decoded) {
  const Clock::time_point now = Clock::now();
  Arrival& level = levels_.back();
  if (!decoded.triangles().empty()) {
    if (level.first_triangles == Clock::time_point{}) level.first_triangles = now;
    level.last_triangles = now;
  }
  ++level.chunks;
  ChunkSpool& spool = spools_[levels_.size() - 1];
  spool.AppendAttributes(decoded.wedge_values(), decoded.corner_wedges(), decoded.groups());
  local_error_ = spool.Append(decoded.vertices(), decoded.triangles());
  MESHFRONT_RETURN_IF_ERROR(local_error_);
  if (trace_ != nullptr) local_error_ = WriteTraceLine(chunk, decoded, now);
  progress_.stage = StageName(Stage::kMesh);
  progress_.triangles = decoded.triangle_count();
  bar_.Update(progress_);
  return local_error_;
}

absl::Status ResultCollector::WriteTraceLine(const v1::Chunk& chunk, const ChunkDecoder& decoded,
                                             Clock::time_point now) {
  nlohmann::ordered_json line = {{"sequence", chunk.sequence()},
                                 {"seconds", Seconds(now - uploaded_)},
                                 {"vertices", decoded.vertex_count()},
                                 {"triangles", decoded.triangle_count()},
                                 {"open_front_edges", chunk.open_front_edges()}};
  if (spools_.size() > 1) line["level"] = levels_.size() - 1;
  return trace_->sink().Append(line.dump() + "\n");
}

void ResultCollector::FillFigures(size_t level, bool remote, ClientFigures* figures) const {
  const Arrival& arrival = levels_[level];
  const Clock::time_point begin = level > 0 ? levels_[level - 1].last_triangles : remote ? uploaded_ : begin_;
  figures->upload = level > 0 ? 0 : Seconds(uploaded_ - begin_);
  figures->engine = Seconds(arrival.last_triangles - begin);
  const bool came = arrival.first_triangles != Clock::time_point{};
  figures->first_chunk = came ? Seconds(arrival.first_triangles - uploaded_) : 0;
  figures->chunks = arrival.chunks;
}

}  // namespace meshfront
