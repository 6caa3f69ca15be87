#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <string>
#include <thread>

#include "common/transport/client_channel.h"
#include "common/transport/context.h"
#include "common/transport/poller.h"
#include "common/transport/server_channel.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPatience{10'000};  // a bound for a message that must come, not a wait
constexpr milliseconds kRefusal{600};      // long enough for a loopback handshake to have come through

std::unique_ptr<ServerChannel> Bound(TransportContext& context, const std::string& endpoint,
                                     ServerOptions options = {}) {
  Result<std::unique_ptr<ServerChannel>> server = ServerChannel::Bind(context, endpoint, options);
  EXPECT_TRUE(server.ok()) << server.status().message();
  return std::move(server).value();
}

std::unique_ptr<ClientChannel> Connected(TransportContext& context, const std::string& endpoint,
                                         ClientOptions options = {}) {
  Result<std::unique_ptr<ClientChannel>> client = ClientChannel::Connect(context, endpoint, options);
  EXPECT_TRUE(client.ok()) << client.status().message();
  return std::move(client).value();
}

std::optional<PeerMessage> Next(ServerChannel& server, milliseconds patience = kPatience) {
  Poller poller;
  const std::array<const Channel*, 1> channels = {&server};
  const auto deadline = std::chrono::steady_clock::now() + patience;
  for (;;) {
    std::optional<PeerMessage> message = server.Receive().value();
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - std::chrono::steady_clock::now());
    if (message || left.count() <= 0) return message;
    EXPECT_TRUE(poller.Wait(channels, left).ok());
  }
}

TEST(Channel, RequestsAndAnswersCrossTcpAndIpc) {
  TransportContext context;
  const testing_support::TemporaryFolder folder;
  for (const std::string& endpoint : {std::string("tcp://127.0.0.1:*"), "ipc://" + (folder.path() / "s").string()}) {
    const auto server = Bound(context, endpoint);
    EXPECT_EQ(server->endpoint().find('*'), std::string::npos);
    const auto client = Connected(context, server->endpoint());
    const std::string payload("a\0b", 3);
    ASSERT_TRUE(client->Send(payload).ok());
    const std::optional<PeerMessage> request = Next(*server);
    ASSERT_TRUE(request.has_value());
    EXPECT_EQ(request->payload, payload);
    EXPECT_EQ(request->user_id, "");
    ASSERT_TRUE(server->Send(request->peer, "answer").ok());
    EXPECT_EQ(client->Receive(kPatience).value(), "answer");
  }
}

TEST(Channel, ASecondFrameComesWithTheFirstOrIsSkipped) {
  TransportContext context;
  const auto server = Bound(context, "tcp://127.0.0.1:*");
  const auto client = Connected(context, server->endpoint());
  ASSERT_TRUE(client->Send("ask").ok());
  const std::string peer = Next(*server)->peer;
  const std::string attachment(3 << 20, 'a');
  ASSERT_TRUE(server->Send(peer, "first", attachment).ok());
  ASSERT_TRUE(server->Send(peer, "second").ok());
  ASSERT_TRUE(server->Send(peer, "third", attachment).ok());
  ASSERT_TRUE(server->Send(peer, "fourth").ok());

  const std::optional<ReceivedMessage> both = client->ReceiveAttached(kPatience).value();
  ASSERT_TRUE(both.has_value());
  EXPECT_EQ(both->payload(), "first");
  EXPECT_EQ(both->attachment(), attachment);
  const std::optional<ReceivedMessage> one = client->ReceiveAttached(kPatience).value();
  ASSERT_TRUE(one.has_value());
  EXPECT_EQ(one->payload(), "second");
  EXPECT_EQ(one->attachment(), "");
  EXPECT_EQ(client->Receive(kPatience).value(), "fourth");
}

TEST(Channel, DropsWhatAPeerDoesNotRead) {
  TransportContext context;
  const auto server = Bound(context, "tcp://127.0.0.1:*", {.max_queued_messages = 4});
  const auto client = Connected(context, server->endpoint(), {.linger = milliseconds(0)});
  ASSERT_TRUE(client->Send("ask").ok());
  const std::string peer = Next(*server)->peer;
  // The client's own queue takes 10,000 messages, the network's a few; far more than these never wait at the server.
  Status sent;
  for (int i = 0; i < 30'000 && sent.ok(); ++i) sent = server->Send(peer, "x", std::string(1000, 'x'));
  EXPECT_EQ(sent.code(), ErrorCode::kUnavailable);
}

TEST(Channel, APeerThatReadsIsNeverFull) {
  TransportContext context;
  const auto server = Bound(context, "tcp://127.0.0.1:*", {.max_queued_messages = 64});
  const auto client = Connected(context, server->endpoint());
  ASSERT_TRUE(client->Send("ask").ok());
  const std::string peer = Next(*server)->peer;
  // What was read is counted in halves of the queue.
  for (int round = 0; round < 1000; ++round) {
    for (int i = 0; i < 30; ++i) ASSERT_TRUE(server->Send(peer, "answer").ok()) << round << " " << i;
    for (int i = 0; i < 30; ++i) ASSERT_TRUE(client->Receive(kPatience).value().has_value());
  }
}

TEST(Channel, PeersAreKeptApart) {
  TransportContext context;
  const auto server = Bound(context, "tcp://127.0.0.1:*");
  const auto first = Connected(context, server->endpoint());
  const auto second = Connected(context, server->endpoint());
  ASSERT_TRUE(first->Send("1").ok());
  const std::string first_peer = Next(*server)->peer;
  ASSERT_TRUE(second->Send("2").ok());
  const std::string second_peer = Next(*server)->peer;
  EXPECT_NE(first_peer, second_peer);
  ASSERT_TRUE(server->Send(second_peer, "two").ok());
  EXPECT_EQ(second->Receive(kPatience).value(), "two");
  EXPECT_EQ(first->Receive(milliseconds(0)).value(), std::nullopt);
}

TEST(Channel, SendingToAPeerThatIsGoneIsUnavailable) {
  TransportContext context;
  const auto server = Bound(context, "tcp://127.0.0.1:*");
  EXPECT_EQ(server->Send("nobody", "x").code(), ErrorCode::kUnavailable);
}

TEST(Channel, AnAddressInUseIsUnavailableAndNamed) {
  TransportContext context;
  const auto server = Bound(context, "tcp://127.0.0.1:*");
  const auto second = ServerChannel::Bind(context, server->endpoint(), {});
  EXPECT_EQ(second.status().code(), ErrorCode::kUnavailable);
  EXPECT_NE(second.status().message().find(server->endpoint()), std::string::npos);
}

TEST(Channel, AMessageOverTheBoundNeverArrives) {
  TransportContext context;
  const auto server = Bound(context, "tcp://127.0.0.1:*", {.max_message_bytes = 100});
  const auto hostile = Connected(context, server->endpoint());
  ASSERT_TRUE(hostile->Send(std::string(101, 'x')).ok());
  const auto honest = Connected(context, server->endpoint());
  ASSERT_TRUE(honest->Send(std::string(100, 'y')).ok());
  EXPECT_EQ(Next(*server)->payload, std::string(100, 'y'));
}

TEST(Channel, ReceiveReturnsNothingWhenTheTimeIsOver) {
  TransportContext context;
  const auto client = Connected(context, "tcp://127.0.0.1:9", {.linger = milliseconds(0)});
  EXPECT_EQ(client->Receive(milliseconds(5)).value(), std::nullopt);
}

struct Keys {
  CurveKeys server = GenerateCurveKeys().value();
  CurveKeys known = GenerateCurveKeys().value();
  CurveKeys stranger = GenerateCurveKeys().value();
};

ClientOptions As(const CurveKeys& own, const CurveKeys& server) {
  return {.curve_server_public_key = server.public_key, .curve_own = own, .linger = milliseconds(0)};
}

TEST(Curve, AKnownKeyEntersUnderItsUserIdAndAStrangerDoesNot) {
  TransportContext context;
  const Keys keys;
  ASSERT_TRUE(context.Authenticate({{keys.known.public_key, "work:node7"}}).ok());
  const auto server = Bound(context, "tcp://127.0.0.1:*", {.curve_secret_key = keys.server.secret_key});
  TransportContext outside;
  const auto stranger = Connected(outside, server->endpoint(), As(keys.stranger, keys.server));
  const auto plain = Connected(outside, server->endpoint(), {.linger = milliseconds(0)});
  const auto wrong_server = Connected(outside, server->endpoint(), As(keys.known, keys.stranger));
  ASSERT_TRUE(stranger->Send("stranger").ok());
  ASSERT_TRUE(plain->Send("plain").ok());
  ASSERT_TRUE(wrong_server->Send("wrong server").ok());
  const auto known = Connected(outside, server->endpoint(), As(keys.known, keys.server));
  ASSERT_TRUE(known->Send("known").ok());
  const std::optional<PeerMessage> message = Next(*server);
  ASSERT_TRUE(message.has_value());
  EXPECT_EQ(message->payload, "known");
  EXPECT_EQ(message->user_id, "work:node7");
  EXPECT_EQ(Next(*server, kRefusal), std::nullopt);
}

TEST(Curve, AReplacedListHoldsForWhoIsConnectedAndForWhoComes) {
  TransportContext context;
  const Keys keys;
  EXPECT_EQ(context.Readmit({}).code(), ErrorCode::kInternal);
  ASSERT_TRUE(context.Authenticate({{keys.known.public_key, "work:node7"}}).ok());
  const auto server = Bound(context, "tcp://127.0.0.1:*", {.curve_secret_key = keys.server.secret_key});
  TransportContext outside;
  const auto known = Connected(outside, server->endpoint(), As(keys.known, keys.server));
  ASSERT_TRUE(known->Send("first").ok());
  EXPECT_EQ(Next(*server)->key, keys.known.public_key);

  ASSERT_TRUE(context.Readmit({{keys.known.public_key, "submit:anna"}, {keys.stranger.public_key, "work:new"}}).ok());
  ASSERT_TRUE(known->Send("second").ok());
  EXPECT_EQ(Next(*server)->user_id, "submit:anna");
  const auto added = Connected(outside, server->endpoint(), As(keys.stranger, keys.server));
  ASSERT_TRUE(added->Send("of the added").ok());
  EXPECT_EQ(Next(*server)->user_id, "work:new");

  ASSERT_TRUE(context.Readmit({{keys.stranger.public_key, "work:new"}}).ok());
  ASSERT_TRUE(known->Send("of the removed").ok());
  const auto again = Connected(outside, server->endpoint(), As(keys.known, keys.server));
  ASSERT_TRUE(again->Send("of the removed, who comes anew").ok());
  EXPECT_EQ(Next(*server, kRefusal), std::nullopt);
  ASSERT_TRUE(added->Send("of the other").ok());
  EXPECT_EQ(Next(*server)->payload, "of the other");
  EXPECT_EQ(server->refusals().messages_removed_key, 1U);
}

TEST(Curve, FailedHandshakesAreCountedByWhatWasWrong) {
  TransportContext context;
  const Keys keys;
  ASSERT_TRUE(context.Authenticate({{keys.known.public_key, "work:node7"}}).ok());
  const auto server = Bound(context, "tcp://127.0.0.1:*", {.curve_secret_key = keys.server.secret_key});
  TransportContext outside;
  const auto counted = [&](std::uint64_t ServerRefusals::*counter) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (server->refusals().*counter == 0 && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    return server->refusals().*counter;
  };
  const auto known = Connected(outside, server->endpoint(), As(keys.known, keys.server));
  ASSERT_TRUE(known->Send("known").ok());
  ASSERT_TRUE(Next(*server).has_value());
  EXPECT_EQ(server->refusals().total(), 0U);
  {
    const auto stranger = Connected(outside, server->endpoint(), As(keys.stranger, keys.server));
    EXPECT_GE(counted(&ServerRefusals::handshakes_wrong_key), 1U);
  }
  {
    const auto wrong_server = Connected(outside, server->endpoint(), As(keys.known, keys.stranger));
    EXPECT_GE(counted(&ServerRefusals::handshakes_malformed), 1U);
  }
  EXPECT_EQ(server->refusals().messages_removed_key + server->refusals().messages_frames, 0U);
}

TEST(Curve, AServerWithoutAnAuthenticatorIsRefused) {
  TransportContext context;
  const auto server =
      ServerChannel::Bind(context, "tcp://127.0.0.1:*", {.curve_secret_key = GenerateCurveKeys()->secret_key});
  EXPECT_EQ(server.status().code(), ErrorCode::kInternal);
}

TEST(Poller, WakeFromAnotherThreadEndsTheWait) {
  Poller poller;
  std::thread waker([&] { poller.Wake(); });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(poller.Wait({}, kPatience).ok());
  EXPECT_LT(std::chrono::steady_clock::now() - start, kPatience);
  waker.join();
}

TEST(Poller, AWakeBeforeTheWaitIsNotLostAndCountsOnce) {
  Poller poller;
  poller.Wake();
  poller.Wake();
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(poller.Wait({}, kPatience).ok());
  EXPECT_LT(std::chrono::steady_clock::now() - start, kPatience);
  const auto second = std::chrono::steady_clock::now();
  EXPECT_TRUE(poller.Wait({}, milliseconds(20)).ok());
  EXPECT_GE(std::chrono::steady_clock::now() - second, milliseconds(19));
}

}  // namespace
}  // namespace depthfarm
