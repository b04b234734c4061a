// Takes what a remeshing call sends: chunks to the spool of their level, progress to the terminal, a line per chunk to the trace.
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
  // A spool for each level, at least one. `trace` may be null. All outlive the collector.
  ResultCollector(std::vector<ChunkSpool>& spools, OutputFile* trace, ProgressBar& bar)
      : spools_(spools), trace_(trace), bar_(bar) {}

  void OnUploaded() override;
  void OnProgress(const v1::Progress& progress) override;
  void OnDefect(const v1::Defect& defect) override;
  void OnLevelEnd(const v1::Summary&) override;
  void OnRemovedFaces(absl::Span<const uint32_t> faces) override {
    removed_faces_.insert(removed_faces_.end(), faces.begin(), faces.end());
  }
  absl::Status OnChunk(const v1::Chunk& chunk, const ChunkDecoder& decoded) override;

  const std::vector<uint32_t>& removed_faces() const { return removed_faces_; }
  // The error of a disk that can't take the result: then the call failed on this side, not on the server's.
  const absl::Status& local_error() const { return local_error_; }
  // Fills upload, first_chunk, engine and chunks of a level. `engine` counts from the end of the one before, for the first from the
  // beginning of the call when the service is in this process.
  void FillFigures(size_t level, bool remote, ClientFigures* figures) const;

 private:
  using Clock = std::chrono::steady_clock;

  absl::Status WriteTraceLine(const v1::Chunk& chunk, const ChunkDecoder& decoded, Clock::time_point now);

  // What came of a level.
  struct Arrival {
    uint64_t chunks = 0;
    Clock::time_point first_triangles{}, last_triangles{};
  };

  std::vector<ChunkSpool>& spools_;
  OutputFile* trace_;
  ProgressBar& bar_;
  JobProgress progress_;
  absl::Status local_error_;
  std::vector<uint32_t> removed_faces_;
  uint64_t defects_ = 0;
  Clock::time_point begin_ = Clock::now(), uploaded_ = begin_;
  std::vector<Arrival> levels_ = {{0, {}, begin_}};
};

}  // namespace meshfront
