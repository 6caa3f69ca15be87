#include "worker/transfer/served_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/digest/sha256.h"
#include "tests/support/temporary_folder.h"
#include "worker/artifacts/artifact_digest.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;

bool Never() { return false; }

class ServedFilesTest : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& content) {
    const std::string path = (folder_.path() / name).string();
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  testing_support::TemporaryFolder folder_;
  ServedFiles files_;
};

TEST_F(ServedFilesTest, AreServedInPiecesByTheDigestOfTheirContent) {
  const std::string content(3'000'000, 'x');
  const Result<UploadedFile> upload = files_.Add(Write("a.png", content), Never);
  ASSERT_TRUE(upload.ok()) << upload.status().message();
  EXPECT_EQ(*upload, (UploadedFile{{Sha256(content), content.size()}, DigestOfArtifact(content)}));
  EXPECT_EQ(files_.Add((folder_.path() / "a.png").string(), Never).value(), *upload);
  const ArtifactKey key = upload->file.sha256;

  const Result<ArtifactChunk> chunk = files_.ReadChunk(key, 2'999'990, 100);
  ASSERT_TRUE(chunk.ok()) << chunk.status().message();
  EXPECT_EQ(chunk->total_bytes, content.size());
  EXPECT_EQ(chunk->data.view(), content.substr(0, 10));
  EXPECT_EQ(files_.ReadChunk(key, 3'000'001, 1).status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(files_.ReadChunk(Sha256("other"), 0, 1).status().code(), ErrorCode::kUnavailable);
}

TEST_F(ServedFilesTest, ThatWereChangedAreNot) {
  const ArtifactKey key = files_.Add(Write("a.png", "before"), Never).value().file.sha256;
  Write("a.png", "after!");
  std::filesystem::last_write_time(folder_.path() / "a.png",
                                   std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  const Result<ArtifactChunk> chunk = files_.ReadChunk(key, 0, 6);
  EXPECT_EQ(chunk.status().code(), ErrorCode::kCorrupt);
  EXPECT_THAT(chunk.status().message(), HasSubstr("a.png: was changed since the job was submitted"));
  std::filesystem::remove(folder_.path() / "a.png");
  EXPECT_EQ(files_.ReadChunk(key, 0, 6).status().code(), ErrorCode::kUnavailable);
}

TEST_F(ServedFilesTest, RefusesWhatIsNoFile) {
  EXPECT_EQ(files_.Add(folder_.path().string(), Never).status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(files_.Add(Write("empty", ""), Never).status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(files_.Add((folder_.path() / "none").string(), Never).status().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(files_.Add(Write("b", "content"), [] { return true; }).status().code(), ErrorCode::kCancelled);
}

}  // namespace
}  // namespace depthfarm
