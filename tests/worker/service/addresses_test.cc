#include "worker/service/addresses.h"

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
  EXPECT_EQ(AdvertisedEndpoint("tcp://0.0.0.0:4711", "render-07", false).value(), "tcp://render-07:4711");
  EXPECT_EQ(AdvertisedEndpoint("tcp://127.0.0.1:4711", "render-07", false).value(), "tcp://127.0.0.1:4711");
  EXPECT_EQ(AdvertisedEndpoint("tcp://10.0.0.7:4711", "gateway", true).value(), "tcp://gateway:4711");
  EXPECT_EQ(AdvertisedEndpoint("ipc:///run/farm/a", "render-07", true).value(), "ipc:///run/farm/a");
}

}  // namespace
}  // namespace depthfarm
