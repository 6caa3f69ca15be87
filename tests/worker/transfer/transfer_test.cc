#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <random>
#include <thread>

#include "common/wire/task_wire.h"
#include "tests/support/temporary_folder.h"
#include "worker/artifacts/artifact_digest.h"
#include "worker/artifacts/store.h"
#include "worker/transfer/artifact_client.h"
#include "worker/transfer/artifact_server.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;

ArtifactKey Key(int number) {
  ArtifactKey key{};
  key[5] = static_cast<std::uint8_t>(number);
  return key;
}

std::string RandomBytes(std::size_t size) {
  std::mt19937 random(static_cast<unsigned>(size));
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

// A worker's serving side.
struct Holder {
  Holder(TransportContext& context, const std::string& endpoint, const std::string& secret_key = "") {
    store = ArtifactStore::Open(folder.path() / "store", 64 << 20).value();
    server = ArtifactServer::Start(context, *store, endpoint, secret_key).value();
  }
  [[nodiscard]] ArtifactLocation location() const { return {server->endpoint(), ""}; }

  testing_support::TemporaryFolder folder;
  std::unique_ptr<ArtifactStore> store;
  std::unique_ptr<ArtifactServer> server;
};

// A peer that answers as it likes; an answer without body is not sent.
class OddPeer {
 public:
  using Answer = std::function<PeerAnswer(const v1::Envelope&)>;
  OddPeer(TransportContext& context, Answer answer)
      : channel_(ServerChannel::Bind(context, "ipc://*", {}).value()),
        endpoint_(channel_->endpoint()),
        answer_(std::move(answer)),
        thread_([this] { Serve(); }) {}
  ~OddPeer() {
    stopping_ = true;
    poller_.Wake();
    thread_.join();
  }
  [[nodiscard]] ArtifactLocation location() const { return {endpoint_, ""}; }
  [[nodiscard]] int asked() const { return asked_; }

 private:
  void Serve() {
    const Channel* const channels[] = {channel_.get()};
    while (!stopping_) {
      EXPECT_TRUE(poller_.Wait(channels, std::chrono::milliseconds(1000)).ok());
      while (true) {
        const Result<std::optional<PeerMessage>> message = channel_->Receive();
        if (!message.ok() || !message->has_value()) break;
        ++asked_;
        const v1::Envelope request = ParseEnvelope((*message)->payload).value();
        PeerAnswer answer = answer_(request);
        answer.envelope.set_request_id(request.request_id());
        if (answer.envelope.body_case() == v1::Envelope::BODY_NOT_SET) continue;
        const std::string envelope = SerializeEnvelope(answer.envelope);
        const Status sent = answer.attachment.empty()
                                ? channel_->Send((*message)->peer, envelope)
                                : channel_->Send((*message)->peer, envelope, std::move(answer.attachment));
        // A client that gave up may be gone.
        EXPECT_TRUE(sent.ok() || sent.code() == ErrorCode::kUnavailable) << sent.message();
      }
    }
  }

  std::unique_ptr<ServerChannel> channel_;
  const std::string endpoint_;
  Answer answer_;
  Poller poller_;
  std::atomic<bool> stopping_ = false;
  std::atomic<int> asked_ = 0;
  std::thread thread_;
};

class TransferTest : public testing::Test {
 protected:
  // Patient enough for a busy machine; tests with a silent peer wait for that long.
  static FetchOptions SmallChunks(std::chrono::milliseconds silence = std::chrono::milliseconds(1500)) {
    FetchOptions options;
    options.chunk_bytes = 1000;
    options.digest_thread_bytes = 4000;
    options.patience = silence / 3;
    options.silence = silence;
    return options;
  }
  Result<std::string> Fetch(const ArtifactInfo& artifact, std::vector<ArtifactLocation> locations) {
    return client_.Fetch(artifact, locations, stop_.get_token());
  }
  // A location nobody listens at.
  ArtifactLocation Nobody() const { return {"ipc://" + (folder_.path() / "nobody").string(), ""}; }

  testing_support::TemporaryFolder folder_;
  TransportContext context_;
  Holder holder_{context_, "ipc://*"};
  ArtifactClient client_{context_, {}, SmallChunks()};
  std::stop_source stop_;
};

TEST_F(TransferTest, FetchesArtifactsOfAnySize) {
  ArtifactClient client(context_, {}, SmallChunks(std::chrono::minutes(1)));
  const std::vector<ArtifactLocation> locations{holder_.location()};
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{999}, std::size_t{1000}, std::size_t{1001}, std::size_t{123456}}) {
    const std::string bytes = RandomBytes(size);
    const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
    const Result<std::string> fetched = client.Fetch(info, locations, {});
    ASSERT_TRUE(fetched.ok()) << fetched.status().message();
    EXPECT_EQ(*fetched, bytes);
  }
}

TEST_F(TransferTest, AnEmptyArtifactOfAnotherDigestIsRefusedAtOnce) {
  const Result<std::string> fetched = Fetch({Key(1), 0, DigestOfArtifact("something")}, {holder_.location()});
  EXPECT_EQ(fetched.status().code(), ErrorCode::kCorrupt);
  EXPECT_THAT(fetched.status().message(), HasSubstr("is empty"));
}

TEST_F(TransferTest, FetchesFullChunksOverCurve) {
  const CurveKeys keys = GenerateCurveKeys().value();
  TransportContext context;
  ASSERT_TRUE(context.Authenticate({{keys.public_key, "work:w"}}).ok());
  Holder holder(context, "tcp://127.0.0.1:*", keys.secret_key);
  const std::string bytes = RandomBytes(3 * kMaxChunkBytes + 17);
  const ArtifactInfo info = holder.store->Put(Key(1), bytes).value();
  FetchOptions options;
  options.silence = std::chrono::minutes(1);
  ArtifactClient client(context, keys, options);
  const std::vector<ArtifactLocation> locations{{holder.server->endpoint(), keys.public_key}};
  const Result<std::string> fetched = client.Fetch(info, locations, {});
  ASSERT_TRUE(fetched.ok()) << fetched.status().message();
  EXPECT_EQ(*fetched, bytes);
}

TEST_F(TransferTest, AStrangersKeyGetsNothing) {
  const CurveKeys keys = GenerateCurveKeys().value();
  TransportContext context;
  ASSERT_TRUE(context.Authenticate({{keys.public_key, "work:w"}}).ok());
  Holder holder(context, "tcp://127.0.0.1:*", keys.secret_key);
  const ArtifactInfo info = holder.store->Put(Key(1), "secret").value();
  ArtifactClient stranger(context, GenerateCurveKeys().value(), SmallChunks());
  const std::vector<ArtifactLocation> locations{{holder.server->endpoint(), keys.public_key}};
  EXPECT_EQ(stranger.Fetch(info, locations, {}).status().code(), ErrorCode::kUnavailable);
}

TEST_F(TransferTest, GoesToTheNextLocationWhenOneIsSilentOrHasNothing) {
  const Holder empty(context_, "ipc://*");
  const std::string bytes = RandomBytes(5000);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  EXPECT_EQ(Fetch(info, {Nobody(), empty.location(), holder_.location()}).value(), bytes);
}

TEST_F(TransferTest, TellsWhyEachLocationFailed) {
  const Holder empty(context_, "ipc://*");
  const Result<std::string> fetched = Fetch({Key(1), 10, {}}, {Nobody(), empty.location()});
  EXPECT_EQ(fetched.status().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(fetched.status().message(), HasSubstr("silent for 1500 ms"));
  EXPECT_THAT(fetched.status().message(), HasSubstr("not in this store"));
}

TEST_F(TransferTest, AnArtifactWithoutLocationIsUnavailable) {
  EXPECT_EQ(Fetch({Key(1), 10, {}}, {}).status().code(), ErrorCode::kUnavailable);
}

TEST_F(TransferTest, KeepsWhatAFailedLocationHasSent) {
  const std::string bytes = RandomBytes(10000);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  int answered = 0;
  OddPeer dying(context_, [&](const v1::Envelope& request) {
    return ++answered > 6 ? PeerAnswer() : AnswerPeer(*holder_.store, request);
  });
  std::atomic<int> resumed = 0;
  OddPeer second(context_, [&](const v1::Envelope& request) {
    ++resumed;
    return AnswerPeer(*holder_.store, request);
  });
  EXPECT_EQ(Fetch(info, {dying.location(), second.location()}).value(), bytes);
  EXPECT_EQ(resumed, 4);
}

TEST_F(TransferTest, AsksSeveralLocationsForALargeArtifactAndOneForASmall) {
  const std::string bytes = RandomBytes(100'000);
  const ArtifactInfo large = holder_.store->Put(Key(1), bytes).value();
  const ArtifactInfo small = holder_.store->Put(Key(2), RandomBytes(8000)).value();
  const auto answer = [&](const v1::Envelope& request) { return AnswerPeer(*holder_.store, request); };
  OddPeer first(context_, answer);
  OddPeer second(context_, answer);
  OddPeer third(context_, answer);
  const std::vector<ArtifactLocation> locations{first.location(), second.location(), third.location()};
  EXPECT_TRUE(Fetch(small, locations).ok());
  EXPECT_EQ(first.asked(), 8);
  EXPECT_EQ(second.asked() + third.asked(), 0);
  EXPECT_EQ(Fetch(large, locations).value(), bytes);
  EXPECT_GT(second.asked(), 0);
  EXPECT_GT(third.asked(), 0);
  EXPECT_EQ(first.asked() + second.asked() + third.asked(), 108);
}

TEST_F(TransferTest, GoesOnWithTheOthersWhenOneOfSeveralDies) {
  const std::string bytes = RandomBytes(200'000);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  auto dying = std::make_unique<Holder>(context_, "ipc://*");
  ASSERT_TRUE(dying->store->Put(Key(1), bytes).ok());
  const ArtifactLocation dying_location = dying->location();
  std::atomic<int> answered = 0;
  OddPeer living(context_, [&](const v1::Envelope& request) {
    if (++answered == 20) dying.reset();
    return AnswerPeer(*holder_.store, request);
  });
  EXPECT_EQ(Fetch(info, {dying_location, living.location()}).value(), bytes);
}

TEST_F(TransferTest, DoesNotWaitForALateLocationAsLongAsThereAreOthers) {
  FetchOptions options = SmallChunks(std::chrono::seconds(10));
  options.patience = std::chrono::milliseconds(200);
  ArtifactClient impatient(context_, {}, options);
  const std::string bytes = RandomBytes(100'000);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  int answered = 0;
  OddPeer stuck(context_, [&](const v1::Envelope& request) {
    return ++answered > 3 ? PeerAnswer() : AnswerPeer(*holder_.store, request);
  });
  const std::vector<ArtifactLocation> locations{stuck.location(), holder_.location()};
  EXPECT_EQ(impatient.Fetch(info, locations, {}).value(), bytes);
  // And comes to it last from then on.
  const int asked = stuck.asked();
  const ArtifactInfo small = holder_.store->Put(Key(2), "small").value();
  EXPECT_EQ(impatient.Fetch(small, locations, {}).value(), "small");
  EXPECT_EQ(stuck.asked(), asked);
}

TEST_F(TransferTest, NeverHasMoreRequestsUnderWayThanItsCredit) {
  OddPeer silent(context_, [](const v1::Envelope&) { return PeerAnswer(); });
  EXPECT_FALSE(Fetch({Key(1), 100'000, {}}, {silent.location()}).ok());
  EXPECT_EQ(silent.asked(), SmallChunks().chunks_of_location);

  std::vector<std::unique_ptr<OddPeer>> peers;
  std::vector<ArtifactLocation> locations;
  for (int i = 0; i < SmallChunks().max_locations; ++i) {
    peers.push_back(std::make_unique<OddPeer>(context_, [](const v1::Envelope&) { return PeerAnswer(); }));
    locations.push_back(peers.back()->location());
  }
  FetchOptions options = SmallChunks();
  options.patience = std::chrono::hours(1);
  ArtifactClient client(context_, {}, options);
  EXPECT_FALSE(client.Fetch({Key(1), 100'000, {}}, locations, {}).ok());
  int asked = 0;
  for (const auto& peer : peers) asked += peer->asked();
  EXPECT_EQ(asked, SmallChunks().chunks_in_flight);
}

// Answers from a store, with a wrong byte in each piece.
PeerAnswer WrongBytes(ArtifactStore& store, const v1::Envelope& request) {
  PeerAnswer answer = AnswerPeer(store, request);
  std::string bytes(answer.attachment.view());
  bytes.front() ^= 1;
  answer.attachment = std::move(bytes);
  return answer;
}

TEST_F(TransferTest, RefusesOtherBytesAndTakesTheRightOnesElsewhere) {
  const std::string bytes = RandomBytes(2500);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  OddPeer liar(context_, [&](const v1::Envelope& request) { return WrongBytes(*holder_.store, request); });
  const Result<std::string> wrong = Fetch(info, {liar.location()});
  EXPECT_EQ(wrong.status().code(), ErrorCode::kCorrupt);
  EXPECT_THAT(wrong.status().message(), HasSubstr(liar.location().endpoint + ": not the artifact of that digest"));
  EXPECT_EQ(Fetch(info, {liar.location(), holder_.location()}).value(), bytes);
}

TEST_F(TransferTest, FindsTheHonestOneAmongSeveralAtOnce) {
  const std::string bytes = RandomBytes(100'000);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  OddPeer liar(context_, [&](const v1::Envelope& request) { return WrongBytes(*holder_.store, request); });
  OddPeer other_liar(context_, [&](const v1::Envelope& request) { return WrongBytes(*holder_.store, request); });
  EXPECT_EQ(Fetch(info, {liar.location(), holder_.location(), other_liar.location()}).value(), bytes);
}

TEST_F(TransferTest, NamesAllThatSentWrongBytes) {
  const ArtifactInfo info = holder_.store->Put(Key(1), RandomBytes(100'000)).value();
  OddPeer liar(context_, [&](const v1::Envelope& request) { return WrongBytes(*holder_.store, request); });
  OddPeer other_liar(context_, [&](const v1::Envelope& request) { return WrongBytes(*holder_.store, request); });
  const Result<std::string> fetched = Fetch(info, {liar.location(), other_liar.location()});
  EXPECT_EQ(fetched.status().code(), ErrorCode::kCorrupt);
  const std::string reason = ": not the artifact of that digest";
  EXPECT_THAT(fetched.status().message(), HasSubstr(liar.location().endpoint + reason));
  EXPECT_THAT(fetched.status().message(), HasSubstr(other_liar.location().endpoint + reason));
}

TEST_F(TransferTest, StartsAnewWhenPiecesOfAnEarlierLocationWereWrong) {
  const std::string bytes = RandomBytes(10000);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  int answered = 0;
  OddPeer lying_and_dying(context_, [&](const v1::Envelope& request) {
    return ++answered > 2 ? PeerAnswer() : WrongBytes(*holder_.store, request);
  });
  EXPECT_EQ(Fetch(info, {lying_and_dying.location(), holder_.location()}).value(), bytes);
}

TEST_F(TransferTest, RefusesChunksThatDoNotFit) {
  const ArtifactInfo info = holder_.store->Put(Key(1), RandomBytes(5000)).value();
  const std::vector<std::function<void(PeerAnswer&)>> distortions{
      [](PeerAnswer& answer) { answer.attachment = std::string(answer.attachment.view()) + 'x'; },
      [](PeerAnswer& answer) {
        answer.attachment = std::string(answer.attachment.view().substr(0, answer.attachment.size() - 1));
      },
      [](PeerAnswer& answer) { answer.attachment = SharedBytes(); },
      [](PeerAnswer& answer) { answer.envelope.mutable_chunk()->set_offset(answer.envelope.chunk().offset() + 1); },
      [](PeerAnswer& answer) { answer.envelope.mutable_chunk()->set_total_bytes(1); },
      [](PeerAnswer& answer) { answer.envelope.mutable_chunk()->set_key("key"); },
      [](PeerAnswer& answer) { answer.envelope.mutable_done(); },
  };
  for (const auto& distort : distortions) {
    OddPeer odd(context_, [&](const v1::Envelope& request) {
      PeerAnswer answer = AnswerPeer(*holder_.store, request);
      distort(answer);
      return answer;
    });
    EXPECT_EQ(Fetch(info, {odd.location()}).status().code(), ErrorCode::kCorrupt);
  }
}

TEST_F(TransferTest, IgnoresAnswersToNoRequest) {
  const std::string bytes = RandomBytes(5000);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  // Never asked for, without end: silence all the same, and the other location serves.
  const auto channel = ServerChannel::Bind(context_, "ipc://*", {}).value();
  std::atomic<bool> stop = false;
  std::thread flood([&] {
    std::string peer;
    while (!stop) {
      if (const auto message = channel->Receive().value(); message.has_value()) peer = message->peer;
      v1::Envelope answer;
      answer.mutable_chunk();
      if (!peer.empty()) (void)channel->Send(peer, SerializeEnvelope(answer), std::string(1000, 'x')).ok();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  const Result<std::string> fetched = Fetch(info, {{channel->endpoint(), ""}, holder_.location()});
  const Result<std::string> from_flood = Fetch(info, {{channel->endpoint(), ""}});
  stop = true;
  flood.join();
  ASSERT_TRUE(fetched.ok()) << fetched.status().message();
  EXPECT_EQ(*fetched, bytes);
  EXPECT_THAT(from_flood.status().message(), HasSubstr("silent for"));
}

TEST_F(TransferTest, RefusesAnArtifactBeyondItsBoundWithoutAsking) {
  FetchOptions options = SmallChunks();
  options.max_artifact_bytes = 100;
  ArtifactClient client(context_, {}, options);
  const std::vector<ArtifactLocation> locations{holder_.location()};
  EXPECT_THAT(client.Fetch({Key(1), 101, {}}, locations, {}).status().message(), HasSubstr("at most 100"));
}

TEST_F(TransferTest, StopsWhenAsked) {
  // A peer that never answers, asked by a client that would wait for it for hours.
  ArtifactClient client(context_, {}, SmallChunks(std::chrono::hours(10)));
  OddPeer silent(context_, [&](const v1::Envelope&) {
    stop_.request_stop();
    return PeerAnswer();
  });
  const std::vector<ArtifactLocation> locations{silent.location()};
  EXPECT_EQ(client.Fetch({Key(1), 10, {}}, locations, stop_.get_token()).status().code(), ErrorCode::kCancelled);
}

TEST_F(TransferTest, StopsAmidATransferAndServesTheNext) {
  const std::string bytes = RandomBytes(1'000'000);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  std::atomic<int> answered = 0;
  OddPeer peer(context_, [&](const v1::Envelope& request) {
    if (++answered == 100) stop_.request_stop();
    return AnswerPeer(*holder_.store, request);
  });
  EXPECT_EQ(Fetch(info, {peer.location(), holder_.location()}).status().code(), ErrorCode::kCancelled);
  EXPECT_LT(peer.asked(), 1000);
  const std::vector<ArtifactLocation> locations{peer.location(), holder_.location()};
  EXPECT_EQ(client_.Fetch(info, locations, {}).value(), bytes);
}

TEST(AnswerPeer, RefusesWhatIsNoRequestForAChunk) {
  const testing_support::TemporaryFolder folder;
  const auto store = ArtifactStore::Open(folder.path(), 1 << 20).value();
  ASSERT_TRUE(store->Put(Key(1), "artifact").ok());
  const auto code_of = [&](const std::string& key, std::uint64_t offset, std::uint32_t max_bytes) {
    v1::Envelope request;
    request.set_request_id(9);
    request.mutable_get_chunk()->set_key(key);
    request.mutable_get_chunk()->set_offset(offset);
    request.mutable_get_chunk()->set_max_bytes(max_bytes);
    const v1::Envelope answer = AnswerPeer(*store, request).envelope;
    EXPECT_EQ(answer.request_id(), 9);
    return answer.chunk().error().code();
  };
  EXPECT_EQ(code_of(DigestBytes(Key(1)), 0, 100), v1::CODE_OK);
  EXPECT_EQ(code_of(DigestBytes(Key(2)), 0, 100), v1::CODE_UNAVAILABLE);
  EXPECT_EQ(code_of("short", 0, 100), v1::CODE_INVALID_ARGUMENT);
  EXPECT_EQ(code_of(DigestBytes(Key(1)), 9, 100), v1::CODE_INVALID_ARGUMENT);
  EXPECT_EQ(code_of(DigestBytes(Key(1)), ~std::uint64_t{0}, 100), v1::CODE_INVALID_ARGUMENT);
  EXPECT_EQ(code_of(DigestBytes(Key(1)), 0, 0), v1::CODE_INVALID_ARGUMENT);
  EXPECT_EQ(code_of(DigestBytes(Key(1)), 0, kMaxChunkBytes + 1), v1::CODE_INVALID_ARGUMENT);

  v1::Envelope stop;
  stop.mutable_stop_worker();
  EXPECT_EQ(AnswerPeer(*store, stop).envelope.error().code(), v1::CODE_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace depthfarm
