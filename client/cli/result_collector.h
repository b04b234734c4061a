// Takes what a remeshing call sends: chunks to the spool, progress to the terminal, a line per chunk to the trace.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "client/chunk_spool.h"
#include "client/cli/progress_bar.h"
#include "client/cli/stats.h"
#include "client/output_file.h"
#include "client/remesh_client.h"

namespace meshfront {

class ResultCollector : public RemeshObserver {
 public:
  // `trace` may be null. All outlive the collector.
  ResultCollector(ChunkSpool& spool, OutputFile* trace, ProgressBar& bar) : spool_(spool), trace_(trace), bar_(bar) {}

  void OnUploaded() override;
  void OnProgress(const v1::Progress& progress) override;
  void OnDefect(const v1::Defect& defect) override;
  void OnRemovedFaces(absl::Span<const uint32_t> faces) override {
    removed_faces_.insert(removed_faces_.end(), faces.begin(), faces.end());
  }
  absl::Status OnChunk(const v1::Chunk& chunk, const ChunkDecoder& decoded) override;

  const std::vector<uint32_t>& removed_faces() const { return removed_faces_; }
  // The error of a disk that can't take the result: then the call failed on this side, not on the server's.
  const absl::Status& local_error() const { return local_error_; }
  // Fills upload, first_chunk, engine and chunks. `engine` counts from the beginning of the call when the service is in this process.
  void FillFigures(bool remote, ClientFigures* figures) const;

 private:
  using Clock = std::chrono::steady_clock;

  absl::Status WriteTraceLine(const v1::Chunk& chunk, const ChunkDecoder& decoded, Clock::time_point now);

  ChunkSpool& spool_;
  OutputFile* trace_;
  ProgressBar& bar_;
  JobProgress progress_;
  absl::Status local_error_;
  std::vector<uint32_t> removed_faces_;
  uint64_t chunks_ = 0, defects_ = 0;
  Clock::time_point begin_ = Clock::now(), uploaded_ = begin_, first_triangles_{}, last_triangles_ = begin_;
};

}  // namespace meshfront
