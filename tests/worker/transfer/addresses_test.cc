#include "worker/transfer/addresses.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

std::string DefaultFor(const std::string& coordinator) {
  return DefaultArtifactEndpoint(ParseEndpoint(coordinator).value(), "7-9");
}

TEST(DefaultArtifactEndpoint, IsAsPrivateAsTheCoordinators) {
  EXPECT_EQ(DefaultFor("ipc:///run/farm/coordinator"), "ipc:///run/farm/artifacts-7-9");
  EXPECT_EQ(DefaultFor("tcp://127.0.0.1:7700"), "tcp://127.0.0.1:*");
  EXPECT_EQ(DefaultFor("tcp://localhost:7700"), "tcp://127.0.0.1:*");
  EXPECT_EQ(DefaultFor("tcp://render-07:7700"), "tcp://*:*");
}

TEST(AdvertisedEndpoint, NamesAHostThatOthersCanConnectTo) {
  const auto advertised = [](const std::string& listen, const std::string& bound, bool host_was_named) {
    return AdvertisedEndpoint(ParseEndpoint(listen).value(), bound, "render-07", host_was_named).value();
  };
  EXPECT_EQ(advertised("tcp://*:*", "tcp://[::]:4711", false), "tcp://render-07:4711");
  EXPECT_EQ(advertised("tcp://0.0.0.0:4711", "tcp://0.0.0.0:4711", false), "tcp://render-07:4711");
  EXPECT_EQ(advertised("tcp://127.0.0.1:*", "tcp://[::ffff:127.0.0.1]:4711", false), "tcp://127.0.0.1:4711");
  EXPECT_EQ(advertised("tcp://10.0.0.7:*", "tcp://10.0.0.7:4711", true), "tcp://render-07:4711");
  EXPECT_EQ(advertised("ipc:///run/farm/a", "ipc:///run/farm/a", true), "ipc:///run/farm/a");
}

}  // namespace
}  // namespace depthfarm
