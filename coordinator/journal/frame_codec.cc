#include "coordinator/journal/frame_codec.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "common/base/little_endian.h"

namespace depthfarm {
namespace {

constexpr std::size_t kDigestBytes = ContentDigest{}.size();
constexpr std::size_t kFileBytes = kDigestBytes + 8;

void AppendDigest(const ContentDigest& digest, std::string& bytes) { bytes.append(digest.begin(), digest.end()); }

ContentDigest ReadDigest(std::string_view bytes, std::size_t offset) {
  ContentDigest digest{};
  std::ranges::copy(bytes.substr(offset, kDigestBytes), digest.begin());
  return digest;
}

}  // namespace

std::string EncodeFrame(const CommittedFrame& frame) {
  std::string bytes;
  AppendU32(static_cast<std::uint32_t>(frame.files.size()), bytes);
  for (const FileDigest& file : frame.files) {
    AppendDigest(file.sha256, bytes);
    AppendU64(file.bytes, bytes);
  }
  AppendU32(static_cast<std::uint32_t>(frame.picture_digests.size()), bytes);
  for (const ContentDigest& digest : frame.picture_digests) AppendDigest(digest, bytes);
  AppendU32(frame.bundle ? 1 : 0, bytes);
  if (frame.bundle) {
    AppendDigest(frame.bundle->key, bytes);
    AppendU64(frame.bundle->stored_bytes, bytes);
    AppendDigest(frame.bundle->content_digest, bytes);
  }
  return bytes;
}

Result<CommittedFrame> DecodeFrame(std::string_view bytes) {
  const Status damaged = Corrupt("a frame of the journal is damaged");
  std::size_t offset = 0;
  const auto read_count = [&](std::size_t of_bytes) -> std::size_t {
    if (bytes.size() - offset < 4) return SIZE_MAX;
    const std::size_t count = ReadU32(bytes, offset);
    offset += 4;
    return count <= (bytes.size() - offset) / of_bytes ? count : SIZE_MAX;
  };
  CommittedFrame frame;
  const std::size_t files = read_count(kFileBytes);
  if (files == SIZE_MAX) return damaged;
  for (std::size_t i = 0; i < files; ++i, offset += kFileBytes)
    frame.files.push_back({ReadDigest(bytes, offset), ReadU64(bytes, offset + kDigestBytes)});
  const std::size_t pictures = read_count(kDigestBytes);
  if (pictures == SIZE_MAX) return damaged;
  for (std::size_t i = 0; i < pictures; ++i, offset += kDigestBytes)
    frame.picture_digests.push_back(ReadDigest(bytes, offset));
  const std::size_t bundles = read_count(kFileBytes + kDigestBytes);
  if (bundles > 1) return damaged;
  if (bundles == 1) {
    frame.bundle = ArtifactInfo{ReadDigest(bytes, offset), ReadU64(bytes, offset + kDigestBytes),
                                ReadDigest(bytes, offset + kFileBytes)};
    offset += kFileBytes + kDigestBytes;
  }
  if (offset != bytes.size()) return damaged;
  return frame;
}

}  // namespace depthfarm
