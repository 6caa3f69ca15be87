#include "worker/refinement/view_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "worker/refinement/plain_regions.h"

namespace depthfarm {
namespace {

using Source = std::shared_ptr<const int>;

// Makes ten times a number and counts how often.
class Tens {
 public:
  std::vector<int> Of(const std::vector<Source>& sources) {
    std::vector<int> values;
    for (const auto& made : made_.Of(sources, [this](int source) { return ++times_, 10 * source; }))
      values.push_back(*made);
    return values;
  }
  [[nodiscard]] int times() const { return times_; }

 private:
  LastMade<int, int> made_;
  int times_ = 0;
};

TEST(LastMade, MakesOnlyWhatTheLastOneDidNotAskFor) {
  const Source one = std::make_shared<const int>(1);
  const Source two = std::make_shared<const int>(2);
  const Source three = std::make_shared<const int>(3);
  Tens tens;
  EXPECT_THAT(tens.Of({one, two}), testing::ElementsAre(10, 20));
  EXPECT_THAT(tens.Of({three, one, two}), testing::ElementsAre(30, 10, 20));
  EXPECT_EQ(tens.times(), 3);
  EXPECT_THAT(tens.Of({two}), testing::ElementsAre(20));
  EXPECT_EQ(tens.times(), 3);
  EXPECT_THAT(tens.Of({one, two}), testing::ElementsAre(10, 20));
  EXPECT_EQ(tens.times(), 4);
}

TEST(LastMade, TellsObjectsApartNotValuesAndKeepsNoneAlive) {
  Source one = std::make_shared<const int>(1);
  const Source equal = std::make_shared<const int>(1);
  Tens tens;
  EXPECT_THAT(tens.Of({one, equal}), testing::ElementsAre(10, 10));
  EXPECT_EQ(tens.times(), 2);
  const std::weak_ptr<const int> gone = one;
  one = nullptr;
  EXPECT_TRUE(gone.expired());
  EXPECT_THAT(tens.Of({std::make_shared<const int>(5), equal}), testing::ElementsAre(50, 10));
  EXPECT_EQ(tens.times(), 3);
}

TEST(LastMade, DropsWhatIsNotAskedForBeforeItMakesMore) {
  struct Counted {
    explicit Counted(int& alive) : count(&alive) { ++*count; }
    Counted(const Counted& other) : count(other.count) { ++*count; }
    Counted& operator=(const Counted&) = delete;
    ~Counted() { --*count; }
    int* count;
  };
  int alive = 0;
  LastMade<int, Counted> memory;
  const auto make = [&](int) {
    EXPECT_LT(alive, 2);
    return Counted(alive);
  };
  const Source one = std::make_shared<const int>(1);
  for (int i = 0; i < 4; ++i) (void)memory.Of(std::vector<Source>{std::make_shared<const int>(i), one}, make);
  EXPECT_EQ(alive, 2);
  memory.Clear();
  EXPECT_EQ(alive, 0);
}

TEST(ViewMemory, GivesTheMapsAndTheSmoothedPictures) {
  ViewAnalysis analysis{.picture = YcbcrImage(4, 3, Ycbcr{100, 128, 128, 0}), .segments = {}};
  analysis.picture(1, 1).y = 160;
  analysis.segments.centers = {{1, 1}};
  const std::vector<std::shared_ptr<const ViewAnalysis>> analyses{std::make_shared<const ViewAnalysis>(analysis)};
  const RefinedView view{.planes = {{0.5F, 0, 2}}, .kept = {0}, .plane_of_pixel = {4, 3}};
  const std::vector<std::shared_ptr<const RefinedView>> views{std::make_shared<const RefinedView>(view)};
  ViewMemory memory;
  EXPECT_EQ(*memory.MapsOf(views)[0], view.Map());
  const auto smoothed = memory.SmoothedOf(analyses);
  EXPECT_EQ(smoothed[0]->colours, Blurred(analysis.picture));
  EXPECT_EQ(smoothed[0]->plain, PlainSegments(Blurred(analysis.picture), analysis.segments));
  EXPECT_EQ(memory.SmoothedOf(analyses), smoothed) << "the same object again";
  memory.Clear();
  EXPECT_NE(memory.SmoothedOf(analyses), smoothed);
}

}  // namespace
}  // namespace depthfarm
