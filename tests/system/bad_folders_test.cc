// Output folders that cannot be written, and folders of depth that are not what they should be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/system/bad_input.h"
#include "tests/system/small_disk.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

void FileAtOut(const BadCase& bad) { bad.Write(bad.out(), "precious"); }
void ForeignDepthAtOut(const BadCase& bad) { bad.Write(bad.out() / "depth" / "precious", "x"); }

TEST(BadInput, OutputsThatAreInTheWay) {
  const Words nobody = {"--coordinator", "ipc://{folder}/nobody", "--timeout", "1"};
  const auto row = [](const std::string& name, void (*arrange)(const BadCase&), const Words& command,
                      const Words& says) {
    return BadRow{.name = name, .arrange = arrange, .command = command, .says = says, .leaves = Leaves::kWhatWasThere};
  };
  CheckRows(
      {
          row("run into a file", FileAtOut, RunWith(), {"output folder {out} is a file"}),
          row("run below a file", FileAtOut, {"run", "{sequence}", "-o", "{out}/a/b"},
              {"output folder {out}/a/b: {out} is a file", "choose another folder"}),
          row("run into another's depth", ForeignDepthAtOut, RunWith(), {"{out}", "no job of depthfarm made"}),
          row("run nowhere", nullptr, {"run", "{sequence}", "-o", ""}, {"output folder ''"}),
          row("run into the root", nullptr, {"run", "{sequence}", "-o", "/"}, {"'/'", "below the root"}),
          row("fetch into a file", FileAtOut, Words{"fetch", "1", "-o", "{out}"} + nobody, {"{out} is a file"}),
          row("colour into a file", FileAtOut, {"colour", "{depth}", "-o", "{out}"}, {"{out} is a file"}),
          row("scene into a file", FileAtOut, {"scene", "arc", "-o", "{out}"}, {"{out} is a file"}),
          row("keys into a file", FileAtOut, {"keygen", "-o", "{out}"}, {"{out} is a file"}),
          row("views into a file", FileAtOut, {"synthesize", "{sequence}", "{depth}", "-o", "{out}", "--view", "cam1"},
              {"{out} is a file"}),
          row("views into a picture", nullptr,
              {"synthesize", "{sequence}", "{depth}", "-o", "{out}.png", "--view", "cam1"}, {"{out}.png", "FILE.mp4"}),
      },
      /*with_depth=*/true);
}

TEST(BadInput, AReadOnlyFileSystemIsToldBeforeAnythingIsComputed) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 1, .size = "64x48"});
  const SmallDisk disk(folder.path() / "disk", "1m");
  if (!disk.problem().empty()) GTEST_SKIP() << disk.problem();
  ASSERT_TRUE(disk.MakeReadOnly());
  const Outcome run = Depthfarm({"run", sequence, "-o", folder / "disk/out"});
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_THAT(run.output, HasSubstr("output folder " + (folder / "disk/out") + ": cannot write into " +
                                    (folder / "disk") + ": Read-only file system: choose another folder"));
  EXPECT_TRUE(fs::is_empty(folder / "disk"));
}

TEST(BadInput, AFullDiskFailsTheJobWithWholeFramesAndItsName) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 3, .size = "160x120"});
  const SmallDisk disk(folder.path() / "disk", "96k");
  if (!disk.problem().empty()) GTEST_SKIP() << disk.problem();
  const std::string out = folder / "disk/out";
  // Some room is left when the job begins, none before it ends.
  std::ofstream(folder.path() / "disk" / "other") << std::string(24 << 10, 'x');
  const Outcome run = Depthfarm({"run", sequence, "-o", out, "--levels", "24", "--segments", "100", "--workers", "1"});
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(run.output, HasSubstr("No space left on device"));
  EXPECT_THAT(run.output, HasSubstr(out));
  EXPECT_THAT(Leftovers(out), IsEmpty());
  EXPECT_FALSE(fs::exists(fs::path(out) / "depth.json"));
}

BadRow Manifest(const std::string& name, const BadCase::Edit& edit, const Words& command, const Words& says) {
  return {.name = name + ": " + command[0],
          .arrange = [edit](const BadCase& bad) { bad.EditManifest(edit); },
          .command = command,
          .says = says};
}

TEST(BadInput, ManifestsOfDepth) {
  const Words verify = {"verify", "{depth}"};
  const Words evaluate = {"evaluate", "{sequence}", "{depth}"};
  const Words colour = {"colour", "{depth}", "-o", "{out}"};
  const Words views = {"synthesize", "{sequence}", "{depth}", "-o", "{out}", "--view", "cam1"};
  std::vector<BadRow> rows;
  // What is wrong with the file itself, every reader tells in the same words.
  for (const Words& command : {verify, evaluate, colour, views}) {
    rows.push_back(Manifest("no object", [](json& m) { m = json::array(); }, command,
                            {"{depth}/depth.json", "expected an object"}));
    rows.push_back(Manifest("a file elsewhere", [](json& m) { m["cameras"][1]["files"][0] = "../x.png"; }, command,
                            {"{depth}/depth.json", "'cam1'", "\"../x.png\"", "within the folder"}));
    rows.push_back(Manifest("another format", [](json& m) { m["format"] = "x"; }, command,
                            {"{depth}/depth.json", "'format' is \"x\"", "depthfarm-depth-1"}));
  }
  rows.push_back(Manifest("an unknown key", [](json& m) { m["foo"] = 1; }, verify, {"unknown key \"foo\""}));
  rows.push_back(Manifest("a camera twice", [](json& m) { m["cameras"].push_back(m["cameras"][0]); }, verify,
                          {"'cam0' is given twice"}));
  rows.push_back(Manifest("a digest", [](json& m) { m["cameras"][2]["sha256"][1] = "abc"; }, verify,
                          {"'cam2'", "sha256[1]", "64"}));
  rows.push_back(Manifest("a file too few", [](json& m) { m["cameras"][0]["files"].erase(0); }, verify,
                          {"cameras[0]", "'files' has 1 entries", "'sha256' 2"}));
  rows.push_back(
      Manifest("a range", [](json& m) { m["cameras"][0]["zNear"] = 99; }, verify, {"'cam0'", "zNear < zFar"}));
  const auto rename = [](json& m) {
    for (json& camera : m["cameras"]) camera["name"] = "x" + camera["name"].get<std::string>();
  };
  rows.push_back(Manifest("of other cameras", rename, evaluate, {"'xcam0'", "{sequence}"}));
  rows.push_back(Manifest("of other frames", [](json& m) { m["firstFrame"] = 77; }, evaluate, {"camera", "frame 77"}));
  CheckRows(rows, /*with_depth=*/true);
}

TEST(BadInput, DepthThatIsGoneOrDamaged) {
  const auto remove = [](const BadCase& bad) { fs::remove(bad.depth() / "depth/cam0/0001.png"); };
  const auto empty = [](const BadCase& bad) { bad.Write(bad.depth() / "depth/cam0/0001.png", ""); };
  const Words views = {"synthesize", "{sequence}", "{depth}", "-o", "{out}", "--view", "cam1"};
  CheckRows(
      {
          {.name = "no folder", .command = {"verify", "{folder}/none"}, .says = {"{folder}/none", "no folder"}},
          {.name = "no output folder", .command = {"verify", "{scene}"}, .says = {"{scene}", "neither depth.json"}},
          {.name = "a file", .command = {"verify", "{sequence}"}, .says = {"{sequence}", "no folder"}},
          {.name = "verify: gone",
           .arrange = remove,
           .command = {"verify", "{depth}"},
           .says = {"missing", "depth/cam0/0001.png", "5 of 6"},
           .exit_code = 1},
          {.name = "verify: damaged",
           .arrange = empty,
           .command = {"verify", "{depth}"},
           .says = {"changed", "depth/cam0/0001.png", "5 of 6"},
           .exit_code = 1},
          {.name = "evaluate: damaged",
           .arrange = empty,
           .command = {"evaluate", "{sequence}", "{depth}"},
           .says = {"{depth}/depth/cam0/0001.png", "no bytes"}},
          {.name = "evaluate: no folder",
           .command = {"evaluate", "{sequence}", "{folder}/none"},
           .says = {"{folder}/none", "no such folder"}},
          {.name = "evaluate: the wrong way round",
           .command = {"evaluate", "{depth}", "{sequence}"},
           .says = {"{depth}", "not a regular file"}},
          {.name = "colour: gone",
           .arrange = remove,
           .command = {"colour", "{depth}", "-o", "{out}"},
           .says = {"{depth}/depth/cam0/0001.png", "camera 'cam0'", "depthfarm verify"}},
          {.name = "views: an unknown camera",
           .command = {"synthesize", "{sequence}", "{depth}", "-o", "{out}", "--view", "nobody"},
           .says = {"'nobody'", "it has cam0, cam1, cam2"}},
          {.name = "views: frames that have no depth",
           .command = views + Words{"--frames", "7:9"},
           .says = {"frames 7:9", "{depth} has depth of 0:2"}},
          {.name = "views: a camera file that is missing",
           .command = {"synthesize", "{sequence}", "{depth}", "-o", "{out}", "--camera", "{folder}/none.json"},
           .says = {"{folder}/none.json", "No such file"}},
          {.name = "views: a camera of the sequence where a file is wanted",
           .command = {"synthesize", "{sequence}", "{depth}", "-o", "{out}", "--camera", "cam1"},
           .says = {"camera file cam1", "No such file", "say --view cam1"}},
          {.name = "views: a camera without a size",
           .arrange = [](const BadCase& bad) { bad.Write(bad.path() / "camera.json", R"({"name": "v"})"); },
           .command = {"synthesize", "{sequence}", "{depth}", "-o", "{out}", "--camera", "{folder}/camera.json"},
           .says = {"{folder}/camera.json", "\"v\"", "'width' is missing"}},
          {.name = "views: no steps",
           .command = {"synthesize", "{sequence}", "{depth}", "-o", "{out}", "--path", "cam0,cam1", "--steps", "0"},
           .says = {"--steps", "0"}},
          {.name = "views: two kinds", .command = views + Words{"--path", "cam0,cam1"}, .says = {"one of --view"}},
      },
      /*with_depth=*/true);
}

}  // namespace
}  // namespace depthfarm::system_test
