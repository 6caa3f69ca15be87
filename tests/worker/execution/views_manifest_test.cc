#include "worker/execution/views_manifest.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace depthfarm {
namespace {

JobConfig Config() {
  JobConfig config;
  config.sequence_name = "line";
  config.render = RenderSource{"/depth", {0xab}};
  return config;
}

VirtualPicture View(int number) {
  VirtualPicture view;
  view.frame = 3;
  view.sources = {"cam0", "cam1"};
  view.number = number;
  view.camera.name = "between";
  view.camera.width = 64;
  view.camera.height = 48;
  view.camera.intrinsics(0, 2) = 31.5;
  view.camera.cam_from_world_translation << 1, 2, 3;
  return view;
}

TEST(ViewsManifest, NamesEveryViewAndWhatItWasMadeFrom) {
  const Result<std::string> text =
      FormatViewsManifest(Config(), {View(0), View(12)}, {{"views/0000.png", {1}, 10}, {"views/0012.png", {2}, 11}});
  ASSERT_TRUE(text.ok()) << text.status().message();
  const nlohmann::json json = nlohmann::json::parse(*text);
  EXPECT_EQ(json["format"], "depthfarm-views-1");
  EXPECT_EQ(json["sequence"], "line");
  EXPECT_EQ(json["depthManifestSha256"], "ab" + std::string(62, '0'));
  ASSERT_EQ(json["views"].size(), 2U);
  const nlohmann::json& view = json["views"][1];
  EXPECT_EQ(view["file"], "views/0012.png");
  EXPECT_EQ(view["sha256"], "02" + std::string(62, '0'));
  EXPECT_EQ(view["frame"], 3);
  EXPECT_EQ(view["from"], (std::vector<std::string>{"cam0", "cam1"}));
  EXPECT_EQ(view["K"][0][2], 31.5);
  EXPECT_EQ(view["R"][1], (std::vector<double>{0, 1, 0}));
  EXPECT_EQ(view["t"], (std::vector<double>{1, 2, 3}));
}

TEST(ViewsManifest, FilesThatAreNotTheViewsAreRefused) {
  EXPECT_FALSE(FormatViewsManifest(Config(), {View(0)}, {}).ok());
  EXPECT_FALSE(FormatViewsManifest(Config(), {View(0)}, {{"views/0001.png", {}, 1}}).ok());
}

}  // namespace
}  // namespace depthfarm
