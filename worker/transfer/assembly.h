#ifndef DEPTHFARM_WORKER_TRANSFER_ASSEMBLY_H_
#define DEPTHFARM_WORKER_TRANSFER_ASSEMBLY_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "worker/artifacts/artifact_digest.h"
#include "worker/transfer/trailing_digest.h"

namespace depthfarm {

// An artifact of known size that arrives in chunks, in any order and from any location. Its digest is computed beside
// the arrival: of a large one on a thread of its own, else by whoever fills it, in steps of a chunk.
class Assembly {
 public:
  struct Piece {
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;
  };

  // Takes memory for all of it. One of `large_bytes` or more has a thread for its digest, from its first piece on.
  // Errors: kUnavailable when there is no memory.
  [[nodiscard]] static Result<Assembly> Create(std::uint64_t total_bytes, std::uint32_t chunk_bytes,
                                               std::uint64_t large_bytes);

  [[nodiscard]] std::size_t num_pieces() const { return state_.size(); }
  [[nodiscard]] Piece PieceAt(std::size_t index) const;
  // The first piece that is neither here nor asked for; marks it as asked for.
  [[nodiscard]] std::optional<std::size_t> AskNext();
  // Whether AskNext has one.
  [[nodiscard]] bool HasUnasked();
  // A piece that was asked for in vain will be asked for again.
  void TakeBack(std::size_t index);
  // Requires the piece's exact size. A piece that is here stays as it is.
  void Fill(std::size_t index, std::string_view data);
  [[nodiscard]] bool complete() const { return filled_ == state_.size(); }
  // Nothing is here any more.
  void Reset();

  // One step of the digest, if there is one to be done here and now.
  void HashNext();
  // Requires a complete assembly. The digest of all; none when it takes longer than `timeout` or a step of its own.
  [[nodiscard]] std::optional<ContentDigest> Digest(std::chrono::milliseconds timeout);
  // Requires that no thread hashes it: Digest has told, or Reset was called.
  [[nodiscard]] std::string Take() && { return std::move(bytes_); }

 private:
  enum class State : std::uint8_t { kMissing, kAsked, kFilled };
  Assembly() = default;
  // To the thread of the digest, how far the pieces go.
  void TellTrailing();

  std::string bytes_;  // up to the end of the last piece that is here: memory is touched when it is filled
  std::uint64_t total_bytes_ = 0;
  std::uint32_t chunk_bytes_ = 1;
  std::vector<State> state_;
  std::size_t first_missing_ = 0;  // no piece before it is kMissing
  std::size_t filled_ = 0;
  std::size_t whole_ = 0;  // pieces that are here from the first on without a gap
  bool large_ = false;
  std::unique_ptr<TrailingDigest> trailing_;  // null: hashed here
  ArtifactHasher hasher_;
  std::size_t hashed_ = 0;  // pieces, from the first on
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TRANSFER_ASSEMBLY_H_
