// What `depthfarm import` is asked for and cannot do: file, camera and remedy are said, and nothing is written.
#include <gtest/gtest.h>

#include "tests/support/calibration_samples.h"
#include "tests/system/bad_input.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;

// Each sample as a file, and a colmap model.
void WriteSamples(const BadCase& bad) {
  const fs::path& folder = bad.path();
  bad.Write(folder / "ftv.txt", std::string(samples::kFtv));
  bad.Write(folder / "msr.txt", std::string(samples::kMsr));
  bad.Write(folder / "a_par.txt", std::string(samples::kMiddlebury));
  bad.Write(folder / "miv.json", std::string(samples::kMiv));
  bad.Write(folder / "p.npy", samples::Llff());
  bad.Write(folder / "sparse" / "cameras.txt", std::string(samples::kColmapCameras));
  bad.Write(folder / "sparse" / "images.txt", std::string(samples::kColmapImages));
  bad.Write(folder / "sparse" / "points3D.txt", samples::ColmapPoints());
}

Words ImportOf(const std::string& format, const std::string& calibration, const Words& options) {
  return Words{"import", format, "{folder}/" + calibration, "-o", "{out}"} + options;
}
Words Ftv(const Words& options) { return ImportOf("ftv", "ftv.txt", options); }

const Words kSize = {"--size", "640x480"};
const Words kRange = {"--z-near", "4", "--z-far", "20"};

BadRow Row(const std::string& name, const Words& command, const Words& says) {
  return {.name = name, .arrange = WriteSamples, .command = command, .says = says};
}

TEST(BadInput, ImportsThatWereMeantOtherwise) {
  CheckRows({
      Row("a format", ImportOf("nerf", "ftv.txt", {}), {"no format 'nerf'", "ftv, msr, colmap, miv, llff, middlebury"}),
      Row("no file", ImportOf("ftv", "none.txt", kSize), {"{folder}/none.txt", "No such file"}),
      Row("a folder", ImportOf("ftv", "sparse", kSize), {"{folder}/sparse", "not a regular file"}),
      Row("no size", Ftv(kRange), {"{folder}/ftv.txt", "--size WIDTHxHEIGHT"}),
      Row("a size", Ftv(Words{"--size", "640"} + kRange), {"--size is '640'", "1024x768"}),
      Row("no range", Ftv(kSize), {"{folder}/ftv.txt", "--z-near and --z-far"}),
      Row("half a range", Ftv(kSize + Words{"--z-far", "20"}), {"{folder}/ftv.txt", "give --z-near,"}),
      Row("a range below 0", Ftv(kSize + Words{"--z-near", "-4", "--z-far", "-20"}),
          {"--z-near is -4", "--z-axis backward"}),
      Row("a range the wrong way", Ftv(kSize + Words{"--z-near", "20", "--z-far", "4"}), {"z-near < z-far"}),
      Row("a range that is none", Ftv(kSize + Words{"--z-near", "nan", "--z-far", "4"}), {"--z-near is nan"}),
      Row("a unit", Ftv(kSize + Words{"--z-near", "0.0004", "--z-far", "0.002"}),
          {"{folder}/ftv.txt", "no two cameras", "unit of length", "--pose"}),
      Row("a pose", Ftv(kSize + kRange + Words{"--pose", "inverse"}), {"--pose", "centre"}),
      Row("a pose of another format", ImportOf("msr", "msr.txt", kSize + kRange + Words{"--pose", "centre"}),
          {"--pose", "format ftv"}),
      Row("a camera", Ftv(kSize + kRange + Words{"--cameras", "left,middle"}),
          {"--cameras", "'middle'", "'left' to 'right'"}),
      Row("a camera twice", Ftv(kSize + kRange + Words{"--cameras", "left,left"}), {"'left' twice"}),
      Row("a reference", Ftv(kSize + kRange + Words{"--reference", "middle"}), {"--reference is 'middle'"}),
      Row("a name", Ftv(kSize + kRange + Words{"--name", std::string(300, 'x')}), {"'name'", "200 bytes"}),
      Row("colmap: no folder", ImportOf("colmap", "ftv.txt", {}), {"{folder}/ftv.txt", "no folder", "sparse/0"}),
      Row("colmap: no model", ImportOf("colmap", "scene", {}), {"{folder}/scene", "images.bin", "images.txt"}),
      Row("colmap: half a range",
          {"import", "colmap", "{folder}/sparse", "-o", "{out}", "--cameras", "rig_left", "--z-near", "99"},
          {"99", "give both --z-near and --z-far"}),
      Row("llff: no pictures", ImportOf("llff", "p.npy", {"--images", "{folder}/sparse"}),
          {"{folder}/sparse", "no pictures"}),
      Row("llff: another shape", ImportOf("llff", "p.npy", {"--size", "640x360"}),
          {"--size", "'000'", "640x480", "another shape"}),
      Row("the calibration as output", {"import", "miv", "{folder}/miv.json", "-o", "{folder}/miv.json"},
          {"{folder}/miv.json", "which is the calibration"}),
      Row("no output", {"import", "miv", "{folder}/miv.json", "-o", ""}, {"-o is ''"}),
      Row("a folder as output", {"import", "miv", "{folder}/miv.json", "-o", "{folder}"},
          {"{folder}", "path of a sequence file"}),
      Row("below a file", {"import", "miv", "{folder}/miv.json", "-o", "{folder}/ftv.txt/a.json"},
          {"{folder}/ftv.txt", "is a file"}),
  });
}

TEST(BadInput, ImportsOfPicturesThatAreNotThere) {
  const auto images = [](const std::string& pattern, const Words& options) {
    return Ftv(kSize + kRange + Words{"--images", pattern} + options);
  };
  const auto pictures = [](const BadCase& bad) {
    WriteSamples(bad);
    bad.Write(bad.path() / "left.png", "picture");
    bad.Write(bad.path() / "right.png", "");
    bad.Write(bad.path() / "left.yuv", std::string(2 * 640 * 480 * 3 / 2, 'x'));
    bad.Write(bad.path() / "as" / "left" / "file", "x");
    bad.Write(bad.path() / "inside" / "left.png", "picture");
    bad.Write(bad.path() / "inside" / "right.png", "picture");
  };
  std::vector<BadRow> rows = {
      Row("a folder", images("{folder}", {}), {"--images is '{folder}'", "names no pictures"}),
      Row("a field", images("{folder}/{view}.png", {}), {"there is no {view}"}),
      Row("all the same", images("{folder}/{frame}.png", {"--frames", "0:2"}), {"same for all cameras", "{camera}"}),
      Row("no frames", images("{folder}/{camera}{frame}.png", {}), {"--frames A:B"}),
      Row("frames", images("{folder}/{camera}{frame}.png", {"--frames", "2:2"}), {"--frames is '2:2'", "A < B"}),
      Row("frames of none", images("{folder}/{camera}.png", {"--frames", "0:2"}), {"--frames needs {frame}"}),
      Row("frames without pictures", Ftv(kSize + kRange + Words{"--frames", "0:2"}), {"give --images or --videos too"}),
      Row("a pixel format", images("{folder}/{camera}.yuv", {"--pixel-format", "nv12"}),
          {"--pixel-format is 'nv12'", "yuv420p8"}),
      Row("a range of no raw picture", images("{folder}/{camera}.png", {"--range", "full"}), {"--pixel-format"}),
      Row("none is there", images("{folder}/none/{camera}.png", {}),
          {"camera 'left'", "{folder}/none/left.png", "--allow-missing"}),
      Row("none at all", images("{folder}/none/{camera}.png", {"--allow-missing"}),
          {"no camera has pictures", "{folder}/none/left.png"}),
      Row("one is empty", images("{folder}/{camera}.png", {}), {"camera 'right'", "{folder}/right.png", "is empty"}),
      Row("a folder for a picture", images("{folder}/as/{camera}", {}),
          {"camera 'left'", "{folder}/as/left", "is no file"}),
      Row("several frames in a file",
          images("{folder}/{camera}.yuv", {"--pixel-format", "yuv420p8", "--allow-missing"}),
          {"camera 'left'", "{folder}/left.yuv", "921600 bytes, expected 460800", "2 frames", "--videos"}),
      Row("outside",
          {"import", "ftv", "{folder}/ftv.txt", "-o", "{out}/deep/s.json", "--size", "640x480", "--z-near", "4",
           "--z-far", "20", "--images", "{folder}/inside/{camera}.png"},
          {"camera 'left'", "{folder}/inside/left.png", "not below {out}/deep", "--allow-outside"}),
      Row("a picture as output",
          Words{"import", "ftv", "{folder}/ftv.txt", "-o", "{folder}/inside/left.png", "--images",
                "{folder}/inside/{camera}.png"} +
              kSize + kRange,
          {"camera 'left'", "{folder}/inside/left.png", "would be replaced", "-o"}),
      Row("colmap: a picture", ImportOf("colmap", "sparse", {"--images", "{folder}"}),
          {"camera 'rig_left'", "{folder}/rig/left.jpg"}),
      Row("middlebury: frames",
          ImportOf("middlebury", "a_par.txt", kSize + kRange + Words{"--images", "{folder}", "--frames", "0:1"}),
          {"--frames", "only frame"}),
  };
  for (BadRow& row : rows) row.arrange = pictures;
  CheckRows(rows);
}

}  // namespace
}  // namespace depthfarm::system_test
