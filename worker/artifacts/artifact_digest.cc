#include "worker/artifacts/artifact_digest.h"

#include <algorithm>

#include "common/base/little_endian.h"
#include "worker/artifacts/leaf_digests.h"

namespace depthfarm {
namespace {

void Append(const Sha256Digest& digest, std::string& bytes) { bytes.append(digest.begin(), digest.end()); }

}  // namespace

void ArtifactHasher::Update(std::string_view bytes) {
  total_bytes_ += bytes.size();
  if (begun_bytes_ > 0) {
    const std::string_view rest = bytes.substr(0, kLeafBytes - begun_bytes_);
    bytes.remove_prefix(rest.size());
    begun_.Update(rest);
    begun_bytes_ += rest.size();
    if (begun_bytes_ < kLeafBytes) return;
    Append(begun_.Finish(), digests_);
    begun_bytes_ = 0;
  }
  const std::string_view whole = bytes.substr(0, bytes.size() / kLeafBytes * kLeafBytes);
  AppendLeafDigests(whole, digests_);
  bytes.remove_prefix(whole.size());
  begun_.Update(bytes);
  begun_bytes_ = bytes.size();
}

ContentDigest ArtifactHasher::Finish() {
  if (begun_bytes_ > 0) Append(begun_.Finish(), digests_);
  std::string head = "depthfarm artifact\n";
  AppendU64(total_bytes_, head);
  Sha256Hasher root;
  root.Update(head);
  root.Update(digests_);
  digests_.clear();
  begun_bytes_ = 0;
  total_bytes_ = 0;
  return root.Finish();
}

ContentDigest DigestOfArtifact(std::string_view bytes) {
  ArtifactHasher hasher;
  hasher.Update(bytes);
  return hasher.Finish();
}

}  // namespace depthfarm
