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

absl::Status ResultCollector::OnChunk(const v1::Chunk& chunk, const ChunkDecoder& decoded) {
  const Clock::time_point now = Clock::now();
  if (!decoded.triangles().empty()) {
    if (first_triangles_ == Clock::time_point{}) first_triangles_ = now;
    last_triangles_ = now;
  }
  ++chunks_;
  spool_.AppendAttributes(decoded.wedge_values(), decoded.corner_wedges(), decoded.groups());
  local_error_ = spool_.Append(decoded.vertices(), decoded.triangles());
  MESHFRONT_RETURN_IF_ERROR(local_error_);
  if (trace_ != nullptr) local_error_ = WriteTraceLine(chunk, decoded, now);
  progress_.stage = StageName(Stage::kMesh);
  progress_.triangles = decoded.triangle_count();
  bar_.Update(progress_);
  return local_error_;
}

absl::Status ResultCollector::WriteTraceLine(const v1::Chunk& chunk, const ChunkDecoder& decoded,
                                             Clock::time_point now) {
  const nlohmann::ordered_json line = {{"sequence", chunk.sequence()},
                                       {"seconds", Seconds(now - uploaded_)},
                                       {"vertices", decoded.vertex_count()},
                                       {"triangles", decoded.triangle_count()},
                                       {"open_front_edges", chunk.open_front_edges()}};
  return trace_->sink().Append(line.dump() + "\n");
}

void ResultCollector::FillFigures(bool remote, ClientFigures* figures) const {
  figures->upload = Seconds(uploaded_ - begin_);
  figures->engine = Seconds(last_triangles_ - (remote ? uploaded_ : begin_));
  figures->first_chunk = first_triangles_ == Clock::time_point{} ? 0 : Seconds(first_triangles_ - uploaded_);
  figures->chunks = chunks_;
}

}  // namespace meshfront
