#include "common/media/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/files/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;

Grid<float> Values() {
  Grid<float> values(37, 29);  // several blocks of lines
  for (std::size_t i = 0; i < values.size(); ++i) values.values()[i] = 1.0F + std::sqrt(static_cast<float>(i));
  values(0, 0) = 0;
  values(1, 0) = -2.5F;
  values(2, 0) = std::numeric_limits<float>::infinity();
  values(3, 0) = std::numeric_limits<float>::denorm_min();
  return values;
}

// A file as other programs make them: channels of the names and the type, all of the value.
class OtherPrograms : public testing::Test {
 protected:
  [[nodiscard]] std::string File(const std::vector<std::string>& channels, Imf::PixelType type, float value,
                                 const Imath::Box2i& data = {{0, 0}, {3, 1}}) const {
    const std::string path = (folder_.path() / "other.exr").string();
    const Imath::Box2i display{{0, 0}, {3, 1}};
    Imf::Header header(display, data);
    std::vector<float> floats(64, value);
    std::vector<Imath::half> halves(64, Imath::half(value));
    Imf::FrameBuffer frame;
    for (const std::string& channel : channels) {
      header.channels().insert(channel, Imf::Channel(type));
      void* const pixels = type == Imf::HALF ? static_cast<void*>(halves.data()) : static_cast<void*>(floats.data());
      frame.insert(channel, Imf::Slice::Make(type, pixels, data));
    }
    {
      Imf::OutputFile file(path.c_str(), header, 0);
      file.setFrameBuffer(frame);
      file.writePixels(data.max.y - data.min.y + 1);
    }
    return ReadFileBytes(path, 1 << 20).value();
  }

  testing_support::TemporaryFolder folder_;
};

TEST(Exr, EveryValueComesBack) {
  const auto bytes = EncodeExr(Values());
  ASSERT_TRUE(bytes.ok()) << bytes.status().message();
  EXPECT_TRUE(IsExr(*bytes));
  const auto values = DecodeExr(*bytes);
  ASSERT_TRUE(values.ok()) << values.status().message();
  EXPECT_EQ(*values, Values());
  Grid<float> nan(1, 1, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(std::isnan(DecodeExr(*EncodeExr(nan))->values()[0]));
}

TEST(Exr, EqualValuesAreEqualBytesOfWhichNoneTellsWhenOrWhere) {
  const std::string bytes = *EncodeExr(Values());
  EXPECT_TRUE(bytes == *EncodeExr(Values()));
  for (const char* attribute : {"capDate", "comments", "owner", "software"})
    EXPECT_EQ(bytes.find(attribute), std::string::npos) << attribute;
}

TEST_F(OtherPrograms, DepthIsChannelZOrTheOnlyOne) {
  EXPECT_EQ(DecodeExr(File({"Z"}, Imf::FLOAT, 2.5F)).value(), Grid<float>(4, 2, 2.5F));
  EXPECT_EQ(DecodeExr(File({"A", "B", "Z"}, Imf::FLOAT, 2.5F)).value(), Grid<float>(4, 2, 2.5F));
  EXPECT_EQ(DecodeExr(File({"ViewLayer.Depth.V"}, Imf::HALF, 2.5F)).value(), Grid<float>(4, 2, 2.5F));
}

TEST_F(OtherPrograms, EveryKindOfCompressionAndTilesAreRead) {
  const Grid<float> expected = Values();
  for (const auto compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    for (const bool tiled : {false, true}) {
      const std::string path = (folder_.path() / "other.exr").string();
      Imf::Header header(expected.width(), expected.height());
      header.compression() = compression;
      header.lineOrder() = tiled ? Imf::INCREASING_Y : Imf::DECREASING_Y;
      header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
      Imf::FrameBuffer frame;
      frame.insert("Z", Imf::Slice::Make(Imf::FLOAT, expected.values().data(), header.dataWindow()));
      if (tiled) {
        header.setTileDescription(Imf::TileDescription(16, 8, Imf::ONE_LEVEL));
        Imf::TiledOutputFile file(path.c_str(), header, 0);
        file.setFrameBuffer(frame);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
      } else {
        Imf::OutputFile file(path.c_str(), header, 0);
        file.setFrameBuffer(frame);
        file.writePixels(expected.height());
      }
      const auto values = DecodeExr(ReadFileBytes(path, 1 << 20).value());
      ASSERT_TRUE(values.ok()) << values.status().message();
      EXPECT_TRUE(*values == expected) << compression << (tiled ? ", tiled" : "");
    }
  }
}

TEST_F(OtherPrograms, OtherFilesAreExplained) {
  const auto message = [](const std::string& bytes) {
    const Result<Grid<float>> values = DecodeExr(bytes);
    EXPECT_EQ(values.status().code(), ErrorCode::kInvalidArgument);
    return values.status().message();
  };
  EXPECT_THAT(message(File({"R", "G", "B"}, Imf::HALF, 1)), HasSubstr("several channels and none is Z"));
  EXPECT_THAT(message(File({"Z"}, Imf::FLOAT, 1, {{-1, 0}, {3, 1}})), HasSubstr("outside of its picture"));
  EXPECT_THAT(message(""), HasSubstr("is not an OpenEXR file"));
  EXPECT_THAT(message("Pf\n1 1\n-1\n1234"), HasSubstr("is not an OpenEXR file"));
}

TEST(Exr, ADamagedFileIsRefusedOrHasItsSize) {
  const std::string bytes = *EncodeExr(Values());
  for (std::size_t size = 0; size < bytes.size(); size += 7)
    EXPECT_EQ(DecodeExr(bytes.substr(0, size)).status().code(), ErrorCode::kInvalidArgument) << size;
  for (std::size_t at = 4; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x41);
    const auto values = DecodeExr(damaged);
    if (values.ok()) {
      EXPECT_EQ(values->size(), Values().size()) << at;
    }
  }
}

TEST(Exr, AFileThatSaysItHoldsMoreThanItCanIsRefused) {
  std::string bytes = *EncodeExr(Values());
  // 20000 x 20000 in both windows: 1.6 GB from 4 KB.
  const std::string window("\0\0\0\0\0\0\0\0\x24\0\0\0\x1c\0\0\0", 16);
  const std::string large("\0\0\0\0\0\0\0\0\x1f\x4e\0\0\x1f\x4e\0\0", 16);
  int replaced = 0;
  for (std::size_t at = bytes.find(window); at != std::string::npos; at = bytes.find(window, at)) {
    bytes.replace(at, large.size(), large);
    ++replaced;
  }
  ASSERT_EQ(replaced, 2);
  EXPECT_EQ(DecodeExr(bytes).status().code(), ErrorCode::kInvalidArgument);
}

TEST(Exr, AnEmptyMapIsAnError) { EXPECT_FALSE(EncodeExr(Grid<float>()).ok()); }

}  // namespace
}  // namespace depthfarm
