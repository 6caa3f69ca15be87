#include "common/wire/results_wire.h"

#include <gtest/gtest.h>

#include <functional>

namespace depthfarm {
namespace {

FrameResult TestResult() {
  return {.frame = 7,
          .bundle = {.key = {1}, .stored_bytes = 900, .content_digest = {2}},
          .locations = {{"tcp://a:1", ""}, {"tcp://b:2", std::string(40, 'k')}},
          .files = {{{3}, 400}, {{4}, 450}},
          .picture_digests = {{5}, {6}}};
}

TEST(ResultsWire, EveryFieldComesBack) {
  EXPECT_EQ(FromProto(ToProto(TestResult())).value(), TestResult());
  FrameResult lost = TestResult();
  lost.locations.clear();
  EXPECT_EQ(FromProto(ToProto(lost)).value(), lost);
}

TEST(ResultsWire, HostileValuesAreRefused) {
  const auto refused = [](const std::function<void(v1::FrameResult&)>& damage) {
    v1::FrameResult proto = ToProto(TestResult());
    damage(proto);
    return FromProto(proto).status().code() == ErrorCode::kInvalidArgument;
  };
  EXPECT_TRUE(refused([](auto& r) { r.set_frame(4'000'000'000U); }));
  EXPECT_TRUE(refused([](auto& r) { r.clear_bundle(); }));
  EXPECT_TRUE(refused([](auto& r) { r.mutable_bundle()->set_stored_bytes(std::uint64_t{1} << 60); }));
  EXPECT_TRUE(refused([](auto& r) { r.mutable_locations(0)->clear_endpoint(); }));
  EXPECT_TRUE(refused([](auto& r) { r.mutable_files(0)->set_sha256("short"); }));
  EXPECT_TRUE(refused([](auto& r) { r.mutable_files(0)->set_bytes(~std::uint64_t{0}); }));
  EXPECT_TRUE(refused([](auto& r) { r.add_picture_digests("short"); }));
  EXPECT_TRUE(refused([](auto& r) {
    for (int i = 0; i < 3000; ++i) *r.add_files() = r.files(0);
  }));
}

}  // namespace
}  // namespace depthfarm
