#ifndef DEPTHFARM_COMMON_TRANSPORT_RECEIVED_MESSAGE_H_
#define DEPTHFARM_COMMON_TRANSPORT_RECEIVED_MESSAGE_H_

#include <memory>
#include <string_view>

namespace depthfarm {

// A message and the bytes that came with it, where the messaging library put them: a chunk of an artifact is copied
// once, to its place.
class ReceivedMessage {
 public:
  ReceivedMessage(ReceivedMessage&& other) noexcept;
  ReceivedMessage& operator=(ReceivedMessage&& other) noexcept;
  ~ReceivedMessage();

  [[nodiscard]] std::string_view payload() const;
  // Of the second frame; empty without one.
  [[nodiscard]] std::string_view attachment() const;

 private:
  friend class ClientChannel;
  ReceivedMessage();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_RECEIVED_MESSAGE_H_
