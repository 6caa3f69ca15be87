#include "worker/transfer/assembly.h"

#include <sys/mman.h>

#include <algorithm>
#include <new>
#include <stdexcept>

namespace depthfarm {
namespace {

constexpr std::size_t kLargePageBytes = std::size_t{2} << 20;

// A page of 4 KiB after the other would cost as much as copying into them. Where there are no large pages, nothing
// happens. Only whole ones, so that no more memory is taken than is used.
void PreferLargePages(char* bytes, std::size_t size) {
  const std::size_t before =
      (kLargePageBytes - reinterpret_cast<std::uintptr_t>(bytes) % kLargePageBytes) % kLargePageBytes;
  if (size < before + kLargePageBytes) return;
  (void)::madvise(bytes + before, (size - before) / kLargePageBytes * kLargePageBytes, MADV_HUGEPAGE);
}

}  // namespace

Result<Assembly> Assembly::Create(std::uint64_t total_bytes, std::uint32_t chunk_bytes, std::uint64_t large_bytes) {
  Assembly assembly;
  assembly.total_bytes_ = total_bytes;
  assembly.chunk_bytes_ = chunk_bytes;
  assembly.large_ = total_bytes >= large_bytes;
  try {
    assembly.bytes_.reserve(total_bytes);
    PreferLargePages(assembly.bytes_.data(), total_bytes);
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
  return {offset, static_cast<std::uint32_t>(std::min<std::uint64_t>(chunk_bytes_, total_bytes_ - offset))};
}

bool Assembly::HasUnasked() {
  while (first_missing_ < state_.size() && state_[first_missing_] != State::kMissing) ++first_missing_;
  return first_missing_ < state_.size();
}

std::optional<std::size_t> Assembly::AskNext() {
  if (!HasUnasked()) return std::nullopt;
  state_[first_missing_] = State::kAsked;
  return first_missing_;
}

void Assembly::TakeBack(std::size_t index) {
  if (state_[index] != State::kAsked) return;
  state_[index] = State::kMissing;
  first_missing_ = std::min(first_missing_, index);
}

void Assembly::Fill(std::size_t index, std::string_view data) {
  if (state_[index] == State::kFilled) return;
  const auto offset = static_cast<std::size_t>(PieceAt(index).offset);
  if (bytes_.size() < offset) bytes_.resize(offset);
  if (bytes_.size() == offset) {
    bytes_.append(data);
  } else {
    std::ranges::copy(data, bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  state_[index] = State::kFilled;
  ++filled_;
  if (large_) TellTrailing();
}

void Assembly::TellTrailing() {
  const std::size_t before = whole_;
  while (whole_ < state_.size() && state_[whole_] == State::kFilled) ++whole_;
  if (whole_ == before) return;
  // Not earlier: then the bytes have their place, and a transfer that brings nothing has no thread.
  if (!trailing_) trailing_ = TrailingDigest::Start(bytes_.data(), static_cast<std::size_t>(total_bytes_));
  if (!trailing_) {
    large_ = false;
    return;
  }
  const Piece last = PieceAt(whole_ - 1);
  trailing_->Advance(static_cast<std::size_t>(last.offset) + last.bytes);
}

void Assembly::Reset() {
  trailing_.reset();
  std::ranges::fill(state_, State::kMissing);
  first_missing_ = 0;
  filled_ = 0;
  whole_ = 0;
  hasher_ = ArtifactHasher();
  hashed_ = 0;
}

void Assembly::HashNext() {
  if (large_ || hashed_ == state_.size() || state_[hashed_] != State::kFilled) return;
  const Piece piece = PieceAt(hashed_++);
  hasher_.Update(std::string_view(bytes_).substr(static_cast<std::size_t>(piece.offset), piece.bytes));
}

std::optional<ContentDigest> Assembly::Digest(std::chrono::milliseconds timeout) {
  if (large_ && trailing_) return trailing_->Wait(timeout);
  HashNext();
  if (hashed_ < state_.size()) return std::nullopt;
  return hasher_.Finish();
}

}  // namespace depthfarm
