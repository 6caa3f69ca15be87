#include "common/sequence/read_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <vector>

#include "tests/common/sequence/sequence_text.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing_support::TemporaryFolder;

TEST(ReadSequence, ReadsEveryField) {
  const TemporaryFolder folder;
  const auto sequence = ReadSequence(folder.Write("set/cameras.json", kSequenceText));
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_EQ(sequence->name, "small");
  EXPECT_EQ(sequence->file, folder.File("set/cameras.json"));
  EXPECT_EQ(sequence->z_near, 2);
  EXPECT_EQ(sequence->z_far, 10);
  EXPECT_EQ(sequence->frame_rate, 15);
  EXPECT_EQ(sequence->reference, "b");
  EXPECT_THAT(sequence->warnings, IsEmpty());
  ASSERT_EQ(sequence->cameras.size(), 2U);
  const SequenceCamera& a = sequence->cameras[0];
  EXPECT_EQ(a.camera.name, "a");
  EXPECT_EQ(a.camera.width, 64);
  EXPECT_EQ(a.camera.height, 48);
  EXPECT_EQ(a.camera.intrinsics(0, 2), 31.5);
  EXPECT_EQ(a.camera.intrinsics(1, 1), 50);
  EXPECT_EQ(a.format, PictureFormat());
  EXPECT_THAT(a.images, ElementsAre(folder.File("set/a/0.png"), folder.File("set/a/1.png")));
  EXPECT_FALSE(a.z_near.has_value());
  const SequenceCamera& b = sequence->cameras[1];
  EXPECT_EQ(b.camera.cam_from_world_translation[0], -1);
  EXPECT_EQ(b.format, (PictureFormat{PictureFormat::Kind::kYuv420, 10, true, true}));
  EXPECT_THAT(b.images, ElementsAre(folder.File("set/b/0.yuv"), folder.File("set/b/1.yuv")));
  EXPECT_THAT(b.masks, ElementsAre(folder.File("set/m0"), folder.File("set/m1")));
  EXPECT_EQ(b.z_near, 3);
}

TEST(ReadSequence, TakesTheFoldersNameWhenThereIsNone) {
  const TemporaryFolder folder;
  const auto sequence =
      ReadSequence(folder.Write("ballet/cameras.json", Replaced(kSequenceText, R"("name": "small",)", "")));
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_EQ(sequence->name, "ballet");
}

TEST(ReadSequence, CameraWithoutPicturesIsKnown) {
  const TemporaryFolder folder;
  const auto sequence = ReadSequence(folder.Write("s.json", Replaced(kSequenceText, R"("a/0.png", "a/1.png")", "")));
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_THAT(sequence->cameras[0].images, IsEmpty());
}

TEST(ReadSequence, KnowsTheNamesOfRawFormats) {
  using Kind = PictureFormat::Kind;
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, PictureFormat>> cases = {
      {"yuv420p8", {Kind::kYuv420, 8, false, false}},     {"yuv420p12le", {Kind::kYuv420, 12, false, false}},
      {"yuv420p16le", {Kind::kYuv420, 16, false, false}}, {"yuv420p9le", {Kind::kYuv420, 9, false, false}},
      {"gray8", {Kind::kYuv400, 8, false, false}},        {"gray10le", {Kind::kYuv400, 10, false, false}},
      {"gray16le", {Kind::kYuv400, 16, false, false}},    {"yuv422p10le", {Kind::kYuv422, 10, false, false}},
      {"yuv444p8", {Kind::kYuv444, 8, false, false}},
  };
  for (const auto& [name, format] : cases) {
    const std::string text =
        Replaced(Replaced(kSequenceText, R"("yuv420p10le", "range": "full", "matrix": "bt709")", "\"" + name + "\""),
                 "small", "formats");
    const auto sequence = ReadSequence(folder.Write("s.json", text));
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    EXPECT_EQ(sequence->cameras[1].format, format) << name;
  }
}

TEST(ReadSequence, AVideoIsTheFileOfAllFrames) {
  using Kind = PictureFormat::Kind;
  const TemporaryFolder folder;
  const auto first = [&](const std::string& keys) {
    const auto sequence = ReadSequence(folder.Write("s.json", Replaced(kSequenceText, kImagesOfA, keys)));
    EXPECT_TRUE(sequence.ok()) << sequence.status().message();
    return sequence.ok() ? sequence->cameras[0] : SequenceCamera();
  };
  const SequenceCamera coded = first(R"("video": {"path": "v/a.mp4", "frames": 2})");
  EXPECT_THAT(coded.images, ElementsAre(folder.File("v/a.mp4"), folder.File("v/a.mp4")));
  EXPECT_EQ(coded.format, (PictureFormat{.kind = Kind::kVideo}));
  EXPECT_EQ(first(R"("range": "full", "matrix": "bt601", "video": {"path": "a.mkv", "frames": 2})").format,
            (PictureFormat{.kind = Kind::kVideo, .full_range = true, .colour_said = true}));
  const PictureFormat raw{.kind = Kind::kYuv422, .bits = 10, .bt709 = true, .all_frames = true};
  EXPECT_EQ(first(R"("matrix": "bt709", "video": {"path": "a.yuv", "format": "yuv422p10le", "frames": 2})").format,
            raw);

  // How many a raw one has is told by its size: 64 x 48 samples and as many of chroma, of two bytes.
  folder.Write("a.yuv", std::string(std::size_t{2} * 64 * 48 * 2 * 2, 'x'));
  EXPECT_EQ(first(R"("video": {"path": "a.yuv", "format": "yuv422p10le"})").images.size(), 2U);
  folder.Write("a.yuv", std::string(std::size_t{2} * 64 * 48 * 2 * 2 + 1, 'x'));
  const auto odd = ReadSequence(folder.Write(
      "s.json", Replaced(kSequenceText, kImagesOfA, R"("video": {"path": "a.yuv", "format": "yuv422p10le"})")));
  EXPECT_THAT(odd.status().message(), HasSubstr("a.yuv holds 24577 bytes, expected 1 to 1000000 pictures of 12288"));
}

TEST(ReadSequence, AcceptsOutsidePathsOnlyWhenAllowed) {
  const TemporaryFolder folder;
  for (const auto& [path, resolved] : {std::pair<std::string, std::string>{"../c.png", folder.File("c.png")},
                                       {"/data/c.png", "/data/c.png"},
                                       {"a/../../c.png", folder.File("c.png")}}) {
    const std::string file = folder.Write("set/s.json", Replaced(kSequenceText, "a/1.png", path));
    const auto refused = ReadSequence(file);
    EXPECT_EQ(refused.status().code(), ErrorCode::kInvalidArgument) << path;
    EXPECT_THAT(refused.status().message(), HasSubstr("camera \"a\""));
    EXPECT_THAT(refused.status().message(), HasSubstr("frame 1"));
    EXPECT_THAT(refused.status().message(), HasSubstr("--allow-outside"));
    const auto allowed = ReadSequence(file, {.allow_outside = true});
    ASSERT_TRUE(allowed.ok()) << allowed.status().message();
    EXPECT_EQ(allowed->cameras[0].images[1], resolved);
  }
}

TEST(ReadSequence, MissingFileIsTheUsersError) {
  const TemporaryFolder folder;
  const auto sequence = ReadSequence(folder.File("none.json"));
  EXPECT_EQ(sequence.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(sequence.status().message(), HasSubstr(folder.File("none.json")));
}

TEST(ReadSequence, RefusesMoreCamerasThanTheBound) {
  const TemporaryFolder folder;
  std::string cameras = "{}";
  for (int i = 0; i < kMaxCameras; ++i) cameras += ",{}";
  const auto sequence = ReadSequence(folder.Write("s.json", "{\"cameras\":[" + cameras + "]}"));
  EXPECT_THAT(sequence.status().message(), HasSubstr("'cameras' has 1025 entries, expected at most 1024"));
}

TEST(ReadSequence, RefusesDeepNestingEvenInIgnoredKeys) {
  const TemporaryFolder folder;
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  const auto sequence = ReadSequence(folder.Write("s.json", Replaced(kSequenceText, R"({"any": [1, "thing"]})", deep)));
  EXPECT_THAT(sequence.status().message(), HasSubstr("nested deeper than 64"));
}

// One change of the small sequence and words its message must hold.
struct BadInput {
  std::string name;
  std::string from;
  std::string to;
  std::vector<std::string> words;
};

void PrintTo(const BadInput& input, std::ostream* out) { *out << input.name; }

class ReadSequenceRefuses : public ::testing::TestWithParam<BadInput> {};

TEST_P(ReadSequenceRefuses, WithTheThingTheValueAndTheExpectation) {
  const BadInput& input = GetParam();
  const TemporaryFolder folder;
  const std::string file = folder.Write("s.json", Replaced(kSequenceText, input.from, input.to));
  const auto sequence = ReadSequence(file);
  ASSERT_FALSE(sequence.ok());
  EXPECT_EQ(sequence.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(sequence.status().message(), HasSubstr(file));
  for (const std::string& word : input.words) EXPECT_THAT(sequence.status().message(), HasSubstr(word));
}

const std::vector<BadInput> kBadInputs = {
    {"NotJson", "\"cameras\": [", "\"cameras\": ", {"not valid JSON", "line 7"}},
    {"Comment", "\"notes\": \"free\",", "/* no */", {"not valid JSON", "line 2"}},
    {"TrailingText", "  ]\n}", "  ]\n} x", {"not valid JSON"}},
    {"NotUtf8", "free", "fr\xff", {"not valid JSON", "UTF-8"}},
    {"NanLiteral", "31.5", "NaN", {"not valid JSON"}},
    {"NumberPastDouble", "31.5", "1e999", {"not valid JSON", "1e999"}},
    {"NotAnObject", kSequenceText, "[1, 2]", {"is [1,2]", "expected an object"}},
    {"DuplicateKey", "\"zFar\": 10", "\"zFar\": 10, \"zFar\": 11", {"\"zFar\"", "twice"}},
    {"DuplicateCameraKey", "\"width\": 64", "\"width\": 64, \"width\": 65", {"\"width\"", "twice"}},
    {"DuplicateIgnoredKey", "\"any\"", "\"any\": 0, \"any\"", {"\"any\"", "twice"}},
    {"UnknownKey", "\"frameRate\"", "\"framerate\"", {"unknown key \"framerate\"", "frameRate"}},
    {"UnknownCameraKey", "\"x-row\"", "\"row\"", {"camera \"a\"", "unknown key \"row\""}},
    {"NoCameras", "\"cameras\"", "\"x-cameras\"", {"'cameras' is missing"}},
    {"CamerasNotAList", "\"cameras\": [", "\"cameras\": 3, \"x-cameras\": [", {"'cameras' is 3", "a list"}},
    {"NameMissing", "{\"name\": \"a\", ", "{", {"cameras[0]", "'name' is missing"}},
    {"NameNotAText", "\"name\": \"a\"", "\"name\": 7", {"cameras[0]", "'name' is 7", "a text"}},
    {"NameEmpty", "\"name\": \"a\"", "\"name\": \"\"", {"cameras[0]", "at least one character"}},
    {"NameWithSlash", "\"name\": \"a\"", "\"name\": \"a/b\"", {"\"a/b\"", "without '/'"}},
    {"NameWithDots", "\"name\": \"a\"", "\"name\": \"a..b\"", {"\"a..b\"", "'..'"}},
    {"NameDot", "\"name\": \"a\"", "\"name\": \".\"", {"cameras[0]", "'name' is \".\""}},
    {"NameWithControl", "\"name\": \"a\"", "\"name\": \"a\\n\"", {"\"a\\n\"", "control"}},
    {"NameWithNul", "\"name\": \"a\"", "\"name\": \"a\\u0000\"", {"\\u0000", "control"}},
    {"NameTooLong", "\"name\": \"a\"", "\"name\": \"" + std::string(201, 'n') + "\"", {"at most 200"}},
    {"NameTwice", "\"name\": \"b\"", "\"name\": \"a\"", {"cameras[1]", "'a'", "earlier camera"}},
    {"WidthMissing", "\"width\": 64, ", "", {"camera \"a\"", "'width' is missing"}},
    {"WidthZero", "\"width\": 64", "\"width\": 0", {"camera \"a\"", "'width' is 0", "1 to 32768"}},
    {"WidthFraction", "\"width\": 64", "\"width\": 64.5", {"'width' is 64.5", "whole number"}},
    {"WidthText", "\"width\": 64", "\"width\": \"64\"", {"'width' is \"64\"", "whole number"}},
    {"WidthHuge", "\"width\": 64", "\"width\": 1e300", {"'width' is", "32768"}},
    {"KOfTwoRows", ", [0, 0, 1]],", "],", {"camera \"a\"", "'K'", "3 rows of 3"}},
    {"KRowOfTwo", "[50, 0, 31.5]", "[50, 0]", {"camera \"a\"", "'K'", "3 rows of 3"}},
    {"KWithText", "31.5", "\"31.5\"", {"camera \"a\"", "'K'", "finite numbers"}},
    {"KWithNull", "31.5", "null", {"camera \"a\"", "'K'", "finite numbers"}},
    {"FocalLengthNegative", "[50, 0, 31.5]", "[-50, 0, 31.5]", {"camera 'a'", "-50", "> 0"}},
    {"RotationMissing", "\"R\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], ", "", {"camera \"a\"", "'R' is missing"}},
    {"RotationScaled", "\"R\": [[1, 0, 0]", "\"R\": [[2, 0, 0]", {"camera 'a'", "not a rotation"}},
    {"RotationMirrors", "\"R\": [[1, 0, 0]", "\"R\": [[-1, 0, 0]", {"camera 'a'", "mirrors"}},
    {"TranslationOfTwo", "\"t\": [0, 0, 0]", "\"t\": [0, 0]", {"camera \"a\"", "'t' is [0,0]", "3 finite"}},
    {"ImagesMissing", "\"images\": [\"a/0.png\", \"a/1.png\"], ", "", {"camera \"a\"", "'images' is missing"}},
    {"ImagesText", "[\"a/0.png\", \"a/1.png\"]", "\"a/0.png\"", {"camera \"a\"", "'images'", "a list"}},
    {"ImageNumber", "\"a/1.png\"", "1", {"camera \"a\"", "'images[1]' is 1", "a text"}},
    {"ImageEmpty", "\"a/1.png\"", "\"\"", {"camera \"a\"", "frame 1", "path of a file"}},
    {"ImageFolder", "\"a/1.png\"", "\"a/\"", {"camera \"a\"", "frame 1", "not a folder"}},
    {"ImageDot", "\"a/1.png\"", "\".\"", {"camera \"a\"", "frame 1", "not a folder"}},
    {"ImageWithNul", "\"a/1.png\"", "\"a\\u0000.png\"", {"camera \"a\"", "frame 1", "control"}},
    {"ImageCountsDiffer", ", \"a/1.png\"", "", {"camera 'b' has 2 images", "camera 'a' has 1"}},
    {"MaskCountDiffers", "[\"m0\", \"m1\"]", "[\"m0\"]", {"camera 'b'", "'masks' has 1", "2"}},
    {"MaskOutside", "\"m1\"", "\"../m1\"", {"camera \"b\"", "'masks' of frame 1", "\"../m1\""}},
    {"FormatUnknown", "yuv420p10le", "yuv444p", {"camera \"b\"", "\"yuv444p\"", "yuv420p8"}},
    {"FormatOf17Bits", "yuv420p10le", "yuv420p17le", {"camera \"b\"", "\"yuv420p17le\""}},
    {"FormatBigEndian", "yuv420p10le", "yuv420p10be", {"camera \"b\"", "\"yuv420p10be\""}},
    {"RangeUnknown", "\"range\": \"full\"", "\"range\": \"tv\"", {"'range' is \"tv\"", "limited or full"}},
    {"MatrixUnknown", "\"bt709\"", "\"bt2020\"", {"'matrix' is \"bt2020\"", "bt601 or bt709"}},
    {"RangeOfImageFiles", "\"format\": \"yuv420p10le\", ", "", {"camera \"b\"", "'range'", "without 'format'"}},
    {"VideoAndImages",
     "\"x-row\": 3",
     "\"video\": {\"path\": \"a.mp4\", \"frames\": 2}",
     {"camera \"a\"", "either a video or pictures"}},
    {"VideoNoObject", kImagesOfA, "\"video\": \"a.mp4\"", {"(camera \"a\"): 'video'", "\"a.mp4\""}},
    {"VideoWithoutPath", kImagesOfA, "\"video\": {\"frames\": 2}", {"(camera \"a\"): 'video'", "'path'"}},
    {"VideoOutside",
     kImagesOfA,
     "\"video\": {\"path\": \"../a.mp4\", \"frames\": 2}",
     {"(camera \"a\"): 'video'", "'path'", "\"../a.mp4\"", "--allow-outside"}},
    {"VideoUnknownKey",
     kImagesOfA,
     "\"video\": {\"path\": \"a.mp4\", \"frames\": 2, \"fps\": 3}",
     {"(camera \"a\"): 'video'", "unknown key \"fps\""}},
    {"VideoOfNoFrames",
     kImagesOfA,
     "\"video\": {\"path\": \"a.mp4\", \"frames\": 0}",
     {"(camera \"a\"): 'video'", "'frames' is 0"}},
    {"VideoCodedWithoutFrames",
     kImagesOfA,
     "\"video\": {\"path\": \"a.mp4\"}",
     {"(camera \"a\"): 'video'", "'frames'"}},
    {"VideoRawWithoutFramesOrFile",
     kImagesOfA,
     "\"video\": {\"path\": \"a.yuv\", \"format\": \"yuv420p8\"}",
     {"(camera \"a\"): 'video'", "'frames'", "/a.yuv cannot be looked at"}},
    {"VideoFormatUnknown",
     kImagesOfA,
     "\"video\": {\"path\": \"a.yuv\", \"format\": \"nv12\", \"frames\": 2}",
     {"(camera \"a\"): 'video'", "'format' is \"nv12\"", "coded videos"}},
    {"VideoHalfAColour",
     kImagesOfA,
     "\"range\": \"full\", \"video\": {\"path\": \"a.mp4\", \"frames\": 2}",
     {"camera \"a\"", "one of 'range' and 'matrix', expected both"}},
    {"VideoOfOtherLength",
     kImagesOfA,
     "\"video\": {\"path\": \"a.mp4\", \"frames\": 3}",
     {"camera 'b' has 2 images", "camera 'a' has 3"}},
    {"ZNearZero", "\"zNear\": 2.0", "\"zNear\": 0", {"'zNear' is 0", "> 0"}},
    {"ZFarText", "\"zFar\": 10", "\"zFar\": \"far\"", {"'zFar' is \"far\"", "number"}},
    {"ZNearBeyondZFar", "\"zNear\": 2.0", "\"zNear\": 20", {"zNear is 20", "zFar 10"}},
    {"CameraZNearBeyondZFar", "\"zNear\": 3", "\"zNear\": 10", {"camera \"b\"", "zNear is 10", "zFar 10"}},
    {"ReferenceUnknown", "\"reference\": \"b\"", "\"reference\": \"c\"", {"'reference' is 'c'"}},
    {"FrameRateZero", "\"frameRate\": 15", "\"frameRate\": 0", {"'frameRate' is 0"}},
    {"NotesNotAText", "\"notes\": \"free\"", "\"notes\": 1", {"'notes' is 1"}},
    {"OtherConvention", "\"notes\": \"free\"", "\"convention\": \"+y up\"", {"'convention' is \"+y up\""}},
    {"GroundTruthNotAnObject", "\"x-own\"", "\"groundTruth\": 3, \"x-own\"", {"groundTruth", "is 3"}},
};

INSTANTIATE_TEST_SUITE_P(BadInputs, ReadSequenceRefuses, ::testing::ValuesIn(kBadInputs),
                         [](const auto& input) { return input.param.name; });

}  // namespace
}  // namespace depthfarm
