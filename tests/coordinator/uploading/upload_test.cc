#include "coordinator/uploading/upload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "common/digest/sha256.h"
#include "common/transport/farm_keys.h"
#include "tests/support/temporary_folder.h"
#include "worker/artifacts/artifact_digest.h"
#include "worker/transfer/artifact_client.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

// Three cameras of three frames; the job has two of the cameras, and frames 1 and 2.
class UploadTest : public testing::Test {
 protected:
  UploadTest() {
    for (int c = 0; c < 3; ++c) {
      SequenceCamera camera;
      camera.camera.name = "cam" + std::to_string(c);
      for (int f = 0; f < 3; ++f)
        camera.images.push_back(Write("p" + std::to_string(c) + std::to_string(f), "picture"));
      if (c == 1) camera.masks = {"", "", Write("mask", "mask")};
      sequence_.cameras.push_back(camera);
    }
    for (const int c : {0, 1}) {
      JobView view;
      view.camera.name = "cam" + std::to_string(c);
      job_.views.push_back(view);
    }
    job_.params.first_frame = 1;
    job_.num_frames = 2;
  }
  std::string Write(const std::string& name, const std::string& kind) {
    const std::string path = (folder_.path() / name).string();
    std::ofstream(path) << kind << " " << name;
    return path;
  }
  [[nodiscard]] Result<std::unique_ptr<Upload>> Start(const CoordinatorTarget& farm) {
    return Upload::Start(farm, {}, sequence_, job_, [&](std::size_t read, std::size_t all) {
      read_ = read;
      all_ = all;
      return false;
    });
  }
  [[nodiscard]] CoordinatorTarget Ipc() const {
    return {.endpoint = "ipc://" + (folder_.path() / "coordinator").string(), .keys_dir = ""};
  }
  static Result<std::string> Fetch(TransportContext& context, const CurveKeys& keys, const UploadedFile& upload,
                                   const ArtifactLocation& from) {
    FetchOptions options;
    options.silence = std::chrono::milliseconds(1000);
    ArtifactClient client(context, keys, options);
    return client.Fetch(
        {.key = upload.file.sha256, .stored_bytes = upload.file.bytes, .content_digest = upload.artifact_digest},
        std::array{from}, {});
  }

  testing_support::TemporaryFolder folder_;
  Sequence sequence_;
  ResolvedJob job_;
  std::size_t read_ = 0;
  std::size_t all_ = 0;
};

TEST_F(UploadTest, ServesTheFilesOfTheJobAndNoOthers) {
  const auto upload = Start(Ipc());
  ASSERT_TRUE(upload.ok()) << upload.status().message();
  EXPECT_EQ(read_, 5U);
  EXPECT_EQ(all_, 5U);
  const UploadSubmission& submission = upload.value()->submission();
  ASSERT_THAT(submission.cameras, SizeIs(3));
  ASSERT_THAT(submission.cameras[1].images, SizeIs(3));
  EXPECT_EQ(submission.cameras[1].images[0], UploadedFile()) << "of no frame of the job";
  EXPECT_EQ(submission.cameras[1].images[2].file.sha256, Sha256("picture p12"));
  EXPECT_EQ(submission.cameras[1].masks[2].file.sha256, Sha256("mask mask"));
  EXPECT_THAT(submission.cameras[2].images, SizeIs(0)) << "no view of the job";

  TransportContext context;
  const auto bytes = Fetch(context, {}, submission.cameras[0].images[1], submission.from);
  ASSERT_TRUE(bytes.ok()) << bytes.status().message();
  EXPECT_EQ(*bytes, "picture p01");
  EXPECT_FALSE(
      Fetch(context, {}, {{Sha256("picture p20"), 11}, DigestOfArtifact("picture p20")}, submission.from).ok());
}

TEST_F(UploadTest, AdmitsWorkersAlone) {
  const std::string keys = (folder_.path() / "keys").string();
  ASSERT_TRUE(CreateFarmKeys(keys).ok());
  const auto upload = Start({.endpoint = "tcp://127.0.0.1:7700", .keys_dir = keys});
  ASSERT_TRUE(upload.ok()) << upload.status().message();
  const UploadSubmission& submission = upload.value()->submission();
  EXPECT_THAT(submission.from.endpoint, HasSubstr("tcp://127.0.0.1:"));
  const UploadedFile& file = submission.cameras[0].images[1];
  TransportContext context;
  EXPECT_EQ(Fetch(context, ReadWorkerKeys(keys).value().own, file, submission.from).value(), "picture p01");
  EXPECT_FALSE(Fetch(context, ReadClientKeys(keys).value().own, file, submission.from).ok());
}

TEST_F(UploadTest, SaysWhatIsWrong) {
  const std::string keys = (folder_.path() / "keys").string();
  ASSERT_TRUE(CreateFarmKeys(keys).ok());
  std::filesystem::remove(folder_.path() / "keys/authorized");
  const auto upload = Start({.endpoint = "tcp://127.0.0.1:7700", .keys_dir = keys});
  EXPECT_EQ(upload.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(upload.status().message(), HasSubstr("has no 'authorized'"));
  EXPECT_EQ(Start({.endpoint = "tcp://10.0.0.1:7700", .keys_dir = ""}).status().code(), ErrorCode::kInvalidArgument);
  std::filesystem::remove(folder_.path() / "p11");
  EXPECT_THAT(Start(Ipc()).status().message(), HasSubstr("p11: cannot open the file"));
}

}  // namespace
}  // namespace depthfarm
