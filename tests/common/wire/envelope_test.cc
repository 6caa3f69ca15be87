#include "common/wire/envelope.h"

#include <gtest/gtest.h>

#include <string>

namespace depthfarm {
namespace {

v1::Envelope Ask() {
  v1::Envelope envelope;
  envelope.set_request_id(7);
  envelope.mutable_ask_for_task()->set_ask_id(3);
  return envelope;
}

TEST(Envelope, ComesBack) {
  const Result<v1::Envelope> parsed = ParseEnvelope(SerializeEnvelope(Ask()));
  ASSERT_TRUE(parsed.ok());
  EXPECT_EQ(parsed->request_id(), 7U);
  EXPECT_EQ(parsed->ask_for_task().ask_id(), 3U);
  EXPECT_EQ(BodyName(*parsed), "ask_for_task");
}

TEST(Envelope, AnotherProtocolVersionIsIncompatible) {
  v1::Envelope envelope = Ask();
  envelope.set_protocol_version(kProtocolVersion + 1);
  EXPECT_EQ(ParseEnvelope(envelope.SerializeAsString()).status().code(), ErrorCode::kIncompatible);
  EXPECT_EQ(ParseEnvelope("").status().code(), ErrorCode::kIncompatible);
}

TEST(Envelope, OfAnotherMinorVersionIsReadAsFarAsItIsKnown) {
  for (const std::uint32_t minor : {0U, kProtocolMinor, kProtocolMinor + 1}) {
    v1::Envelope envelope = Ask();
    envelope.set_protocol_version(kProtocolVersion);
    envelope.set_protocol_minor(minor);
    v1::AskForTask* ask = envelope.mutable_ask_for_task();
    ask->GetReflection()->MutableUnknownFields(ask)->AddVarint(4000, 5);
    const Result<v1::Envelope> parsed = ParseEnvelope(envelope.SerializeAsString());
    ASSERT_TRUE(parsed.ok()) << parsed.status().message();
    EXPECT_EQ(parsed->ask_for_task().ask_id(), 3U);
  }
}

TEST(Envelope, OfAKindThatOnlyTheOtherEndKnowsNamesBothVersions) {
  v1::Envelope envelope;
  envelope.set_protocol_version(kProtocolVersion);
  envelope.set_protocol_minor(kProtocolMinor + 1);
  envelope.GetReflection()->MutableUnknownFields(&envelope)->AddLengthDelimited(4000, "");
  const Status status = ParseEnvelope(envelope.SerializeAsString()).status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(status.message(), "a message that this end, of protocol 9.0, does not know; the peer has protocol 9.1");
}

TEST(Envelope, WithoutABodyIsCorrupt) {
  EXPECT_EQ(ParseEnvelope(SerializeEnvelope({})).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(BodyName({}), "nothing");
}

TEST(Envelope, EveryTruncationIsRefusedOrIncomplete) {
  v1::Envelope envelope;
  envelope.mutable_worker_hello()->set_name("a name of some length");
  const std::string bytes = SerializeEnvelope(envelope);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const Result<v1::Envelope> parsed = ParseEnvelope(std::string_view(bytes).substr(0, length));
    EXPECT_FALSE(parsed.ok()) << length;
  }
}

TEST(Error, EveryCodeComesBack) {
  for (const ErrorCode code :
       {ErrorCode::kOk, ErrorCode::kInvalidArgument, ErrorCode::kCorrupt, ErrorCode::kUnavailable,
        ErrorCode::kLeaseExpired, ErrorCode::kIncompatible, ErrorCode::kCancelled, ErrorCode::kInternal}) {
    EXPECT_EQ(FromProto(ToProto(Status(code, "why"))).code(), code);
  }
}

TEST(Error, UnknownCodesAreInternalAndLongTextIsCutBetweenCharacters) {
  v1::Error error;
  error.set_code(static_cast<v1::Code>(99));
  EXPECT_EQ(FromProto(error).code(), ErrorCode::kInternal);
  std::string text(4095, 'x');
  text += "\xc3\xa9";  // a character of two bytes across the bound
  EXPECT_EQ(ToProto(Internal(text)).message(), std::string(4095, 'x'));
}

}  // namespace
}  // namespace depthfarm
