#include "tests/e2e/server_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "proto/wire/convert.h"
#include "proto/wire/crc32c.h"
#include "proto/wire/sha256.h"

namespace meshfront {
namespace {

constexpr int kReadTimeoutMs = 60'000;

// Runs in the child: nothing but what is safe after fork.
[[noreturn]] void Become(char* const* arguments, char* const* environment, int stderr_pipe, uint64_t address_space) {
  const rlimit limit{address_space, address_space};
  if (address_space != RLIM_INFINITY) setrlimit(RLIMIT_AS, &limit);
  dup2(stderr_pipe, STDERR_FILENO);
  execve(arguments[0], arguments, environment);
  _exit(127);
}

std::vector<char*> Pointers(const std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  for (const std::string& s : strings) pointers.push_back(const_cast<char*>(s.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, const std::vector<std::string>& environment,
                           uint64_t address_space) {
  std::vector<std::string> all_environment = environment;
  for (char** e = environ; *e != nullptr; ++e) all_environment.push_back(*e);
  const std::vector<char*> argv = Pointers(arguments), envp = Pointers(all_environment);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;
  pid_ = fork();
  if (pid_ == 0) Become(argv.data(), envp.data(), ends[1], address_space);
  close(ends[1]);
  stderr_ = ends[0];
}

ChildProcess::~ChildProcess() {
  if (!waited_ && pid_ > 0) {
    kill(pid_, SIGKILL);
    Wait();
  }
  if (stderr_ >= 0) close(stderr_);
}

void ChildProcess::Send(int signal) const { kill(pid_, signal); }

std::optional<std::string> ChildProcess::ReadLine() {
  while (true) {
    if (const size_t end = buffer_.find('\n'); end != std::string::npos) {
      std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      return line;
    }
    pollfd waiting{stderr_, POLLIN, 0};
    if (poll(&waiting, 1, kReadTimeoutMs) <= 0) return std::nullopt;
    char bytes[4096];
    const ssize_t count = read(stderr_, bytes, sizeof bytes);
    if (count <= 0) return std::nullopt;
    buffer_.append(bytes, count);
  }
}

std::optional<std::string> ChildProcess::ReadLineWith(const std::string& text) {
  std::optional<std::string> line = ReadLine();
  while (line && !absl::StrContains(*line, text)) line = ReadLine();
  return line;
}

int ChildProcess::Wait() {
  int status = 0;
  waitpid(pid_, &status, 0);
  waited_ = true;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

namespace {

std::vector<std::string> WithFreePort(std::vector<std::string> flags) {
  flags.insert(flags.begin(), {MESHFRONTD, "--listen", "127.0.0.1:0"});
  return flags;
}

}  // namespace

ServerProcess::ServerProcess(std::vector<std::string> flags, const std::vector<std::string>& environment,
                             uint64_t address_space)
    : ChildProcess(WithFreePort(std::move(flags)), environment, address_space) {
  const std::string prefix = "meshfrontd listening on ";
  const std::optional<std::string> ready = ReadLineWith(prefix);
  EXPECT_TRUE(ready && absl::StartsWith(*ready, prefix)) << "the server did not start";
  if (ready) address_ = ready->substr(prefix.size());
}

std::shared_ptr<grpc::Channel> ServerProcess::NewChannel() const {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // each its own connection
  return grpc::CreateCustomChannel(address_, grpc::InsecureChannelCredentials(), arguments);
}

uint64_t ServerProcess::PeakRssBytes() const {
  std::ifstream status(absl::StrCat("/proc/", pid(), "/status"));
  for (std::string word; status >> word;) {
    uint64_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024;
  }
  ADD_FAILURE() << "no VmHWM";
  return 0;
}

v1::Header HeaderOf(const TriangleMesh& mesh) {
  v1::Header header;
  header.mutable_mesh()->set_vertex_count(mesh.positions.size());
  header.mutable_mesh()->set_triangle_count(mesh.triangles.size());
  return header;
}

std::vector<v1::RemeshRequest> RequestOf(const TriangleMesh& mesh, v1::Header header) {
  std::vector<v1::RemeshRequest> messages(1);
  *messages[0].mutable_header() = std::move(header);
  Sha256 hash;
  const auto add = [&](v1::Array array, const void* bytes, size_t size) {
    const absl::string_view all(static_cast<const char*>(bytes), size);
    for (size_t offset = 0; offset < size; offset += kMaxBlockBytes) {
      const absl::string_view data = all.substr(offset, kMaxBlockBytes);
      v1::DataBlock& block = *messages.emplace_back().mutable_block();
      block.set_array(array);
      block.set_offset(offset);
      block.set_data(std::string(data));
      block.set_crc32c(Crc32c(data));
      hash.Update(data);
    }
  };
  add(v1::ARRAY_POSITIONS, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3));
  add(v1::ARRAY_TRIANGLES, mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle));
  messages.emplace_back().mutable_end()->set_sha256(hash.Finish());
  return messages;
}

void Send(RemeshStream& stream, const std::vector<v1::RemeshRequest>& messages) {
  for (const v1::RemeshRequest& message : messages) {
    if (!stream.Write(message)) break;
  }
  stream.WritesDone();
}

void Outcome::Take(const v1::MeshEvent& event) {
  if (event.has_summary()) summary = event.summary();
  if (!event.has_chunk()) return;
  const v1::Chunk& chunk = event.chunk();
  const size_t scalar = chunk.positions().size() == chunk.vertex_count() * 24u ? 8 : 4;
  damaged |= summary.has_value() || chunk.sequence() != chunks || chunk.first_vertex() != mesh.positions.size() ||
             chunk.crc32c() != ChunkCrc32c(chunk) || chunk.positions().size() != 3 * scalar * chunk.vertex_count() ||
             chunk.indices().size() != 12u * chunk.triangle_count();
  ++chunks;
  chunks_crc32c = ExtendChunksCrc32c(chunks_crc32c, chunk.crc32c());
  for (size_t i = 0; i < chunk.vertex_count(); ++i) {
    double xyz[3];
    for (size_t axis = 0; axis < 3; ++axis) {
      const char* from = chunk.positions().data() + (3 * i + axis) * scalar;
      float narrow;
      if (scalar == 8) {
        std::memcpy(&xyz[axis], from, 8);
      } else {
        std::memcpy(&narrow, from, 4);
        xyz[axis] = narrow;
      }
    }
    mesh.positions.push_back({xyz[0], xyz[1], xyz[2]});
  }
  const size_t first = mesh.triangles.size();
  mesh.triangles.resize(first + chunk.triangle_count());
  std::memcpy(mesh.triangles.data() + first, chunk.indices().data(), chunk.indices().size());
  for (size_t t = first; t < mesh.triangles.size(); ++t) {
    for (const VertexId v : mesh.triangles[t]) damaged |= v.index() >= mesh.positions.size();
  }
}

std::string Outcome::reason() const { return ReasonOf(FromGrpcStatus(status)).reason; }

bool ReadEvent(RemeshStream& stream, Outcome& outcome) {
  v1::RemeshResponse response;
  if (!stream.Read(&response)) return false;
  outcome.Take(response.event());
  return true;
}

void ReadToEnd(RemeshStream& stream, Outcome& outcome) {
  while (ReadEvent(stream, outcome)) {
  }
  outcome.status = stream.Finish();
}

Outcome Remesh(v1::MeshfrontService::Stub& stub, grpc::ClientContext& context,
               const std::vector<v1::RemeshRequest>& messages) {
  const std::unique_ptr<RemeshStream> stream = stub.Remesh(&context);
  Send(*stream, messages);
  Outcome outcome;
  ReadToEnd(*stream, outcome);
  return outcome;
}

}  // namespace meshfront
