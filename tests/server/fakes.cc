#include "tests/server/fakes.h"

#include <chrono>

#include "core/base/status_macros.h"
#include "proto/wire/crc32c.h"
#include "proto/wire/errors.h"

namespace meshfront {

void Signal::Set() {
  std::lock_guard lock(mutex_);
  set_ = true;
  changed_.notify_all();
}

bool Signal::IsSet() const {
  std::lock_guard lock(mutex_);
  return set_;
}

bool Signal::Wait() const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::seconds(30), [this] { return set_; });
}

absl::StatusOr<Report> EmitStrip(uint64_t triangles, MeshSink& sink, const Context& context) {
  constexpr uint64_t kPiece = 100;
  std::vector<OutputVertex> vertices;
  std::vector<Triangle> faces;
  uint32_t next_vertex = 0;
  for (uint64_t done = 0; done < triangles;) {
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    vertices.clear();
    faces.clear();
    const uint64_t end = std::min(triangles, done + kPiece);
    while (next_vertex < end + 2) {
      vertices.push_back({{next_vertex * 0.5, next_vertex % 2 * 1.0, 0}, {0, 0, 1}});
      ++next_vertex;
    }
    for (; done < end; ++done) {
      const auto first = static_cast<uint32_t>(done);
      faces.push_back({VertexId(first), VertexId(first + 1 + first % 2), VertexId(first + 2 - first % 2)});
    }
    context.Report({Stage::kMesh, triangles, done, triangles - done});
    MESHFRONT_RETURN_IF_ERROR(sink.Append({vertices, faces, {}, triangles - done}));
  }
  Report report;
  report.predicted_triangles = triangles;
  report.output.triangles = triangles;
  report.output.vertices = next_vertex;
  return report;
}

Engine StripEngine(uint64_t triangles) {
  return {.remesh = [triangles](Problem, MeshSink& sink,
                                const Context& context) { return EmitStrip(triangles, sink, context); },
          .estimate = [triangles](Problem, const Context&) -> absl::StatusOr<Estimate> {
            Estimate estimate;
            estimate.predicted_triangles = triangles;
            return estimate;
          }};
}

Engine EndlessEngine(std::shared_ptr<Signal> started, std::shared_ptr<Signal> stopped) {
  auto run = [started, stopped](const Context& context) {
    started->Set();
    absl::Status status;
    while (status.ok()) status = context.CheckStop();
    stopped->Set();
    return status;
  };
  return {
      .remesh = [run](Problem, MeshSink&, const Context& context) -> absl::StatusOr<Report> { return run(context); },
      .estimate = [run](Problem, const Context& context) -> absl::StatusOr<Estimate> { return run(context); }};
}

v1::DataBlock Block(v1::Array array, uint64_t offset, const std::string& data) {
  v1::DataBlock block;
  block.set_array(array);
  block.set_offset(offset);
  block.set_data(data);
  block.set_crc32c(Crc32c(data));
  return block;
}

v1::Header TriangleHeader() {
  v1::Header header;
  header.mutable_mesh()->set_vertex_count(3);
  header.mutable_mesh()->set_triangle_count(1);
  return header;
}

std::vector<v1::RemeshRequest> TriangleRequest(v1::Header header) {
  std::vector<v1::RemeshRequest> messages(4);
  *messages[0].mutable_header() = std::move(header);
  *messages[1].mutable_block() = Block(v1::ARRAY_POSITIONS, 0, Bytes<double>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
  *messages[2].mutable_block() = Block(v1::ARRAY_TRIANGLES, 0, Bytes<uint32_t>({0, 1, 2}));
  messages[3].mutable_end();
  return messages;
}

uint64_t Outcome::Count(v1::MeshEvent::EventCase kind) const {
  uint64_t count = 0;
  for (const v1::MeshEvent& event : events) count += event.event_case() == kind;
  return count;
}

const v1::Summary* Outcome::summary() const {
  return events.empty() || !events.back().has_summary() ? nullptr : &events.back().summary();
}

std::string Outcome::reason() const { return ReasonOf(FromGrpcStatus(status)).reason; }

void Send(RemeshStream& stream, const std::vector<v1::RemeshRequest>& messages) {
  for (const v1::RemeshRequest& message : messages) {
    if (!stream.Write(message)) break;
  }
  stream.WritesDone();
}

Outcome ReadToEnd(RemeshStream& stream) {
  Outcome outcome;
  v1::RemeshResponse response;
  while (stream.Read(&response)) outcome.events.push_back(response.event());
  outcome.status = stream.Finish();
  return outcome;
}

Outcome Exchange(v1::MeshfrontService::Stub& stub, grpc::ClientContext& context,
                 const std::vector<v1::RemeshRequest>& messages) {
  const std::unique_ptr<RemeshStream> stream = stub.Remesh(&context);
  Send(*stream, messages);
  return ReadToEnd(*stream);
}

}  // namespace meshfront
