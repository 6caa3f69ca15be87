#ifndef DEPTHFARM_TESTS_FUZZ_FUZZ_TARGET_H_
#define DEPTHFARM_TESTS_FUZZ_FUZZ_TARGET_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/compression/artifact_format.h"

// What libFuzzer, or the program that plays a stored corpus (replay_main.cc), calls for each input. 0.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace depthfarm::fuzz {

// How many inputs were taken for good ones so far. A corpus without any does not reach what is behind the checks.
extern std::uint64_t accepted;

// Ends the program as a found bug where a decoder breaks its contract.
void Require(bool holds, const char* claim);

[[nodiscard]] inline std::string_view Text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// The first byte of `rest`, which it loses; 0 where there is none.
[[nodiscard]] inline unsigned TakeByte(std::string_view& rest) {
  if (rest.empty()) return 0;
  const auto byte = static_cast<std::uint8_t>(rest.front());
  rest.remove_prefix(1);
  return byte;
}

// Decodes, and where that succeeds requires that encoding gives bytes that decode to the same.
template <typename Decode, typename Encode>
void RequireRoundTrip(std::string_view bytes, const Decode& decode, const Encode& encode) {
  const auto first = decode(bytes);
  if (!first.ok()) {
    Require(!first.status().message().empty(), "a refusal has a reason");
    return;
  }
  ++accepted;
  const std::string encoded = encode(*first);
  const auto second = decode(encoded);
  Require(second.ok(), "what was encoded can be decoded");
  Require(*second == *first, "decode(encode(x)) == x");
}

// Of an artifact: an input that does not begin as one is the content of one, or else no mutation would get past the
// checksum.
template <typename Decode, typename Encode>
void RequireArtifactRoundTrip(const ArtifactFormat& format, std::string_view input, const Decode& decode,
                              const Encode& encode) {
  if (input.starts_with(format.magic)) {
    RequireRoundTrip(input, decode, encode);
  } else {
    RequireRoundTrip(EncodeArtifact(format, input), decode, encode);
  }
}

}  // namespace depthfarm::fuzz

#endif  // DEPTHFARM_TESTS_FUZZ_FUZZ_TARGET_H_
