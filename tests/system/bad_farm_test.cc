// Coordinators that are not there, keys that are wrong, jobs that a farm does not have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/bad_input.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(BadInput, NoCoordinator) {
  const Words nobody = {"--coordinator", "ipc://{folder}/nobody", "--timeout", "0.2"};
  const Words says = {"no answer from coordinator ipc://{folder}/nobody", "depthfarm-coordinator running"};
  std::vector<BadRow> rows;
  for (const Words& command :
       {Words{"jobs"}, Words{"workers"}, Words{"status", "1"}, Words{"logs", "1"}, Words{"cancel", "1"},
        Words{"retry", "1"}, Words{"drain", "w"}, Words{"submit", "{sequence}", "-o", "{out}"},
        Words{"submit", "{sequence}", "-o", "{out}", "--upload"}, Words{"fetch", "1", "-o", "{out}"}}) {
    rows.push_back({.name = command[0], .arrange = {}, .command = command + nobody, .says = says, .exit_code = 3});
  }
  // What is wrong before anybody is asked.
  rows.push_back({.name = "tags",
                  .arrange = {},
                  .command = Words{"submit", "{sequence}", "-o", "{out}", "--require", "a b"} + nobody,
                  .says = {"--require has 'a b'", "letters"}});
  CheckRows(rows);
}

TEST(BadInput, EndpointsAndKeys) {
  const auto endpoint = [](const std::string& address, const Words& says) {
    return BadRow{.name = address, .arrange = {}, .command = {"jobs", "--coordinator", address}, .says = says};
  };
  const auto keys = [](const std::string& name, void (*damage)(const BadCase&), const Words& says) {
    return BadRow{.name = name,
                  .arrange =
                      [damage](const BadCase& bad) {
                        ASSERT_EQ(Depthfarm({"keygen", "-o", (bad.path() / "keys").string()}).exit_code, 0);
                        damage(bad);
                      },
                  .command = {"jobs", "--coordinator", "tcp://127.0.0.1:1", "--keys", "{folder}/keys"},
                  .says = says};
  };
  CheckRows({
      endpoint("udp://host:1", {"'udp://host:1'", "tcp://HOST:PORT or ipc://PATH"}),
      endpoint("tcp://host", {"'tcp://host'", "tcp://HOST:PORT"}),
      endpoint("tcp://127.0.0.1:99999", {"port from 1 to 65535"}),
      endpoint("ipc:///" + std::string(200, 'a'), {"a socket takes at most 107"}),
      endpoint("tcp://127.0.0.1:1", {"needs keys", "depthfarm keygen"}),
      keys("no key", [](const BadCase& bad) { fs::remove(bad.path() / "keys/client.key"); },
           {"{folder}/keys/client.key", "No such file"}),
      keys("half a key", [](const BadCase& bad) { fs::resize_file(bad.path() / "keys/client.key", 20); },
           {"{folder}/keys/client.key", "40 characters of Z85"}),
      keys("no bytes", [](const BadCase& bad) { fs::resize_file(bad.path() / "keys/coordinator.pub", 0); },
           {"{folder}/keys/coordinator.pub", "40 characters of Z85"}),
      keys("a key that others may read",
           [](const BadCase& bad) { fs::permissions(bad.path() / "keys/client.key", fs::perms{0644}); },
           {"{folder}/keys/client.key", "chmod 600"}),
      {.name = "keys that exist",
       .arrange =
           [](const BadCase& bad) {
             ASSERT_EQ(Depthfarm({"keygen", "-o", bad.out().string()}).exit_code, 0);
           },
       .command = {"keygen", "-o", "{out}"},
       .says = {"{out}/coordinator.key", "never replaced"},
       .leaves = Leaves::kWhatWasThere},
      {.name = "a role that is none",
       .arrange =
           [](const BadCase& bad) {
             ASSERT_EQ(Depthfarm({"keygen", "-o", (bad.path() / "keys").string()}).exit_code, 0);
             bad.Write(bad.path() / "keys/authorized", "boss " + std::string(40, 'a') + "\n");
           },
       .command = {"--listen", "tcp://127.0.0.1:*", "--keys", "{folder}/keys", "--journal", "none"},
       .says = {"{folder}/keys/authorized line 1", "'boss'", "work, submit or admin"},
       .program = "depthfarm-coordinator"},
      {.name = "a journal that is none",
       .arrange = [](const BadCase& bad) { bad.Write(bad.out(), std::string(5000, 'x')); },
       .command = {"--listen", "ipc://{folder}/farm", "--journal", "{out}"},
       .says = {"{out}", "not a database"},
       .exit_code = 1,
       .leaves = Leaves::kWhatWasThere,
       .program = "depthfarm-coordinator"},
      {.name = "a socket in no folder",
       .command = {"--listen", "ipc://{folder}/none/farm", "--journal", "none"},
       .says = {"cannot listen on ipc://{folder}/none/farm", "No such file"},
       .exit_code = 1,
       .program = "depthfarm-coordinator"},
  });
}

// One coordinator without workers is enough.
TEST(BadInput, JobsOfAFarm) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 2, .size = "64x48"});
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  ASSERT_EQ(Depthfarm(Words{"submit", sequence, "-o", folder / "out"} + farm.Options()).exit_code, 0);
  ASSERT_EQ(Depthfarm(Words{"submit", sequence} + farm.Options()).exit_code, 0);
  fs::create_directories(folder.path() / "foreign/depth");
  const auto expect = [&](const Words& words, const Words& says) {
    const Outcome outcome = Depthfarm(words + farm.Options());
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    for (const std::string& text : says) EXPECT_THAT(outcome.output, HasSubstr(text));
    EXPECT_FALSE(fs::exists(folder / "fetched"));
  };
  expect({"submit", sequence, "-o", folder / "out/"}, {"job 1 writes to " + (folder / "out"), "choose another folder"});
  for (const char* command : {"status", "logs", "cancel", "retry", "watch"}) expect({command, "9"}, {"no job 9"});
  expect({"fetch", "9", "-o", folder / "fetched"}, {"no job 9"});
  expect({"fetch", "1", "-o", folder / "fetched"}, {"job 1 writes to " + (folder / "out")});
  expect({"fetch", "2", "-o", folder / "foreign"}, {folder / "foreign/depth", "choose another folder"});
  expect({"retry", "1"}, {"job 1 is still running"});
  expect({"logs", "1", "--task", "frobnicate 3"}, {"'frobnicate 3'", "frame 3 estimate block 0"});
  expect({"drain", "nobody"}, {"no worker 'nobody'"});
  expect({"submit", sequence, "-o", folder / "x", "--name", "a\nb"}, {"job name", "control character"});
  expect({"submit", sequence, "-o", folder / "x", "--priority", "5000"}, {"--priority", "-1000 to 1000"});
  expect({"submit", sequence, "-o", "/"}, {"'/'", "below the root"});
}

}  // namespace
}  // namespace depthfarm::system_test
