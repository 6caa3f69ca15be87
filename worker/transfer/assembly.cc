#include "worker/transfer/assembly.h"

#include <algorithm>
#include <new>
#include <stdexcept>

namespace depthfarm {

Result<Assembly> Assembly::Create(std::uint64_t total_bytes, std::uint32_t chunk_bytes) {
  Assembly assembly;
  assembly.chunk_bytes_ = chunk_bytes;
  try {
    assembly.bytes_.resize(total_bytes);
    assembly.state_.assign((total_bytes + chunk_bytes - 1) / chunk_bytes, State::kMissing);
  } catch (const std::bad_alloc&) {
    return Unavailable("no memory for an artifact of " + std::to_string(total_bytes) + " bytes");
  } catch (const std::length_error&) {
    return Unavailable("no memory for an artifact of " + std::to_string(total_bytes) + " bytes");
  }
  return assembly;
}

Assembly::Piece Assembly::PieceAt(std::size_t index) const {
  const std::uint64_t offset = static_cast<std::uint64_t>(index) * chunk_bytes_;
  return {offset, static_cast<std::uint32_t>(std::min<std::uint64_t>(chunk_bytes_, bytes_.size() - offset))};
}

std::optional<std::size_t> Assembly::AskNext() {
  while (first_missing_ < state_.size() && state_[first_missing_] != State::kMissing) ++first_missing_;
  if (first_missing_ == state_.size()) return std::nullopt;
  state_[first_missing_] = State::kAsked;
  return first_missing_;
}

void Assembly::ForgetAsks() {
  std::ranges::replace(state_, State::kAsked, State::kMissing);
  first_missing_ = 0;
}

void Assembly::Fill(std::size_t index, std::string_view data) {
  std::ranges::copy(data, bytes_.begin() + static_cast<std::ptrdiff_t>(PieceAt(index).offset));
  filled_ += state_[index] != State::kFilled;
  state_[index] = State::kFilled;
}

void Assembly::Reset() {
  std::ranges::fill(state_, State::kMissing);
  first_missing_ = 0;
  filled_ = 0;
}

}  // namespace depthfarm
