// The same mesh, bit for bit, in this process and over a socket, in chunks of any size, at any thread count, whatever the processor.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "core/io/mesh_io.h"
#include "core/remesh.h"
#include "tests/e2e/server_process.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

constexpr double kRho = 0.3;

// A smooth closed shape, and one with creases, corners and a hole: both large enough for many small chunks.
std::vector<TriangleMesh> Shapes() { return {testing::GenusThree(48), testing::PlateWithRoundHole(16, 0.4)}; }

TriangleMesh RemeshedHere(const TriangleMesh& shape) {
  RemeshOptions options;
  options.rho = kRho;
  CollectingSink sink;
  Context context;
  context.threads = 1;
  const auto report = Remesh({shape, options}, sink, context);
  EXPECT_TRUE(report.ok()) << report.status();
  return sink.mesh;
}

// `chunk_bytes`: 0 for the default.
Outcome RemeshedBy(const ServerProcess& server, const TriangleMesh& shape, uint32_t chunk_bytes) {
  v1::Header header = HeaderOf(shape);
  header.mutable_options()->set_rho(kRho);
  header.mutable_output()->set_scalar_type(v1::SCALAR_TYPE_FLOAT64);
  if (chunk_bytes > 0) header.mutable_output()->set_chunk_bytes(chunk_bytes);
  grpc::ClientContext context;
  Outcome outcome = Remesh(*server.NewStub(), context, RequestOf(shape, header));
  EXPECT_TRUE(outcome.status.ok()) << outcome.status.error_message();
  EXPECT_FALSE(outcome.damaged);
  return outcome;
}

void ExpectSame(const TriangleMesh& a, const TriangleMesh& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(SameBitsOverSocket, InChunksOfAnySize) {
  const ServerProcess server;
  uint64_t small = 0, large = 0;
  for (const TriangleMesh& shape : Shapes()) {
    const TriangleMesh here = RemeshedHere(shape);
    ASSERT_GT(here.triangles.size(), 100u);
    for (const uint32_t chunk_bytes : {16384u, 100'000u, 0u, 1u << 20}) {
      const Outcome outcome = RemeshedBy(server, shape, chunk_bytes);
      ExpectSame(outcome.mesh, here);
      if (chunk_bytes == 16384) small += outcome.chunks;
      if (chunk_bytes == 1u << 20) large += outcome.chunks;
    }
  }
  EXPECT_GT(small, large) << "the sizes were not taken";
}

TEST(SameBitsOverSocket, AtAnyThreadCount) {
  for (const char* threads : {"1", "2", "4"}) {
    const ServerProcess server({"--threads", threads});
    for (const TriangleMesh& shape : Shapes()) ExpectSame(RemeshedBy(server, shape, 0).mesh, RemeshedHere(shape));
  }
}

// The C library's functions have variants for processors with FMA, which round otherwise.
TEST(SameBitsOverSocket, WhateverTheCLibraryChoosesForTheProcessor) {
  const ServerProcess server(
      {}, {"GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-AVX2_Usable,-FMA,-FMA_Usable,-FMA4,-FMA4_Usable"});
  for (const TriangleMesh& shape : Shapes()) ExpectSame(RemeshedBy(server, shape, 0).mesh, RemeshedHere(shape));
}

std::string BytesOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The program writes the same file with the service inside of it and with a server.
TEST(SameBitsOverSocket, InAFileOfTheProgram) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "meshfront_same_bits";
  std::filesystem::create_directories(folder);
  const ServerProcess server;
  for (const TriangleMesh& shape : Shapes()) {
    const std::string in = folder / "in.ply";
    ASSERT_TRUE(WriteMeshFile(in, shape).ok());
    std::vector<std::string> files;
    for (const std::vector<std::string>& flags :
         {std::vector<std::string>{"--threads", "1"}, {"--threads", "3"}, {"--server", server.address()}}) {
      const std::string out = folder / "out.ply";
      std::vector<std::string> command = {MESHFRONT_PROGRAM, "remesh", in, out, "--quiet"};
      command.insert(command.end(), flags.begin(), flags.end());
      ASSERT_EQ(ChildProcess(command).Wait(), 0);
      files.push_back(BytesOf(out));
      std::filesystem::remove(out);
    }
    EXPECT_GT(files[0].size(), 10'000u);
    EXPECT_THAT(files, ::testing::Each(files[0]));
  }
  std::filesystem::remove_all(folder);
}

TEST(SameBitsOverSocket, InAPatchOfASession) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "meshfront_session";
  std::filesystem::create_directories(folder);
  const std::string in = folder / "in.ply", out = folder / "out.ply", session = folder / "session";
  const ServerProcess server;
  ASSERT_TRUE(WriteMeshFile(in, Shapes()[0]).ok());
  const Vec3 place = Shapes()[0].positions[0];
  const std::string region = absl::StrCat("sphere:", place.x, ",", place.y, ",", place.z, ",0.6");
  const auto run = [&](const std::string& of, const std::vector<std::string>& flags) {
    std::vector<std::string> command = {MESHFRONT_PROGRAM, "remesh",       of,         out,
                                        "--quiet",         "--patch-only", "--region", region};
    command.insert(command.end(), flags.begin(), flags.end());
    const int code = ChildProcess(command).Wait();
    return code == 0 ? BytesOf(out) : std::to_string(code);
  };
  const std::string alone = run(in, {});
  EXPECT_GT(alone.size(), 1000u);
  EXPECT_EQ(run(in, {"--server", server.address(), "--keep-session", session}), alone);
  const auto others = std::filesystem::perms::group_all | std::filesystem::perms::others_all;
  EXPECT_EQ(std::filesystem::status(session).permissions() & others, std::filesystem::perms::none) << "it is a secret";
  EXPECT_EQ(run("-", {"--server", server.address(), "--session", session}), alone);
  // The patch of a patch: of the mesh that is kept, and of the whole that the program writes.
  const std::string first = folder / "first.ply";
  const int code = ChildProcess({MESHFRONT_PROGRAM, "remesh", in, first, "--quiet", "--region", region}).Wait();
  ASSERT_EQ(code, 0);
  const std::string of_first = run(first, {});
  EXPECT_NE(of_first, alone);
  EXPECT_EQ(run("-", {"--server", server.address(), "--session", session, "--update-session"}), alone);
  EXPECT_EQ(run("-", {"--server", server.address(), "--session", session}), of_first);
  EXPECT_EQ(run(in, {"--server", server.address(), "--keep-session", session, "--update-session"}), alone);
  EXPECT_EQ(run("-", {"--server", server.address(), "--session", session}), of_first);
  EXPECT_EQ(run(in, {"--server", server.address(), "--update-session"}), "2") << "of which session";
  const std::string stats = folder / "stats.json";
  EXPECT_EQ(run("-", {"--server", server.address(), "--session", session, "--stats", stats}), of_first);
  EXPECT_THAT(BytesOf(stats), ::testing::HasSubstr("\"revision\": 0"));
  std::ofstream(session) << "0123456789abcdef\n";
  EXPECT_EQ(run("-", {"--server", server.address(), "--session", session}), "3") << "no such session";
  const std::string errors = folder / "errors";
  ChildProcess({"/bin/sh", "-c",
                absl::StrCat("'", MESHFRONT_PROGRAM, "' remesh - '", out, "' --region ", region, " --server ",
                             server.address(), " --session '", session, "' 2>'", errors, "'")})
      .Wait();
  EXPECT_THAT(BytesOf(errors), ::testing::HasSubstr(absl::StrCat("session ", session, ": session_id is not known")));
  EXPECT_EQ(run(in, {"--session", session}), "2") << "no server";
  EXPECT_EQ(run(in, {"--server", server.address(), "--session", session}), "2") << "IN beside it";
  EXPECT_EQ(run("-", {"--server", server.address(), "--session", in + "x"}), "2") << "no such file";
  EXPECT_EQ(run("-", {"--server", server.address(), "--session", session, "--lod", "0.5,1"}), "2") << "many at a time";
  std::filesystem::remove_all(folder);
}

// The answer of an update is lost; it is sent again as it was, and refused where it names the revision that it is of.
TEST(SameBitsOverSocket, InAnUpdateThatIsSentTwice) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "meshfront_sent_twice";
  std::filesystem::create_directories(folder);
  const std::string in = folder / "in.ply", out = folder / "out.ply", session = folder / "session",
                    faces = folder / "faces";
  const ServerProcess server;
  ASSERT_TRUE(WriteMeshFile(in, Shapes()[0]).ok());
  std::ofstream list(faces);
  for (int face = 0; face < 400; ++face) list << face << "\n";
  list.close();
  const std::string errors = folder / "errors";
  const auto run = [&](const std::string& flags) {
    return ChildProcess({"/bin/sh", "-c",
                         absl::StrCat("'", MESHFRONT_PROGRAM, "' remesh ", flags, " --quiet --server ",
                                      server.address(), " --region 'faces:", faces, "' 2>'", errors, "'")})
        .Wait();
  };
  const std::string again = absl::StrCat("- '", out, "' --session '", session, "' --session-revision ");
  ASSERT_EQ(run(absl::StrCat("'", in, "' '", out, "' --keep-session '", session, "'")), 0);
  ASSERT_EQ(run(again + "0 --update-session"), 0);
  ASSERT_EQ(run(again + "1"), 0);
  const std::string of_one_update = BytesOf(out);
  EXPECT_EQ(run(again + "0 --update-session"), 3);
  EXPECT_THAT(BytesOf(errors), ::testing::HasSubstr(absl::StrCat("session ", session,
                                                                 ": session_revision is 0; the session's mesh "
                                                                 "was replaced, and is at 1 now")));
  EXPECT_EQ(BytesOf(out), of_one_update) << "what was there stays";
  ASSERT_EQ(run(again + "1"), 0);
  EXPECT_EQ(BytesOf(out), of_one_update) << "it was not made twice";
  std::filesystem::remove_all(folder);
}

// What the session can't hold is a result all the same, and the exit code says that the session has not got it.
TEST(SameBitsOverSocket, InAnUpdateThatIsTooLargeForTheSession) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "meshfront_too_large";
  std::filesystem::create_directories(folder);
  const std::string in = folder / "in.ply", out = folder / "out.ply", session = folder / "session";
  const ServerProcess server({"--max-session-mb", "1"});
  ASSERT_TRUE(WriteMeshFile(in, testing::Icosphere(3)).ok());
  const auto run = [&](const std::vector<std::string>& arguments) {
    std::vector<std::string> command = {MESHFRONT_PROGRAM, "remesh", "--quiet", "--rho", "0.03"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return ChildProcess(command).Wait();
  };
  ASSERT_EQ(run({in, out, "--server", server.address(), "--keep-session", session}), 0);
  const std::string whole = BytesOf(out);
  std::filesystem::remove(out);
  EXPECT_EQ(run({"-", out, "--server", server.address(), "--session", session, "--update-session"}), 5);
  EXPECT_EQ(BytesOf(out), whole);
  // Nor is a session opened with it, and the file still names the one that there is.
  const std::string name = BytesOf(session);
  std::filesystem::remove(out);
  EXPECT_EQ(run({in, out, "--server", server.address(), "--keep-session", session, "--update-session"}), 5);
  EXPECT_EQ(BytesOf(out), whole);
  EXPECT_EQ(BytesOf(session), name);
  std::filesystem::remove_all(folder);
}

// Several meshes come over one stream.
TEST(SameBitsOverSocket, InAFileOfAllLevelsOfDetail) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "meshfront_same_levels";
  std::filesystem::create_directories(folder);
  const ServerProcess server;
  ASSERT_TRUE(WriteMeshFile(folder / "in.ply", testing::Cube(4)).ok());
  std::vector<std::string> files;
  for (const std::vector<std::string>& flags : {std::vector<std::string>{}, {"--server", server.address()}}) {
    const std::string out = folder / "out.glb";
    std::vector<std::string> command = {MESHFRONT_PROGRAM, "remesh", folder / "in.ply", out, "--lod", "0.3,0.8,1.5"};
    command.insert(command.end(), flags.begin(), flags.end());
    ASSERT_EQ(ChildProcess(command).Wait(), 0);
    files.push_back(BytesOf(out));
    std::filesystem::remove(out);
  }
  EXPECT_GT(files[0].size(), 1'000u);
  EXPECT_EQ(files[0], files[1]);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace meshfront
