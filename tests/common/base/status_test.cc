#include "common/base/status.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <utility>

namespace depthfarm {
namespace {

constexpr ErrorCode kAllCodes[] = {ErrorCode::kOk,          ErrorCode::kInvalidArgument, ErrorCode::kCorrupt,
                                   ErrorCode::kUnavailable, ErrorCode::kLeaseExpired,    ErrorCode::kIncompatible,
                                   ErrorCode::kCancelled,   ErrorCode::kInternal};

TEST(ErrorCode, EveryCodeHasItsOwnWord) {
  std::set<std::string_view> words;
  for (const ErrorCode code : kAllCodes) words.insert(ErrorCodeName(code));
  EXPECT_EQ(words.size(), std::size(kAllCodes));
  EXPECT_FALSE(words.contains("unknown"));
  EXPECT_EQ(ErrorCodeName(ErrorCode::kInvalidArgument), "invalid_argument");
}

TEST(ErrorCode, ValueOutsideTheListIsUnknown) { EXPECT_EQ(ErrorCodeName(static_cast<ErrorCode>(99)), "unknown"); }

TEST(Status, IsOkUnlessTold) {
  EXPECT_TRUE(Status().ok());
  EXPECT_EQ(Status().code(), ErrorCode::kOk);
  EXPECT_EQ(Status().message(), "");
}

TEST(Status, MakersSetCodeAndMessage) {
  const std::pair<Status, ErrorCode> cases[] = {{InvalidArgument("why"), ErrorCode::kInvalidArgument},
                                                {Corrupt("why"), ErrorCode::kCorrupt},
                                                {Unavailable("why"), ErrorCode::kUnavailable},
                                                {Internal("why"), ErrorCode::kInternal}};
  for (const auto& [status, code] : cases) {
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(status.code(), code);
    EXPECT_EQ(status.message(), "why");
  }
  EXPECT_EQ(Cancelled().code(), ErrorCode::kCancelled);
}

TEST(Status, ContextGoesInFrontAndKeepsTheCode) {
  const Status status = Corrupt("bad check sum").WithContext("frame 3").WithContext("job 7");
  EXPECT_EQ(status.code(), ErrorCode::kCorrupt);
  EXPECT_EQ(status.message(), "job 7: frame 3: bad check sum");
}

TEST(Status, ContextLeavesOkAlone) {
  EXPECT_TRUE(Status().WithContext("job 7").ok());
  EXPECT_EQ(Status().WithContext("job 7").message(), "");
}

TEST(Result, HoldsAValueOrTheReasonThereIsNone) {
  const Result<int> value = 5;
  ASSERT_TRUE(value.ok());
  EXPECT_TRUE(value.status().ok());
  EXPECT_EQ(value.value(), 5);
  EXPECT_EQ(*value, 5);
  const Result<int> failure = Unavailable("no such file");
  ASSERT_FALSE(failure.ok());
  EXPECT_EQ(failure.status().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(failure.status().message(), "no such file");
}

TEST(Result, ValueCanBeChangedInPlace) {
  Result<std::string> text = std::string("ab");
  text.value() += "c";
  *text += "d";
  text->push_back('e');
  EXPECT_EQ(*text, "abcde");
}

TEST(Result, MovesOutWhatCannotBeCopied) {
  Result<std::unique_ptr<int>> one = std::make_unique<int>(1);
  EXPECT_EQ(*std::move(one).value(), 1);
  Result<std::unique_ptr<int>> two = std::make_unique<int>(2);
  const std::unique_ptr<int> taken = *std::move(two);
  EXPECT_EQ(*taken, 2);
}

Status Forward(const Status& status, bool& went_on) {
  DEPTHFARM_RETURN_IF_ERROR(status);
  went_on = true;
  return {};
}

TEST(ReturnIfError, ReturnsTheFailureAndPassesOk) {
  bool went_on = false;
  EXPECT_EQ(Forward(Corrupt("x"), went_on).message(), "x");
  EXPECT_FALSE(went_on);
  EXPECT_TRUE(Forward({}, went_on).ok());
  EXPECT_TRUE(went_on);
}

TEST(ReturnIfError, EvaluatesItsExpressionOnce) {
  int calls = 0;
  const auto count = [&calls] {
    ++calls;
    return Status();
  };
  const auto run = [&]() -> Status {
    DEPTHFARM_RETURN_IF_ERROR(count());
    return {};
  };
  EXPECT_TRUE(run().ok());
  EXPECT_EQ(calls, 1);
}

TEST(ReturnIfError, IsOneStatementUnderAnIf) {
  const auto run = [](bool check) -> Status {
    if (check)
      DEPTHFARM_RETURN_IF_ERROR(Corrupt("checked"));
    else
      return Unavailable("not checked");
    return {};
  };
  EXPECT_EQ(run(true).message(), "checked");
  EXPECT_EQ(run(false).message(), "not checked");
}

Result<std::string> Joined(Result<std::unique_ptr<int>> first, const Result<int>& second) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<int> a, std::move(first));
  int b = 0;
  DEPTHFARM_ASSIGN_OR_RETURN(b, second);
  return std::to_string(*a) + std::to_string(b);
}

TEST(AssignOrReturn, DeclaresOrAssignsTheValues) { EXPECT_EQ(Joined(std::make_unique<int>(1), 2).value(), "12"); }

TEST(AssignOrReturn, ReturnsTheFirstFailure) {
  EXPECT_EQ(Joined(Corrupt("first"), Unavailable("second")).status().message(), "first");
  EXPECT_EQ(Joined(std::make_unique<int>(1), Unavailable("second")).status().code(), ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace depthfarm
