#include "server/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/matchers.h"

namespace meshfront {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Metrics, CountWhatEndedByCodeAndStage) {
  Metrics metrics([] { return Metrics::Levels{}; });
  metrics.Note({"Remesh", absl::StatusCode::kOk, 0.02, 1000, 50});
  metrics.Note({"Remesh", absl::StatusCode::kOk, 0.2, 1000, 50});
  metrics.Note({"Remesh", absl::StatusCode::kCancelled, 2, 500, 0});
  v1::Seconds seconds;
  seconds.set_mesh(0.05);
  metrics.Note(seconds);
  EXPECT_THAT(metrics.Text(), AllOf(HasSubstr("meshfront_calls_total{code=\"OK\",rpc=\"Remesh\"} 2\n"),
                                    HasSubstr("meshfront_calls_total{code=\"CANCELLED\",rpc=\"Remesh\"} 1\n"),
                                    HasSubstr("meshfront_received_bytes_total{rpc=\"Remesh\"} 2500\n"),
                                    HasSubstr("meshfront_triangles_total{rpc=\"Remesh\"} 100\n"),
                                    HasSubstr("meshfront_call_seconds_bucket{rpc=\"Remesh\",le=\"0.1\"} 1\n"),
                                    HasSubstr("meshfront_stage_seconds_bucket{stage=\"mesh\",le=\"0.03\"} 0\n"),
                                    HasSubstr("meshfront_stage_seconds_bucket{stage=\"mesh\",le=\"0.1\"} 1\n")));
}

TEST(Metrics, TellWhatThereIsWhenTheyAreAsked) {
  Metrics::Levels levels;
  Metrics metrics([&] { return levels; });
  EXPECT_THAT(metrics.Text(), HasSubstr("meshfront_sessions 0\n"));
  levels = {1, 2, 3, 4, 5};
  EXPECT_THAT(metrics.Text(),
              AllOf(HasSubstr("meshfront_open_calls 1\n"), HasSubstr("meshfront_running_jobs 2\n"),
                    HasSubstr("meshfront_queued_jobs 3\n"), HasSubstr("meshfront_sessions 4\n"),
                    HasSubstr("meshfront_session_bytes 5\n"), HasSubstr("process_resident_memory_bytes "),
                    Not(HasSubstr("process_resident_memory_bytes 0\n")), HasSubstr("meshfront_build_info{version=")));
}

TEST(Metrics, SayThatAPortIsTaken) {
  Metrics first([] { return Metrics::Levels{}; }), second([] { return Metrics::Levels{}; });
  const absl::StatusOr<std::string> address = first.Listen("127.0.0.1:0");
  ASSERT_TRUE(address.ok());
  EXPECT_THAT(*address, Not(HasSubstr(":0")));
  const absl::StatusOr<std::string> taken = second.Listen(*address);
  EXPECT_EQ(taken.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(taken.status().message()), HasSubstr(*address));
  first.StopListening();
  EXPECT_TRUE(second.Listen(*address).ok());
}

}  // namespace
}  // namespace meshfront
