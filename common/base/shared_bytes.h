#ifndef DEPTHFARM_COMMON_BASE_SHARED_BYTES_H_
#define DEPTHFARM_COMMON_BASE_SHARED_BYTES_H_

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace depthfarm {

// Bytes that nobody changes any more, and what keeps them where they are. Copies share them. The last holder may be any
// thread, which then ends the owner.
class SharedBytes {
 public:
  SharedBytes() = default;
  SharedBytes(std::string bytes) {  // NOLINT(google-explicit-constructor): they are the bytes
    const auto owner = std::make_shared<const std::string>(std::move(bytes));
    view_ = *owner;
    owner_ = owner;
  }
  SharedBytes(std::string_view view, std::shared_ptr<const void> owner) : view_(view), owner_(std::move(owner)) {}

  [[nodiscard]] std::string_view view() const { return view_; }
  [[nodiscard]] std::size_t size() const { return view_.size(); }
  [[nodiscard]] bool empty() const { return view_.empty(); }

 private:
  std::string_view view_;
  std::shared_ptr<const void> owner_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_SHARED_BYTES_H_
