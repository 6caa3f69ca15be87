#include "common/files/path_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::HasSubstr;
using testing::Not;

PathMap MapOf(const std::vector<std::string>& rules) {
  Result<PathMap> map = PathMap::Parse(rules);
  EXPECT_TRUE(map.ok()) << map.status().message();
  return map.ok() ? std::move(*map) : PathMap();
}

std::string RefusalOf(const std::vector<std::string>& rules) {
  const Result<PathMap> map = PathMap::Parse(rules);
  EXPECT_EQ(map.status().code(), ErrorCode::kInvalidArgument);
  return map.status().message();
}

TEST(PathMap, LeavesPathsAloneWithoutRules) {
  EXPECT_EQ(PathMap().Map("/a/b.png"), "/a/b.png");
  EXPECT_EQ(PathMap().Map(""), "");
}

TEST(PathMap, ReplacesWholeComponentsAtTheBeginning) {
  const PathMap map = MapOf({"/shared=/mnt/nas"});
  EXPECT_EQ(map.Map("/shared/in/cam0/0000.png"), "/mnt/nas/in/cam0/0000.png");
  EXPECT_EQ(map.Map("/shared"), "/mnt/nas");
  EXPECT_EQ(map.Map("/shared/"), "/mnt/nas/");
  EXPECT_EQ(map.Map("/sharedless/a.png"), "/sharedless/a.png");
  EXPECT_EQ(map.Map("/else/shared/a.png"), "/else/shared/a.png");
  EXPECT_EQ(map.Map(""), "");
}

TEST(PathMap, TakesTheRuleWithTheLongestBeginning) {
  const PathMap map = MapOf({"/a=/one", "/a/b/c=/three", "/a/b=/two"});
  EXPECT_EQ(map.Map("/a/x"), "/one/x");
  EXPECT_EQ(map.Map("/a/b/x"), "/two/x");
  EXPECT_EQ(map.Map("/a/b/c/x"), "/three/x");
  EXPECT_EQ(map.Map("/a/bc/x"), "/one/bc/x");
}

TEST(PathMap, MapsOnceOnly) {
  const PathMap map = MapOf({"/a=/b", "/b=/a"});
  EXPECT_EQ(map.Map("/a/x"), "/b/x");
  EXPECT_EQ(map.Map("/b/x"), "/a/x");
}

TEST(PathMap, ReadsOnlyOneSpellingOfAPath) {
  const PathMap map = MapOf({"//a/./b/=/c/"});
  EXPECT_EQ(map.Map("/a//b/x"), "/c/x");
  EXPECT_EQ(map.Map("/a/q/../b/x"), "/c/x");
  EXPECT_EQ(map.Map("/a/b/../x"), "/a/b/../x") << "is /a/x, which no rule maps";
}

TEST(PathMap, MapsTheRootAndToTheRoot) {
  EXPECT_EQ(MapOf({"/=/chroot"}).Map("/a/x"), "/chroot/a/x");
  EXPECT_EQ(MapOf({"/data=/"}).Map("/data/x"), "/x");
}

TEST(PathMap, SplitsAtTheFirstEqualsSignBeforeAPath) { EXPECT_EQ(MapOf({"/a=b=/c=d"}).Map("/a=b/x"), "/c=d/x"); }

TEST(PathMap, RefusesRulesThatAreNone) {
  EXPECT_THAT(RefusalOf({"/a"}), HasSubstr("'/a': expected FROM=TO"));
  EXPECT_THAT(RefusalOf({"/a=b"}), HasSubstr("expected FROM=TO"));
  EXPECT_THAT(RefusalOf({"a=/b"}), HasSubstr("'a' is not an absolute path"));
  EXPECT_THAT(RefusalOf({"=/b"}), HasSubstr("'' is not an absolute path"));
  EXPECT_THAT(RefusalOf({"/a/../b=/c"}), HasSubstr("without '..'"));
  EXPECT_THAT(RefusalOf({"/a=/b/.."}), HasSubstr("without '..'"));
  EXPECT_THAT(RefusalOf({"/a=/b", "/a/=/c"}), HasSubstr("/a is mapped twice"));
}

TEST(PathMap, ExplainsFailuresThatNameWhatThisHostOpened) {
  const PathMap map = MapOf({"/shared=/mnt/nas", "/out=/mnt/out"});
  const Status failure = map.Explain(Unavailable("frame 3: /mnt/nas/cam0/0003.png: cannot open the file"));
  EXPECT_EQ(failure.code(), ErrorCode::kUnavailable);
  EXPECT_EQ(failure.message(),
            "frame 3: /mnt/nas/cam0/0003.png: cannot open the file (/mnt/nas is /shared of the job: --path-map)");
  EXPECT_THAT(map.Explain(Unavailable("/mnt/nasty: is full")).message(), Not(HasSubstr("--path-map")));
  EXPECT_THAT(map.Explain(Unavailable("/x/mnt/nas: is full")).message(), Not(HasSubstr("--path-map")));
  EXPECT_TRUE(map.Explain(Status()).ok());
}

}  // namespace
}  // namespace depthfarm
