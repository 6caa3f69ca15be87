#ifndef DEPTHFARM_TESTS_SUPPORT_EVERY_TARGET_H_
#define DEPTHFARM_TESTS_SUPPORT_EVERY_TARGET_H_

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>

namespace depthfarm::test {

// Calls `check` with each kind of vector that this processor has.
template <typename Check>
void OnEveryTarget(const Check& check) {
  std::int64_t left = hwy::SupportedTargets();
  ASSERT_NE(left, 0);
  while (left != 0) {
    const std::int64_t target = left & -left;
    left &= left - 1;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    check();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace depthfarm::test

#endif  // DEPTHFARM_TESTS_SUPPORT_EVERY_TARGET_H_
