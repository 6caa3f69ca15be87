#include "common/transport/endpoint.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

TEST(Endpoint, KeepsItsParts) {
  for (const char* text :
       {"tcp://127.0.0.1:7700", "tcp://*:*", "tcp://node-7.lan:1", "tcp://[::1]:65535", "ipc:///tmp/a/b"}) {
    const Result<Endpoint> endpoint = ParseEndpoint(text);
    ASSERT_TRUE(endpoint.ok()) << endpoint.status().message();
    EXPECT_EQ(endpoint->ToString(), text);
  }
}

TEST(Endpoint, OtherFormsAreRefused) {
  for (const char* text :
       {"", "127.0.0.1:7700", "tcp://", "tcp://host", "tcp://host:", "tcp://:7700", "tcp://host:0", "tcp://host:65536",
        "tcp://host:77a", "tcp://::1:7700", "tcp://a b:1", "udp://h:1", "ipc://", "inproc://x"}) {
    EXPECT_EQ(ParseEndpoint(text).status().code(), ErrorCode::kInvalidArgument) << text;
  }
  EXPECT_FALSE(ParseEndpoint("ipc://" + std::string(108, 'a')).ok());
  EXPECT_TRUE(ParseEndpoint("ipc://" + std::string(107, 'a')).ok());
}

TEST(Security, InsecureTcpIsForLoopbackOnly) {
  const auto check = [](const char* text, bool keys, bool insecure) {
    return CheckSecurity(ParseEndpoint(text).value(), keys, insecure).ok();
  };
  EXPECT_TRUE(check("ipc:///tmp/a", false, false));
  EXPECT_TRUE(check("tcp://*:7700", true, false));
  EXPECT_FALSE(check("tcp://127.0.0.1:7700", false, false));
  EXPECT_TRUE(check("tcp://127.0.0.1:7700", false, true));
  EXPECT_TRUE(check("tcp://127.1.2.3:7700", false, true));
  EXPECT_TRUE(check("tcp://[::1]:7700", false, true));
  EXPECT_FALSE(check("tcp://*:7700", false, true));
  EXPECT_FALSE(check("tcp://0.0.0.0:7700", false, true));
  EXPECT_FALSE(check("tcp://128.0.0.1:7700", false, true));
  EXPECT_FALSE(check("tcp://127.0.0.1.example.org:7700", false, true));
}

}  // namespace
}  // namespace depthfarm
