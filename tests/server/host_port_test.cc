// Addresses as flags spell them.
#include "proto/wire/host_port.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/config.h"

namespace meshfront {
namespace {

using ::testing::HasSubstr;

TEST(CheckHostPort, TakesNamesAndAddressesWithAPort) {
  for (const char* good : {"127.0.0.1:0", "localhost:1", "a-b.example.org:65535", "[::1]:50051", "[fe80::1%eth0]:7"})
    EXPECT_TRUE(CheckHostPort("--listen", good, 0).ok()) << good;
  EXPECT_FALSE(CheckHostPort("--server", "127.0.0.1:0", 1).ok());
}

TEST(CheckHostPort, NamesTheFlagTheValueAndTheFormat) {
  for (const char* bad : {"127.0.0.1:99999", "127.0.0.1:65536", "127.0.0.1", "foo", "", ":1", "foo:", "foo:x", "foo:-1",
                          "foo:+1", "foo: 1", "::1:50051", "[::1]", "[]:1", "[::1:1", "a b:1", "http://a:1"}) {
    const absl::Status status = CheckHostPort("--listen", bad, 0);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad;
    EXPECT_THAT(std::string(status.message()), HasSubstr("--listen is ")) << bad;
    EXPECT_THAT(std::string(status.message()), HasSubstr("HOST:PORT with a port from 0 to 65535")) << bad;
  }
}

TEST(CheckListenAddress, TakesASocketOfTheFileSystemToo) {
  EXPECT_TRUE(CheckListenAddress("--listen", "unix:/tmp/socket").ok());
  EXPECT_FALSE(CheckListenAddress("--listen", "/tmp/socket").ok());
}

}  // namespace
}  // namespace meshfront
