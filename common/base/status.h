#ifndef DEPTHFARM_COMMON_BASE_STATUS_H_
#define DEPTHFARM_COMMON_BASE_STATUS_H_

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace depthfarm {

// One code per reaction a caller can have; the story goes into the message.
enum class ErrorCode {
  kOk,
  kInvalidArgument,  // the job or its input is wrong: tell its submitter, never retry
  kCorrupt,          // a file or message fails its check: fetch again once, then fail the task
  kUnavailable,      // peer, file or memory is out of reach: retry elsewhere
  kLeaseExpired,     // the work is someone else's now: drop the result
  kIncompatible,     // the peer speaks another protocol or algorithm version: refuse it
  kCancelled,        // the job's owner or a signal asked to stop: no result, no blame
  kInternal,         // a bug here: fail the task, keep the evidence
};

// Stable lower-case word for logs and the wire, e.g. "invalid_argument".
[[nodiscard]] std::string_view ErrorCodeName(ErrorCode code);

// Outcome of an operation that users, files or peers can make fail. Messages name the thing, the value and the bound.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(ErrorCode code, std::string message) : code_(code), message_(std::move(message)) {}

  [[nodiscard]] bool ok() const { return code_ == ErrorCode::kOk; }
  [[nodiscard]] ErrorCode code() const { return code_; }
  [[nodiscard]] const std::string& message() const { return message_; }

  // The same failure told from farther out: "context: message". Ok stays ok.
  [[nodiscard]] Status WithContext(std::string_view context) const;

 private:
  ErrorCode code_ = ErrorCode::kOk;
  std::string message_;
};

[[nodiscard]] inline Status InvalidArgument(std::string message) {
  return {ErrorCode::kInvalidArgument, std::move(message)};
}
[[nodiscard]] inline Status Corrupt(std::string message) { return {ErrorCode::kCorrupt, std::move(message)}; }
[[nodiscard]] inline Status Unavailable(std::string message) { return {ErrorCode::kUnavailable, std::move(message)}; }
[[nodiscard]] inline Status Internal(std::string message) { return {ErrorCode::kInternal, std::move(message)}; }
[[nodiscard]] inline Status Cancelled() { return {ErrorCode::kCancelled, "cancelled"}; }

// A value, or why there is none. `value()` of a failed Result is a broken invariant and throws
// std::bad_optional_access: ask ok() first.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}          // NOLINT(google-explicit-constructor): reads as `return value`
  Result(Status status) : status_(std::move(status)) {}  // NOLINT(google-explicit-constructor): reads as `return error`

  [[nodiscard]] bool ok() const { return value_.has_value(); }
  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] T& value() & { return value_.value(); }
  [[nodiscard]] const T& value() const& { return value_.value(); }
  [[nodiscard]] T&& value() && { return std::move(value_).value(); }
  T* operator->() { return &value_.value(); }
  const T* operator->() const { return &value_.value(); }
  T& operator*() & { return value_.value(); }
  const T& operator*() const& { return value_.value(); }
  T&& operator*() && { return std::move(value_).value(); }

 private:
  Status status_;
  std::optional<T> value_;
};

// Returns the failure of `expression` (a Status) to the caller.
#define DEPTHFARM_RETURN_IF_ERROR(expression)              \
  do {                                                     \
    ::depthfarm::Status depthfarm_status_ = (expression);  \
    if (!depthfarm_status_.ok()) return depthfarm_status_; \
  } while (false)

// NOLINTBEGIN(bugprone-macro-parentheses): `lhs` may declare a variable, which cannot stand in parentheses
// Declares `lhs` from a Result, or returns its failure: DEPTHFARM_ASSIGN_OR_RETURN(Camera camera, ReadCamera(file)).
#define DEPTHFARM_CONCAT_INNER_(a, b) a##b
#define DEPTHFARM_CONCAT_(a, b) DEPTHFARM_CONCAT_INNER_(a, b)
#define DEPTHFARM_ASSIGN_OR_RETURN(lhs, expression) \
  DEPTHFARM_ASSIGN_OR_RETURN_IMPL_(DEPTHFARM_CONCAT_(depthfarm_result_, __LINE__), lhs, expression)
#define DEPTHFARM_ASSIGN_OR_RETURN_IMPL_(result, lhs, expression) \
  auto result = (expression);                                     \
  if (!result.ok()) return result.status();                       \
  lhs = std::move(result).value()
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_STATUS_H_
