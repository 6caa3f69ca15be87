#include "common/text/text_table.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace depthfarm {
namespace {

TEST(FormatTable, AlignsColumnsAndLeavesNoSpacesAtTheEnd) {
  EXPECT_EQ(FormatTable({{"stage", "CPU", "note"}, {"refine", "12 s", ""}, {"emit"}}, {false, true, false}),
            "stage    CPU  note\n"
            "refine  12 s\n"
            "emit\n");
  EXPECT_EQ(FormatTable({{"a"}}, {true}, 3), "   a\n");
  EXPECT_EQ(FormatTable({}, {}), "");
}

TEST(TextTable, NamesToTheLeftNumbersToTheRight) {
  TextTable table({"view", "from", "PSNR"}, 2);
  table.Add({"cam1", "cam0 cam2", "9.5"});
  table.Add({"mean", "", "31.25"});
  std::ostringstream out;
  table.Print(out);
  EXPECT_EQ(out.str(),
            "  view  from        PSNR\n"
            "  cam1  cam0 cam2    9.5\n"
            "  mean             31.25\n");
}

TEST(Decimal, SaysWhatIsNoNumber) {
  EXPECT_EQ(Decimal(1.005, 1), "1.0");
  EXPECT_EQ(Decimal(-2, 2), "-2.00");
  EXPECT_EQ(Decimal(std::numeric_limits<double>::quiet_NaN(), 2), "-");
  EXPECT_EQ(Decimal(std::numeric_limits<double>::infinity(), 2), "inf");
}

TEST(WithThousands, GroupsDigits) {
  EXPECT_EQ(WithThousands(0), "0");
  EXPECT_EQ(WithThousands(999), "999");
  EXPECT_EQ(WithThousands(1000), "1,000");
  EXPECT_EQ(WithThousands(1234567), "1,234,567");
}

}  // namespace
}  // namespace depthfarm
