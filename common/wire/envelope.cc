#include "common/wire/envelope.h"

#include <utility>

namespace depthfarm {
namespace {

constexpr std::size_t kMaxEnvelopeBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxErrorText = 4096;

// Cuts between characters: a protobuf string must stay UTF-8.
std::string Shortened(std::string text) {
  if (text.size() <= kMaxErrorText) return text;
  std::size_t end = kMaxErrorText;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  text.resize(end);
  return text;
}

v1::Code CodeOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::kOk:
      return v1::CODE_OK;
    case ErrorCode::kInvalidArgument:
      return v1::CODE_INVALID_ARGUMENT;
    case ErrorCode::kCorrupt:
      return v1::CODE_CORRUPT;
    case ErrorCode::kUnavailable:
      return v1::CODE_UNAVAILABLE;
    case ErrorCode::kLeaseExpired:
      return v1::CODE_LEASE_EXPIRED;
    case ErrorCode::kIncompatible:
      return v1::CODE_INCOMPATIBLE;
    case ErrorCode::kCancelled:
      return v1::CODE_CANCELLED;
    case ErrorCode::kInternal:
      return v1::CODE_INTERNAL;
  }
  return v1::CODE_INTERNAL;
}

ErrorCode CodeOf(v1::Code code) {
  switch (code) {
    case v1::CODE_OK:
      return ErrorCode::kOk;
    case v1::CODE_INVALID_ARGUMENT:
      return ErrorCode::kInvalidArgument;
    case v1::CODE_CORRUPT:
      return ErrorCode::kCorrupt;
    case v1::CODE_UNAVAILABLE:
      return ErrorCode::kUnavailable;
    case v1::CODE_LEASE_EXPIRED:
      return ErrorCode::kLeaseExpired;
    case v1::CODE_INCOMPATIBLE:
      return ErrorCode::kIncompatible;
    case v1::CODE_CANCELLED:
      return ErrorCode::kCancelled;
    default:
      return ErrorCode::kInternal;
  }
}

}  // namespace

std::string SerializeEnvelope(v1::Envelope envelope) {
  envelope.set_protocol_version(kProtocolVersion);
  envelope.set_protocol_minor(kProtocolMinor);
  return envelope.SerializeAsString();
}

Result<v1::Envelope> ParseEnvelope(std::string_view bytes) {
  if (bytes.size() > kMaxEnvelopeBytes) {
    return Corrupt("a message of " + std::to_string(bytes.size()) + " bytes, expected at most " +
                   std::to_string(kMaxEnvelopeBytes));
  }
  v1::Envelope envelope;
  if (!envelope.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return Corrupt("a message of " + std::to_string(bytes.size()) + " bytes is no Envelope");
  }
  if (envelope.protocol_version() != kProtocolVersion) {
    return Status(ErrorCode::kIncompatible, "the peer speaks protocol version " +
                                                std::to_string(envelope.protocol_version()) + ", expected " +
                                                std::to_string(kProtocolVersion));
  }
  if (envelope.body_case() != v1::Envelope::BODY_NOT_SET) return envelope;
  if (envelope.GetReflection()->GetUnknownFields(envelope).empty()) return Corrupt("a message without a body");
  const auto version = [](std::uint32_t minor) {
    return "protocol " + std::to_string(kProtocolVersion) + "." + std::to_string(minor);
  };
  return InvalidArgument("a message that this end, of " + version(kProtocolMinor) + ", does not know; the peer has " +
                         version(envelope.protocol_minor()));
}

std::string BodyName(const v1::Envelope& envelope) {
  const auto* field = v1::Envelope::descriptor()->FindFieldByNumber(envelope.body_case());
  return field == nullptr ? "nothing" : field->name();
}

v1::Error ToProto(const Status& status) {
  v1::Error error;
  error.set_code(CodeOf(status.code()));
  error.set_message(Shortened(status.message()));
  return error;
}

Status FromProto(const v1::Error& error) {
  if (error.code() == v1::CODE_OK) return {};
  return {CodeOf(error.code()), Shortened(error.message())};
}

}  // namespace depthfarm
