#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <random>
#include <thread>

#include "common/digest/sha256.h"
#include "common/wire/task_wire.h"
#include "tests/support/temporary_folder.h"
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
  using Answer = std::function<v1::Envelope(const v1::Envelope&)>;
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
        v1::Envelope answer = answer_(request);
        answer.set_request_id(request.request_id());
        if (answer.body_case() == v1::Envelope::BODY_NOT_SET) continue;
        EXPECT_TRUE(channel_->Send((*message)->peer, SerializeEnvelope(answer)).ok());
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
    return ++answered > 6 ? v1::Envelope() : AnswerPeer(*holder_.store, request);
  });
  std::atomic<int> resumed = 0;
  OddPeer second(context_, [&](const v1::Envelope& request) {
    ++resumed;
    return AnswerPeer(*holder_.store, request);
  });
  EXPECT_EQ(Fetch(info, {dying.location(), second.location()}).value(), bytes);
  EXPECT_EQ(resumed, 4);
}

TEST_F(TransferTest, NeverHasMoreRequestsUnderWayThanItsCredit) {
  OddPeer silent(context_, [](const v1::Envelope&) { return v1::Envelope(); });
  EXPECT_FALSE(Fetch({Key(1), 10000, {}}, {silent.location()}).ok());
  EXPECT_EQ(silent.asked(), SmallChunks().chunks_in_flight);
}

TEST_F(TransferTest, RefusesOtherBytesAndTakesTheRightOnesElsewhere) {
  const std::string bytes = RandomBytes(2500);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  OddPeer liar(context_, [&](const v1::Envelope& request) {
    v1::Envelope answer = AnswerPeer(*holder_.store, request);
    answer.mutable_chunk()->mutable_data()->front() ^= 1;
    return answer;
  });
  EXPECT_EQ(Fetch(info, {liar.location()}).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(Fetch(info, {liar.location(), holder_.location()}).value(), bytes);
}

TEST_F(TransferTest, StartsAnewWhenPiecesOfAnEarlierLocationWereWrong) {
  const std::string bytes = RandomBytes(10000);
  const ArtifactInfo info = holder_.store->Put(Key(1), bytes).value();
  int answered = 0;
  OddPeer lying_and_dying(context_, [&](const v1::Envelope& request) {
    if (++answered > 2) return v1::Envelope();
    v1::Envelope answer = AnswerPeer(*holder_.store, request);
    answer.mutable_chunk()->mutable_data()->front() ^= 1;
    return answer;
  });
  EXPECT_EQ(Fetch(info, {lying_and_dying.location(), holder_.location()}).value(), bytes);
}

TEST_F(TransferTest, RefusesChunksThatDoNotFit) {
  const ArtifactInfo info = holder_.store->Put(Key(1), RandomBytes(5000)).value();
  const std::vector<std::function<void(v1::Chunk&)>> distortions{
      [](v1::Chunk& chunk) { chunk.mutable_data()->push_back('x'); },
      [](v1::Chunk& chunk) { chunk.mutable_data()->pop_back(); },
      [](v1::Chunk& chunk) { chunk.set_offset(chunk.offset() + 1); },
      [](v1::Chunk& chunk) { chunk.set_total_bytes(1); },
      [](v1::Chunk& chunk) { chunk.set_key("key"); },
  };
  for (const auto& distort : distortions) {
    OddPeer odd(context_, [&](const v1::Envelope& request) {
      v1::Envelope answer = AnswerPeer(*holder_.store, request);
      distort(*answer.mutable_chunk());
      return answer;
    });
    EXPECT_EQ(Fetch(info, {odd.location()}).status().code(), ErrorCode::kCorrupt);
  }
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
    return v1::Envelope();
  });
  const std::vector<ArtifactLocation> locations{silent.location()};
  EXPECT_EQ(client.Fetch({Key(1), 10, {}}, locations, stop_.get_token()).status().code(), ErrorCode::kCancelled);
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
    const v1::Envelope answer = AnswerPeer(*store, request);
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
  EXPECT_EQ(AnswerPeer(*store, stop).error().code(), v1::CODE_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace depthfarm
