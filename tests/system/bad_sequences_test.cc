// Sequence files and pictures that are wrong: exit code 2 and words that name file, camera, frame and what to do.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/system/bad_input.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// The sequence file with one camera's key set.
BadRow WithCameraKey(const std::string& name, const std::string& key, const json& value, const Words& says) {
  const auto arrange = [key, value](const BadCase& bad) {
    bad.EditSequence([&](json& sequence) { sequence["cameras"][1][key] = value; });
  };
  return {.name = name, .arrange = arrange, .command = RunWith(), .says = says};
}

BadRow WithKey(const std::string& name, const std::string& key, const json& value, const Words& says) {
  const auto arrange = [key, value](const BadCase& bad) {
    bad.EditSequence([&](json& sequence) { sequence[key] = value; });
  };
  return {.name = name, .arrange = arrange, .command = RunWith(), .says = says};
}

BadRow WithEdit(const std::string& name, const BadCase::Edit& edit, const Words& says, const Words& options = {}) {
  const auto arrange = [edit](const BadCase& bad) { bad.EditSequence(edit); };
  return {.name = name, .arrange = arrange, .command = RunWith(options), .says = says};
}

BadRow WithText(const std::string& name, const std::string& text, const Words& says) {
  const auto arrange = [text](const BadCase& bad) { bad.Write(bad.scene() / "sequence.json", text); };
  return {.name = name, .arrange = arrange, .command = RunWith(), .says = says};
}

BadRow WithReplaced(const std::string& name, const std::string& from, const std::string& to, const Words& says) {
  const auto arrange = [from, to](const BadCase& bad) { bad.ReplaceInSequence(from, to); };
  return {.name = name, .arrange = arrange, .command = RunWith(), .says = says};
}

TEST(BadInput, SequenceFilesThatCannotBeRead) {
  CheckRows({
      {.name = "missing",
       .command = {"run", "{folder}/none.json", "-o", "{out}"},
       .says = {"none.json", "No such file"}},
      {.name = "a folder", .command = {"run", "{scene}", "-o", "{out}"}, .says = {"{scene}", "not a regular file"}},
      {.name = "no name", .command = {"run", "", "-o", "{out}"}, .says = {"sequence file ''", "path of a JSON file"}},
      {.name = "a name that is not UTF-8",
       .command = {"run", "{folder}/\xff\xfe.json", "-o", "{out}"},
       .says = {"sequence file", "No such file"}},
      WithText("empty", "", {"{sequence}: is empty, expected JSON"}),
      WithText("zero bytes", std::string(64, '\0'), {"{sequence}", "not valid JSON", "line 1, column 1"}),
      WithText("cut short", R"({"cameras": [{"name": "a")", {"{sequence}", "not valid JSON", "unexpected end"}),
      WithText("not an object", "[]", {"{sequence}", "expected an object"}),
      WithText("nested too deep", std::string(1000, '['), {"{sequence}", "deeper than 64"}),
      WithText("not UTF-8", "{\"name\": \"\xff\"}", {"{sequence}", "ill-formed UTF-8"}),
      WithReplaced("an unknown key", "\"zFar\"", "\"zfar\"", {"{sequence}", "unknown key \"zfar\"", "zFar"}),
      WithReplaced("a key given twice", "\"zFar\"", "\"zFar\":1,\"zFar\"", {"{sequence}: key \"zFar\" is given twice"}),
      WithReplaced("a camera's key given twice", "\"height\"", "\"height\":1,\"height\"",
                   {"{sequence}: cameras[0]: key \"height\" is given twice"}),
      WithReplaced("NaN in K", "\"K\":[[64.0", "\"K\":[[NaN", {"{sequence}", "not valid JSON", "\"K\":[[N"}),
      WithReplaced("a number past double", "\"K\":[[64.0", "\"K\":[[1e999", {"{sequence}", "1e999"}),
  });
}

TEST(BadInput, Cameras) {
  const json mirrored = {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CheckRows({
      WithCameraKey("singular K", "K", {{0, 0, 31.5}, {0, 64, 23.5}, {0, 0, 1}}, {"{sequence}", "'cam1'", "focal"}),
      WithCameraKey("K with a lower part", "K", {{64, 0, 31.5}, {3, 64, 23.5}, {0, 0, 1}},
                    {"{sequence}", "'cam1'", "upper triangular"}),
      WithCameraKey("K of two rows", "K", {{64, 0, 31.5}, {0, 64, 23.5}}, {"cam1", "'K'", "3 rows"}),
      WithCameraKey("R that scales", "R", {{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {"'cam1'", "not a rotation"}),
      WithCameraKey("R that mirrors", "R", mirrored, {"'cam1'", "mirrors", "convention"}),
      WithCameraKey("t that is text", "t", "0, 0, 0", {"cam1", "'t'", "3 finite numbers"}),
      WithCameraKey("a name of another camera", "name", "cam0", {"cameras[1]", "'cam0'", "earlier camera"}),
      WithCameraKey("a name with /", "name", "a/b", {"cameras[1]", "a/b", "without '/'"}),
      WithCameraKey("a name with ..", "name", "..", {"cameras[1]", "\"..\"", "without '/' and '..'"}),
      WithCameraKey("a name with a line end", "name", "a\nb", {"cameras[1]", "control characters"}),
      WithCameraKey("a name that no file can have", "name", std::string(300, 'a'), {"cameras[1]", "at most 200 bytes"}),
      WithCameraKey("width 0", "width", 0, {"cam1", "'width' is 0", "1 to 32768"}),
      WithCameraKey("a width of pixels and a half", "width", 64.5, {"cam1", "'width' is 64.5", "whole number"}),
      WithCameraKey("an unknown key", "distortion", {0.1, 0.2}, {"cam1", "unknown key \"distortion\""}),
      WithCameraKey("zNear beyond zFar", "zNear", 99, {"cam1", "zNear is 99", "zNear < zFar"}),
      WithKey("zNear beyond zFar", "zNear", 99, {"{sequence}", "zNear is 99", "zNear < zFar"}),
      WithKey("negative zNear", "zNear", -1, {"{sequence}", "'zNear' is -1", "> 0"}),
      WithKey("an unknown reference", "reference", "nobody", {"{sequence}", "'nobody'", "name of a camera"}),
      WithKey("another convention", "convention", "opengl", {"{sequence}", "opengl", "convert the cameras"}),
      WithKey("no cameras", "cameras", json::array(), {"{sequence}", "'cameras' is empty"}),
      WithEdit("one view",
               [](json& s) {
                 s["cameras"].erase(1);
                 s["cameras"].erase(1);
                 s.erase("groundTruth");
               },
               {"{sequence}", "at least two views", "there are 1"}),
      WithEdit("no depth range", [](json& s) { s.erase("zNear"); }, {"{sequence}", "--z-near"}),
      WithEdit("no overlap",
               [](json& s) {
                 s["cameras"][2]["t"] = {1000, 0, 0};
               },
               {"{sequence}", "'cam2' has no neighbour", "--views"}),
      WithEdit("all at one place",
               [](json& s) {
                 for (json& camera : s["cameras"])
                   camera["t"] = {0, 0, 0}, camera["R"] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
               },
               {"{sequence}", "from another place"}),
      WithEdit("a camera that faces away",
               [](json& s) {
                 for (int i : {0, 2})
                   for (json& x : s["cameras"][2]["R"][i]) x = -x.get<double>();
               },
               {"{sequence}", "'cam2'", "faces away", "the reference is 'cam0'"}),
      WithEdit("pictures of one pixel",
               [](json& s) {
                 for (json& camera : s["cameras"]) camera["width"] = camera["height"] = 1;
               },
               {"{sequence}", "camera 'cam0' is 1x1", "--refine 0"}),
  });
}

// Files that are looked at before anything is started.
TEST(BadInput, PicturesThatAreNotThere) {
  const json outside = {"../a.png", "../b.png"};
  const json absolute = {"/a.png", "/b.png"};
  CheckRows({
      WithCameraKey("outside the folder", "images", outside, {"cam1", "frame 0", "../a.png", "--allow-outside"}),
      WithCameraKey("an absolute path", "images", absolute, {"cam1", "frame 0", "/a.png", "--allow-outside"}),
      WithCameraKey("a folder by its name", "images", {"cam1/", "cam1/"}, {"cam1", "frame 0", "not a folder"}),
      WithCameraKey("a folder", "images", {"cam1", "cam1"},
                    {"camera 'cam1', frame 0", "{scene}/cam1", "not a regular"}),
      WithCameraKey("one too few", "images", {"cam1/0000.png"}, {"'cam1' has 1 images", "'cam0' has 2"}),
      WithCameraKey("missing", "images", {"cam1/0000.png", "cam1/none.png"},
                    {"camera 'cam1', frame 1", "{scene}/cam1/none.png", "No such file"}),
      WithCameraKey("a control character", "images", {"cam1/0000.png", "a\tb"}, {"cam1", "frame 1", "control"}),
      WithCameraKey("an unknown format", "format", "nv12", {"cam1", "'format' is \"nv12\"", "yuv420p8"}),
      WithCameraKey("a range of image files", "range", "full", {"cam1", "'range'", "raw pictures"}),
      WithCameraKey("a video and pictures", "video", {{"path", "a.mp4"}, {"frames", 2}}, {"cam1", "either a video"}),
      WithEdit("a video that is missing",
               [](json& s) {
                 s["cameras"][1].erase("images");
                 s["cameras"][1]["video"] = {{"path", "a.mp4"}, {"frames", 2}};
               },
               {"camera 'cam1', frame 0", "video {scene}/a.mp4", "No such file"}),
      WithEdit("a raw video that is too short",
               [](json& s) {
                 s["cameras"][1].erase("images");
                 s["cameras"][1]["video"] = {{"path", "cam1/0000.png"}, {"frames", 2}, {"format", "yuv444p16le"}};
               },
               {"camera 'cam1', frame 0", "cam1/0000.png holds 0 pictures of 64x48 yuv444p16le"}),
      WithCameraKey("a mask too few", "masks", {"m.png"}, {"'cam1'", "'masks' has 1 entries", "one per frame, 2"}),
      {.name = "no bytes",
       .arrange = [](const BadCase& bad) { bad.Write(bad.scene() / "cam2" / "0001.png", ""); },
       .command = RunWith(),
       .says = {"camera 'cam2', frame 1", "{scene}/cam2/0001.png", "is empty"}},
      {.name = "a link to itself",
       .arrange =
           [](const BadCase& bad) {
             fs::remove(bad.scene() / "cam2" / "0001.png");
             fs::create_symlink("0001.png", bad.scene() / "cam2" / "0001.png");
           },
       .command = RunWith(),
       .says = {"camera 'cam2', frame 1", "symbolic links"}},
      WithEdit("a mask that is missing",
               [](json& s) {
                 s["cameras"][0]["masks"] = {"m0.png", "m1.png"};
               },
               {"camera 'cam0', frame 0", "mask {scene}/m0.png", "No such file"}, {"--mask", "sequence"}),
  });
}

// What only decoding shows: the job fails at once, with the frames that were done before.
TEST(BadInput, PicturesThatCannotBeDecoded) {
  const Words small = {"--levels", "24", "--segments", "100"};
  const auto row = [&](const std::string& name, const std::function<void(const fs::path&)>& damage, const Words& says) {
    return BadRow{.name = name,
                  .arrange = [damage](const BadCase& bad) { damage(bad.scene() / "cam1" / "0001.png"); },
                  .command = RunWith(small),
                  .says = Words{"camera 'cam1', frame 1", "{scene}/cam1/0001.png"} + says,
                  .leaves = Leaves::kWholeFrames};
  };
  CheckRows({
      row("cut short", [](const fs::path& file) { fs::resize_file(file, fs::file_size(file) / 2); }, {"cut short"}),
      row("zero bytes", [](const fs::path& file) { fs::resize_file(file, 0), fs::resize_file(file, 1000); },
          {"cannot be decoded"}),
      row("of another size",
          [](const fs::path& file) {
            std::ofstream(file, std::ios::trunc) << "P5 96 64 255\n" << std::string(std::size_t{96} * 64, 'x');
          },
          {"has 96x64 pixels, expected 64x48", "the camera's size"}),
      {.name = "PNG as YUV",
       .arrange =
           [](const BadCase& bad) {
             bad.EditSequence([](json& s) {
               for (json& camera : s["cameras"]) camera["format"] = "yuv420p8";
             });
           },
       .command = RunWith(small),
       .says = {"camera 'cam", "frame ", "expected 4608 for one picture of 64x48 yuv420p8"},
       .leaves = Leaves::kWholeFrames},
      {.name = "a prior that is cut short",
       .arrange =
           [](const BadCase& bad) {
             bad.Write(bad.path() / "prior" / "prior.json", R"({"holds": "depth"})");
             bad.Write(bad.path() / "prior" / "depth" / "cam0" / "0000.pfm", "Pf\n3 3\n-1\n");
           },
       .command = RunWith(small + Words{"--prior", "{folder}/prior"}),
       .says = {"camera 'cam0', frame 0", "{folder}/prior/depth/cam0/0000.pfm", "expected 36 for 3x3"},
       .leaves = Leaves::kWholeFrames},
  });
}

}  // namespace
}  // namespace depthfarm::system_test
