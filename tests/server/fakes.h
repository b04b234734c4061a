// Fakes for the server's tests: engines that do what a test says, and a caller that speaks the protocol.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <grpcpp/grpcpp.h>

#include "meshfront/v1/remesh_service.grpc.pb.h"
#include "server/engine.h"

namespace meshfront {

// Something that happens once, with a wait that gives up loudly.
class Signal {
 public:
  void Set();
  bool IsSet() const;
  // False after 30 s: a test that hangs fails instead.
  bool Wait() const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  bool set_ = false;
};

// A strip of `triangles` triangles, emitted in pieces of up to 100, with progress; stops when the context says so.
absl::StatusOr<Report> EmitStrip(uint64_t triangles, MeshSink& sink, const Context& context);
// Engines: one that emits a strip for every problem; one that waits until it is stopped (and says that it started).
Engine StripEngine(uint64_t triangles);
Engine EndlessEngine(std::shared_ptr<Signal> started, std::shared_ptr<Signal> stopped);

// The messages of a whole request for one triangle: header, positions, triangles, end.
v1::Header TriangleHeader();
std::vector<v1::RemeshRequest> TriangleRequest(v1::Header header = TriangleHeader());
v1::DataBlock Block(v1::Array array, uint64_t offset, const std::string& data);
template <class T>
std::string Bytes(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

using RemeshStream = grpc::ClientReaderWriter<v1::RemeshRequest, v1::RemeshResponse>;
// What came back of a call.
struct Outcome {
  std::vector<v1::MeshEvent> events;
  grpc::Status status;

  uint64_t Count(v1::MeshEvent::EventCase kind) const;
  const v1::Summary* summary() const;
  std::string reason() const;  // of ErrorInfo
};
// Writes the messages, closes, reads to the end.
Outcome Exchange(v1::MeshfrontService::Stub& stub, grpc::ClientContext& context,
                 const std::vector<v1::RemeshRequest>& messages);
// Writes the messages and closes; stops early when the call has ended.
void Send(RemeshStream& stream, const std::vector<v1::RemeshRequest>& messages);
// Reads what is left, to the end.
Outcome ReadToEnd(RemeshStream& stream);

}  // namespace meshfront
