// A meshfrontd that runs, and a caller of it: what every test over a socket needs.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <grpcpp/grpcpp.h>

#include "core/mesh/triangle_mesh.h"
#include "meshfront/v1/remesh_service.grpc.pb.h"

namespace meshfront {

// A child process with its stderr in a pipe. Killed with the object.
class ChildProcess {
 public:
  // `environment` goes beside this process's own.
  // `address_space`: bytes of memory that it may take.
  ChildProcess(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {},
               uint64_t address_space = RLIM_INFINITY);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  void Send(int signal) const;
  // The next line of its stderr; unset at its end, or after 60 s.
  std::optional<std::string> ReadLine();
  // The next line that contains `text`.
  std::optional<std::string> ReadLineWith(const std::string& text);
  // Its exit code, or 128 + the signal that ended it.
  int Wait();

 private:
  pid_t pid_ = -1;
  int stderr_ = -1;
  bool waited_ = false;
  std::string buffer_;
};

// A server on a free port, ready.
class ServerProcess : public ChildProcess {
 public:
  explicit ServerProcess(std::vector<std::string> flags = {}, const std::vector<std::string>& environment = {},
                         uint64_t address_space = RLIM_INFINITY);

  const std::string& address() const { return address_; }
  std::shared_ptr<grpc::Channel> NewChannel() const;
  std::unique_ptr<v1::MeshfrontService::Stub> NewStub() const { return v1::MeshfrontService::NewStub(NewChannel()); }
  // Largest resident memory so far.
  uint64_t PeakRssBytes() const;

 private:
  std::string address_;
};

using RemeshStream = grpc::ClientReaderWriter<v1::RemeshRequest, v1::RemeshResponse>;

// The whole request for a mesh: header, blocks of at most 1 MiB, end with its digest.
v1::Header HeaderOf(const TriangleMesh& mesh);
std::vector<v1::RemeshRequest> RequestOf(const TriangleMesh& mesh, v1::Header header);
void Send(RemeshStream& stream, const std::vector<v1::RemeshRequest>& messages);

// What came back.
struct Outcome {
  TriangleMesh mesh;  // concatenated chunks (float64 or float32)
  uint64_t chunks = 0;
  uint32_t chunks_crc32c = 0;
  bool damaged = false;  // a chunk's checksum, number or counts are wrong
  std::optional<v1::Summary> summary;
  grpc::Status status;

  void Take(const v1::MeshEvent& event);
  std::string reason() const;
  // The first detail of this type.
  template <class Detail>
  std::optional<Detail> DetailOf() const;
};
// Reads one event into the outcome; false at the end.
bool ReadEvent(RemeshStream& stream, Outcome& outcome);
void ReadToEnd(RemeshStream& stream, Outcome& outcome);
Outcome Remesh(v1::MeshfrontService::Stub& stub, grpc::ClientContext& context,
               const std::vector<v1::RemeshRequest>& messages);

}  // namespace meshfront

#include "proto/wire/errors.h"

namespace meshfront {

template <class Detail>
std::optional<Detail> Outcome::DetailOf() const {
  const google::rpc::Status details = DetailsOf(status);
  for (const google::protobuf::Any& any : details.details()) {
    Detail detail;
    if (any.UnpackTo(&detail)) return detail;
  }
  return std::nullopt;
}

}  // namespace meshfront
