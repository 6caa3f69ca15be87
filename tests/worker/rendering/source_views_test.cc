#include "worker/rendering/source_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/worker/media_cli/evaluated_scene.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;

class SourceViewsTest : public testing::Test {
 protected:
  void SetUp() override {
    depth_dir_ = scene_.WriteDepth("depth", [](DepthMap&) {}, {"cam0", "cam2"});
    const Status read = ReadSequenceWithDepth(scene_.sequence_file(), depth_dir_, input_);
    ASSERT_TRUE(read.ok()) << read.message();
  }
  // What cam1 sees, from its neighbours.
  [[nodiscard]] VirtualPicture Middle(int frame) const { return {input_.views[1].camera, frame, {"cam0", "cam2"}, 5}; }

  EvaluatedScene scene_;
  std::string depth_dir_;
  SequenceWithDepth input_;
};

TEST_F(SourceViewsTest, AViewIsTheSameAsAPictureOfAJob) {
  const Result<VirtualView> view = FindSources(input_, Middle(1));
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_EQ(view->sources, (std::vector<int>{0, 2}));
  EXPECT_EQ(ToPicture(input_, *view), Middle(1));
}

TEST_F(SourceViewsTest, ARequestThatTheDepthCannotServeIsRefused) {
  const auto failure = [&](const VirtualPicture& picture) { return FindSources(input_, picture).status().message(); };
  EXPECT_THAT(failure(Middle(2)), HasSubstr("has depth of frames 0 to 1"));
  EXPECT_THAT(failure(Middle(-1)), HasSubstr("frame -1"));
  VirtualPicture picture = Middle(0);
  picture.sources = {"cam1"};
  EXPECT_THAT(failure(picture), HasSubstr("no depth of camera 'cam1'"));
  picture.sources = {"cam9"};
  EXPECT_THAT(failure(picture), HasSubstr("no camera 'cam9'"));
}

TEST_F(SourceViewsTest, TheOrderOfRequestsAndThreadsChangesNothing) {
  std::vector<VirtualView> views;
  for (const int frame : {0, 1}) views.push_back(FindSources(input_, Middle(frame)).value());
  SourceViews together(input_);
  ASSERT_TRUE(together.Load(views, 3).ok());
  SourceViews alone(input_);
  for (const int i : {1, 0}) {
    const auto at = static_cast<std::size_t>(i);
    ASSERT_TRUE(alone.Load(std::span(&views[at], 1), 1).ok());
    const Result<SynthesizedView> one = alone.Render(views[at]);
    ASSERT_TRUE(one.ok()) << one.status().message();
    EXPECT_EQ(one->picture, together.Render(views[at])->picture) << i;
  }
}

TEST_F(SourceViewsTest, TheSourceOfAJobChangesWithItsManifest) {
  const Result<RenderSource> before = RenderSourceOf(depth_dir_);
  ASSERT_TRUE(before.ok()) << before.status().message();
  EXPECT_EQ(before->depth_dir, depth_dir_);
  EXPECT_EQ(RenderSourceOf(depth_dir_ + "/../depth").value(), *before);
  std::ofstream(depth_dir_ + "/depth.json", std::ios::app) << "\n";
  EXPECT_NE(RenderSourceOf(depth_dir_)->manifest_sha256, before->manifest_sha256);
  EXPECT_FALSE(RenderSourceOf(scene_.File("none")).ok());
}

}  // namespace
}  // namespace depthfarm
