// Files that are wrong, each in one way, and what is said of it: file, place, camera, and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>

#include "common/calibration/colmap_model.h"
#include "common/calibration/ftv.h"
#include "common/calibration/llff.h"
#include "common/calibration/middlebury.h"
#include "common/calibration/miv.h"
#include "common/calibration/msr.h"
#include "tests/support/calibration_samples.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

// `text` with its first `from` replaced; throws where there is none, so that no row passes by a typo.
std::string Replaced(std::string_view text, const std::string& from, const std::string& to) {
  std::string result(text);
  const std::size_t position = result.find(from);
  if (position == std::string::npos) throw std::invalid_argument("no '" + from + "' in the text");
  return result.replace(position, from.size(), to);
}

struct Row {
  std::string name;
  std::string file;  // its content
  Words says;
};

template <typename Parse>
void CheckRows(const Parse& parse, const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    const Status status = parse(row.file);
    EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
    for (const std::string& words : row.says) EXPECT_THAT(status.message(), HasSubstr(words));
  }
}

TEST(BadCalibrations, Ftv) {
  const auto parse = [](const std::string& text) { return ParseFtvCameras(text, "cam.txt", {640, 480}, {}).status(); };
  const std::string_view good = samples::kFtv;
  CheckRows(
      parse,
      {
          {"empty", "", {"cam.txt", "is empty"}},
          {"spaces", " \r\n\t\n", {"cam.txt", "is empty"}},
          {"comments", "# nothing\n", {"cam.txt", "holds no camera"}},
          {"binary", std::string("left\n\0\1", 7), {"cam.txt: line 2", "byte 0", "another format"}},
          {"a word in K",
           Replaced(good, "500 0", "500 zero"),
           {"cam.txt: line 3", "\"zero\"", "9 numbers of K", "left"}},
          {"NaN", Replaced(good, "319.5", "nan"), {"cam.txt: line 3", "\"nan\"", "finite"}},
          {"infinity", Replaced(good, "319.5", "1e999"), {"cam.txt: line 3", "\"1e999\"", "finite"}},
          {"a comma", Replaced(good, "319.5", "319,5"), {"cam.txt: line 3", "\"319,5\"", "number"}},
          {"distortion",
           Replaced(good, "0 0 1\n0\n", "0 0 1\n-0.1\n"),
           {"cam.txt: line 6", "left", "lens distortion", "remove"}},
          {"cut short", std::string(good.substr(0, good.size() - 4)), {"cam.txt", "ends where", "pose", "\"right\""}},
          {"a number too many",
           Replaced(good, "0 0 1 0\n", "0 0 1 0 0\n"),
           {"cam.txt: line 10", "name of a camera", "12 of [R | T]"}},
          {"numbered cameras", Replaced(good, "left", "0"), {"cam.txt: line 2", "\"0\"", "format msr"}},
          {"a camera twice",
           Replaced(good, "right", "left"),
           {"cam.txt: line 12", "'left'", "at line 2", "move", "keep one"}},
          {"a folder in a name", Replaced(good, "left", "a/b"), {"cam.txt: line 2", "\"a/b\"", "without '/'"}},
          {"the folder above", Replaced(good, "left", ".."), {"cam.txt: line 2", "\"..\""}},
          {"Latin 1", Replaced(good, "left", "c\xe1mara"), {"cam.txt: line 2", "mara", "no UTF-8", "rename"}},
          {"a name too long", Replaced(good, "left", std::string(201, 'x')), {"cam.txt: line 2", "200 bytes"}},
          {"singular K", Replaced(good, "0 510", "0 0"), {"cam.txt: line 2", "'left'", "focal lengths are 500 and 0"}},
          {"K of another kind", Replaced(good, "0 510", "3 510"), {"cam.txt: line 2", "'left'", "upper triangular"}},
          {"no rotation", Replaced(good, "0 1 0 0", "0 2 0 0"), {"cam.txt: line 2", "'left'", "R is not a rotation"}},
          {"a mirror", Replaced(good, "0 1 0 0", "0 -1 0 0"), {"cam.txt: line 2", "'left'", "R mirrors"}},
      });
  std::string many;
  for (int i = 0; i < 1025; ++i) many += "c" + std::to_string(i) + " 1 0 0 0 1 0 0 0 1 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n";
  CheckRows(parse, {{"too many", many, {"cam.txt: line 1025", "1024"}}});
}

TEST(BadCalibrations, Msr) {
  const auto parse = [](const std::string& text) { return ParseMsrCameras(text, "params.txt", {640, 480}).status(); };
  CheckRows(parse,
            {
                {"empty", "", {"params.txt", "is empty"}},
                {"a name", "left" + std::string(samples::kMsr), {"params.txt: line 1", "\"left0\"", "number"}},
                {"twice", Replaced(samples::kMsr, "\n1\r", "\n0\r"), {"params.txt: line 10", "'cam0'", "line 1"}},
                {"distortion", Replaced(samples::kMsr, "\n0 0\r", "\n0 0.5\r"), {"params.txt: line 5", "cam0"}},
                {"cut short", std::string(samples::kMsr.substr(0, 60)), {"params.txt", "ends", "\"cam0\""}},
            });
}

TEST(BadCalibrations, Middlebury) {
  const auto parse = [](const std::string& text) {
    return ParseMiddleburyCameras(text, "a_par.txt", {640, 480}).status();
  };
  const std::string_view good = samples::kMiddlebury;
  CheckRows(parse,
            {
                {"empty", "", {"a_par.txt", "is empty"}},
                {"no number", std::string(good.substr(2)), {"a_par.txt: line 1", "\"left.png\"", "number of cameras"}},
                {"a claim", Replaced(good, "2\n", "47\n"), {"a_par.txt: line 1 says 47", "2 follow"}},
                {"none", "0\n", {"a_par.txt", "no camera"}},
                {"a number too many", Replaced(good, " 0 0 0\nr", " 0 0 0 1\nr"), {"line 2", "goes on", "left.png"}},
                {"a number too few", Replaced(good, "-1 0 -2", "-1 0"), {"a_par.txt", "ends", "t of picture"}},
                {"no rotation", Replaced(good, "0.8 -1", "0.9 -1"), {"line 3", "'right'", "not a rotation"}},
            });
}

TEST(BadCalibrations, Llff) {
  const std::vector<double>& good = samples::LlffNumbers();
  const auto edited = [&](std::size_t place, double number) {
    std::vector<double> numbers = good;
    numbers[place] = number;
    return samples::Npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 17), }", numbers);
  };
  const auto with = [&](const std::string& dictionary) { return samples::Npy(dictionary, good); };
  const auto parse = [](const std::string& bytes) { return ParseLlffCameras(bytes, "p.npy", {}).status(); };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CheckRows(parse,
            {
                {"empty", "", {"p.npy", "no NumPy file"}},
                {"text", "left 1 2 3 4 5 6", {"p.npy", "no NumPy file"}},
                {"cut short", samples::Llff().substr(0, 300), {"p.npy", "bytes of numbers", "(2, 17)"}},
                {"in the header", samples::Llff().substr(0, 30), {"p.npy", "header"}},
                {"single precision",
                 with("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 17), }"),
                 {"p.npy", "\"<f4\"", "float64"}},
                {"objects", with("{'descr': '|O', 'fortran_order': False, 'shape': (2, 17), }"), {"p.npy", "|O"}},
                {"huge shape",
                 with("{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904, 17), }"),
                 {"p.npy", "bytes of numbers"}},
                {"columns",
                 with("{'descr': '<f8', 'fortran_order': False, 'shape': (17, 2), }"),
                 {"p.npy", "2 columns", "17"}},
                {"one dimension",
                 with("{'descr': '<f8', 'fortran_order': False, 'shape': (34,), }"),
                 {"p.npy", "(34)", "rows and columns"}},
                {"a dictionary of another kind", with("{'descr': '<f8', 'x': 1}"), {"p.npy", "header"}},
                {"a version", Replaced(samples::Llff(), "NUMPY\x01", "NUMPY\x09"), {"p.npy", "version 9"}},
                {"NaN in the pose", edited(1, nan), {"p.npy: row 0", "'000'", "not a finite number"}},
                {"a size", edited(4, 480.5), {"p.npy: row 0", "480.5", "whole numbers"}},
                {"a huge size", edited(4, 1e300), {"p.npy: row 0", "whole numbers"}},
                {"no focal length", edited(17 + 14, 0), {"p.npy: row 1", "'001'", "focal lengths are 0"}},
                {"a range", edited(15, 99), {"p.npy: row 0", "'000'", "0 < near < far"}},
            });
  const Status status = ParseLlffCameras(samples::Llff(), "p.npy", {"a.png"}).status();
  EXPECT_THAT(status.message(), HasSubstr("p.npy: has 2 rows, and there are 1 pictures"));
}

TEST(BadCalibrations, Miv) {
  const auto parse = [](const std::string& text) { return ParseMivCameras(text, "miv.json").status(); };
  const std::string_view good = samples::kMiv;
  CheckRows(
      parse,
      {
          {"empty", "", {"miv.json", "is empty"}},
          {"a list", "[]", {"miv.json", "expected an object"}},
          {"no cameras", "{}", {"miv.json", "'cameras' is missing"}},
          {"none", "{\"cameras\": []}", {"miv.json", "no camera"}},
          {"cut short", std::string(good.substr(0, 300)), {"miv.json", "not valid JSON"}},
          {"a sphere",
           Replaced(good, "Perspective", "Equirectangular"),
           {"miv.json: cameras[0]", "\"v0\"", "Projection", "not supported"}},
          {"a key twice", Replaced(good, "\"Fps\"", "\"Version\""), {"miv.json", "given twice"}},
          {"no position",
           Replaced(good, "Position", "Pos"),
           {"miv.json: cameras[0]", "\"v0\"", "'Position' is missing"}},
          {"a rotation", Replaced(good, "[90, 0, 0]", "[90, 0]"), {"miv.json: cameras[1]", "\"v1\"", "'Rotation'"}},
          {"a range", Replaced(good, "[2, 9.5]", "[9.5, 2]"), {"miv.json: cameras[0]", "'v0'", "0 < near < far"}},
          {"no focal length",
           Replaced(good, "[500, 510]", "[0, 510]"),
           {"miv.json: cameras[0]", "'v0'", "focal lengths are 0"}},
          {"no principal point",
           Replaced(good, "Principle_point", "Centre"),
           {"\"v0\"", "'Principle_point' is missing"}},
          {"half a pixel",
           Replaced(good, "[640, 480]", "[640.5, 480]"),
           {"miv.json: cameras[0]", "whole numbers of pixels"}},
          {"a name twice", Replaced(good, "\"v1\"", "\"v0\""), {"miv.json: cameras[1]", "'v0'", "cameras[0]"}},
          {"a name with control characters",
           Replaced(good, "\"v1\"", "\"v\\n1\""),
           {"miv.json: cameras[1]", "control characters"}},
          {"a rate", Replaced(good, "\"Fps\": 30", "\"Fps\": 0"), {"miv.json", "'Fps' is 0"}},
      });
}

Status ParseText(const std::string& cameras, const std::string& images, const std::string& points) {
  return ParseColmapModel({.binary = false,
                           .cameras = {"m/cameras.txt", cameras},
                           .images = {"m/images.txt", images},
                           .points = ColmapFile{"m/points3D.txt", points}})
      .status();
}

TEST(BadCalibrations, ColmapText) {
  const std::string_view cameras = samples::kColmapCameras;
  const std::string_view images = samples::kColmapImages;
  CheckRows(
      [&](const std::string& text) { return ParseText(text, std::string(images), "1 0 0 5 0 0 0 1\n"); },
      {
          {"empty", "", {"m/cameras.txt", "is empty"}},
          {"distortion",
           Replaced(cameras, "0 0 0 0\n", "0 0.01 0 0\n"),
           {"m/cameras.txt: camera 7", "rig/right.jpg", "OPENCV", "image_undistorter"}},
          {"fisheye",
           Replaced(cameras, "OPENCV", "OPENCV_FISHEYE"),
           {"camera 7", "OPENCV_FISHEYE", "image_undistorter"}},
          {"unknown lens",
           Replaced(cameras, "OPENCV", "MIRROR_BALL"),
           {"m/cameras.txt: line 3", "\"MIRROR_BALL\"", "image_undistorter"}},
          {"parameters too few",
           Replaced(cameras, "320 240\n", "320\n"),
           {"m/cameras.txt: line 2", "camera 1 has 2 parameters", "3 of SIMPLE_PINHOLE"}},
          {"parameters too many",
           Replaced(cameras, "320 240\n", "320 240 0\n"),
           {"m/cameras.txt: line 2", "camera 1 has 4 parameters", "3 of SIMPLE_PINHOLE"}},
          {"a camera twice", Replaced(cameras, "\n7 ", "\n1 "), {"m/cameras.txt: line 3", "camera 1 is there twice"}},
          {"a camera that is missing",
           Replaced(cameras, "\n7 ", "\n8 "),
           {"m/images.txt: line 2", "rig/right.jpg", "camera 7", "m/cameras.txt", "one model"}},
          {"no focal length",
           Replaced(cameras, "500 510", "500 0"),
           {"m/images.txt: line 2", "'rig_right'", "focal lengths"}},
          {"a huge size",
           Replaced(cameras, "640 480 500 510", "640 18446744073709551615 500 510"),
           {"'rig_right'", "size is 640x1000000"}},
      });
  CheckRows(
      [&](const std::string& text) { return ParseText(std::string(cameras), text, "1 0 0 5 0 0 0 1\n"); },
      {
          {"none", "# nothing\n", {"m/images.txt", "no camera"}},
          {"no rotation",
           Replaced(images, "2 1 0 0 0", "2 0.5 0 0 0"),
           {"m/images.txt: line 4", "rig/left.jpg", "quaternion"}},
          {"twice", Replaced(images, "rig/left", "rig/right"), {"m/images.txt: line 4", "'rig_right.jpg'", "already"}},
          {"an id twice", Replaced(images, "\n2 1", "\n4 1"), {"m/images.txt", "image 4 is there twice"}},
          {"no name",
           Replaced(images, " rig/left.jpg", ""),
           {"m/images.txt: line 4", "expected at least one character"}},
          {"an id", Replaced(images, "\n2 1", "\n-2 1"), {"m/images.txt: line 4", "\"-2\"", "id of an image"}},
      });
  CheckRows([&](const std::string& text) { return ParseText(std::string(cameras), std::string(images), text); },
            {
                {"coordinates", "1 0 zero 5 0 0 0 1\n", {"m/points3D.txt: line 1", "\"zero\""}},
                {"half a track", "1 0 0 5 0 0 0 1 2\n", {"m/points3D.txt", "where an image sees"}},
            });
}

TEST(BadCalibrations, ColmapBinary) {
  const std::string cameras = samples::ColmapCamerasBinary();
  const std::string images = samples::ColmapImagesBinary();
  const std::string points = samples::ColmapPointsBinary();
  const auto parse = [](const std::string& c, const std::string& i, const std::string& p) {
    return ParseColmapModel({.binary = true,
                             .cameras = {"cameras.bin", c},
                             .images = {"images.bin", i},
                             .points = ColmapFile{"points3D.bin", p}})
        .status();
  };
  // The same file with another number at its beginning.
  const auto claiming = [](std::uint64_t count, const std::string& file) {
    std::string bytes;
    AppendU64(count, bytes);
    return bytes + file.substr(sizeof(std::uint64_t));
  };
  const std::uint64_t huge = 1'000'000'000'000'000'000;
  std::string lens = cameras;
  lens[12] = 99;
  CheckRows([&](const std::string& bytes) { return parse(bytes, images, points); },
            {
                {"empty", "", {"cameras.bin: byte 0", "whole"}},
                {"claims", claiming(huge, cameras), {"cameras.bin", "claims 1000000000000000000 cameras", "at most"}},
                {"cut short", cameras.substr(0, cameras.size() - 1), {"cameras.bin", "ends amid camera 7"}},
                {"goes on", cameras + "x", {"cameras.bin", "goes on", "1 bytes"}},
                {"a lens", lens, {"cameras.bin: byte 16", "model number 99", "image_undistorter"}},
            });
  std::string nan = images;
  nan.replace(12, 8, 8, '\xff');
  CheckRows([&](const std::string& bytes) { return parse(cameras, bytes, points); },
            {
                {"claims", claiming(huge, images), {"images.bin", "claims 1000000000000000000 images"}},
                {"NaN", nan, {"images.bin", "image 4", "not finite"}},
                {"no end of a name", claiming(1, images.substr(0, 82)), {"images.bin", "name of image 4"}},
                {"cut short", images.substr(0, images.size() - 9), {"images.bin", "ends amid the name of image 2"}},
            });
  CheckRows([&](const std::string& bytes) { return parse(cameras, images, bytes); },
            {
                {"claims", claiming(huge, points), {"points3D.bin", "claims 1000000000000000000 points"}},
                {"a track that claims",
                 points.substr(0, 51) + std::string(8, '\x7f') + points.substr(59),
                 {"points3D.bin", "images that see a point"}},
                {"cut short", points.substr(0, points.size() - 1), {"points3D.bin", "images that see a point"}},
            });
}

}  // namespace
}  // namespace depthfarm
