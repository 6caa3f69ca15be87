#include "common/geometry/symmetric_solve.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

// L L^T of L = (2 0 0; 1 3 0; -1 2 1) and H p of p = (1, -2, 3), worked out by hand.
constexpr std::array<double, 6> kH{4, 2, -2, 10, 5, 6};
constexpr std::array<double, 3> kP{1, -2, 3};
constexpr std::array<double, 3> kR{-6, -3, 6};

TEST(SymmetricSolve, FindsTheSolution) {
  std::array<double, 3> p{};
  ASSERT_TRUE(SolveSymmetric(kH, kR, p));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(p[i], kP[i], 1e-12);
}

TEST(SymmetricSolve, OneFactorServesManyRightSides) {
  const SymmetricFactor factor(kH);
  ASSERT_TRUE(factor.definite());
  EXPECT_NEAR(factor.Solve(kR)[2], 3, 1e-12);
  EXPECT_NEAR(factor.Solve({-12, -6, 12})[2], 6, 1e-12);
}

TEST(SymmetricSolve, TellsWhatIsNotDefinite) {
  EXPECT_FALSE(SymmetricFactor().definite());
  std::array<double, 3> p = kP;
  for (const std::array<double, 6>& h :
       {std::array<double, 6>{0, 0, 0, 1, 0, 1}, std::array<double, 6>{1, 2, 0, 1, 0, 1},
        std::array<double, 6>{1, 0, 0, 1, 1, 1}, std::array<double, 6>{-1, 0, 0, 1, 0, 1}})
    EXPECT_FALSE(SolveSymmetric(h, kR, p));
  EXPECT_EQ(p, kP);
}

}  // namespace
}  // namespace depthfarm
