#ifndef DEPTHFARM_COMMON_WIRE_ENVELOPE_H_
#define DEPTHFARM_COMMON_WIRE_ENVELOPE_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "depthfarm/v1/farm.pb.h"

namespace depthfarm {

// Both ends must speak the same: raised by any change of proto/ that an older end would misread.
inline constexpr std::uint32_t kProtocolVersion = 9;
// Raised by additions, which an older end may pass over (PROTOCOL.md, section 2, lists them): ends whose minor versions
// differ talk to each other.
inline constexpr std::uint32_t kProtocolMinor = 0;

// The bytes of one message; sets both versions.
[[nodiscard]] std::string SerializeEnvelope(v1::Envelope envelope);

// Errors: kCorrupt (too long, not an Envelope, no body), kIncompatible (another protocol version), kInvalidArgument: a
// message that came with a later minor version than this end's.
[[nodiscard]] Result<v1::Envelope> ParseEnvelope(std::string_view bytes);

// The word for logs: "worker_hello", "grant_task", ...; "nothing" without a body.
[[nodiscard]] std::string BodyName(const v1::Envelope& envelope);

// Codes outside the enumeration become kInternal; messages are cut at 4 KiB.
[[nodiscard]] v1::Error ToProto(const Status& status);
[[nodiscard]] Status FromProto(const v1::Error& error);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_WIRE_ENVELOPE_H_
