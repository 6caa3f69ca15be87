// Options that are wrong: exit code 2 before anything is started, and words that name the option and what it takes.
#include <gtest/gtest.h>

#include "tests/system/bad_input.h"

namespace depthfarm::system_test {
namespace {

BadRow Option(const Words& options, const Words& says) {
  return {.name = testing::PrintToString(options), .arrange = {}, .command = RunWith(options), .says = says};
}

BadRow Params(const std::string& text, const Words& says) {
  return {.name = text,
          .arrange = [text](const BadCase& bad) { bad.Write(bad.path() / "params.json", text); },
          .command = RunWith({"--params", "{folder}/params.json"}),
          .says = Words{"{folder}/params.json"} + says};
}

TEST(BadInput, EstimationOptions) {
  CheckRows({
      Option({"--levels", "65535"}, {"levels is 65535", "2 to 65534"}),
      Option({"--levels", "1"}, {"levels is 1", "2 to 65534"}),
      Option({"--levels", "-1"}, {"levels is '-1'", "auto or a whole number from 1"}),
      Option({"--levels", "1e3"}, {"levels is '1e3'", "auto or a whole number from 1"}),
      Option({"--segments", "0"}, {"segments is '0'", "auto or a whole number from 1"}),
      Option({"--smoothing", "nan"}, {"smoothing is 'nan'", "a number"}),
      Option({"--smoothing", "-1"}, {"smoothing is -1", "0 to 100"}),
      Option({"--matching-window", "4"}, {"matching-window is 4", "odd number from 1 to 15"}),
      Option({"--gop", "0"}, {"gop is '0'", "all or a whole number > 0"}),
      Option({"--downscale", "3"}, {"downscale is 3", "1, 2 or 4"}),
      Option({"--holes", "1"}, {"holes is 1", "less than 1"}),
      Option({"--z-near", "9", "--z-far", "3"}, {"z-near is 9", "less than z-far"}),
      Option({"--z-near", "0"}, {"z-near is '0'", "> 0"}),
      Option({"--levels", "24", "--level-blocks", "500"}, {"level-blocks is 500", "number of levels, 24"}),
      Option({"--frames", "5:9"}, {"{sequence}", "frames 5:9", "the sequence has 0:2"}),
      Option({"--frames", "1:1"}, {"frames is '1:1'", "0 <= A < B"}),
      Option({"--frames", "0:99999999999"}, {"frames is '0:99999999999'", "0 <= A < B"}),
      Option({"--views", "cam0,nobody"}, {"'nobody'", "it has cam0, cam1, cam2"}),
      Option({"--views", "cam0"}, {"at least two views", "there are 1"}),
      Option({"--views", "cam1,cam0,cam1"}, {"camera 'cam1' twice"}),
      Option({"--views", "cam0,"}, {"views is 'cam0,'", "separated by commas"}),
      Option({"--preset", "ultra"}, {"preset is 'ultra'", "default, best, fast or paper"}),
      Option({"--prior", "{folder}/none"}, {"prior folder '{folder}/none' is no folder"}),
      Option({"--prior", "{scene}"}, {"prior folder {scene}", "prior.json", "README"}),
      Option({"--mask", "{folder}/none"}, {"mask folder '{folder}/none' is no folder"}),
      Option({"--mask", "{scene}/truth"}, {"mask folder {scene}/truth", "expected files such as cam0/0000.png"}),
      Option({"--mask", "sequence"}, {"{sequence}", "no camera has 'masks'", "--mask sequence"}),
      Option({"--workers", "0"}, {"--workers", "1 to 1024"}),
      Option({"--threads", "-1"}, {"--threads", "1 to 256"}),
      Option({"--log-level", "loud"}, {"--log-level", "loud", "debug"}),
      Option({"--frobnicate"}, {"not expected: --frobnicate", "--help"}),
      Option({"--params", "{folder}/none.json"}, {"none.json", "No such file"}),
  });
}

TEST(BadInput, ParamsFiles) {
  CheckRows({
      Params("[]", {"one JSON object"}),
      Params(R"({"levels": 24, "levels": 30})", {"key \"levels\" is given twice"}),
      Params(R"({"level": 24})", {"unknown option 'level'", "levels"}),
      Params(R"({"levels": "many"})", {"levels is 'many'", "auto or a whole number from 1"}),
      Params(R"({"levels": -4})", {"levels is '-4'", "auto or a whole number from 1"}),
      Params(R"({"levels": 24)", {"not valid JSON"}),
      Params(R"({"preset": "ultra"})", {"preset is 'ultra'"}),
  });
}

TEST(BadInput, CommandsAndTheirWords) {
  CheckRows({
      {.name = "none", .command = {}, .says = {"subcommand is required", "--help"}},
      {.name = "unknown", .command = {"frobnicate"}, .says = {"no command 'frobnicate'", "there are", "synthesize"}},
      {.name = "run without output", .command = {"run", "{sequence}"}, .says = {"--output is required"}},
      {.name = "a job that is no number", .command = {"status", "seven"}, .says = {"'seven' is not a job number"}},
      {.name = "a negative job", .command = {"cancel", "--", "-1"}, .says = {"'-1' is not a job number"}},
      {.name = "a kind of scene",
       .command = {"scene", "sphere", "-o", "{out}"},
       .says = {"'sphere'", "arc, line, grid"}},
      {.name = "a scene without pixels", .command = {"scene", "arc", "-o", "{out}", "--size", "0x5"}, .says = {"0x5"}},
      {.name = "a scene of one camera",
       .command = {"scene", "arc", "-o", "{out}", "--cameras", "1"},
       .says = {"2 to 256"}},
      {.name = "a negative seed", .command = {"scene", "arc", "-o", "{out}", "--seed", "-1"}, .says = {"--seed", "-1"}},
      {.name = "an unknown preset of bench", .command = {"bench", "--preset", "default,ultra"}, .says = {"'ultra'"}},
      {.name = "a negative cache",
       .command = {"--coordinator", "ipc://{folder}/farm", "--cache-dir", "{out}", "--cache-size", "-1"},
       .says = {"--cache-size", "'-1'", "20GB"},
       .program = "depthfarm-worker"},
      {.name = "no slots",
       .command = {"--coordinator", "ipc://{folder}/farm", "--cache-dir", "{out}", "--slots", "0"},
       .says = {"--slots", "1 to 1024"},
       .program = "depthfarm-worker"},
      {.name = "a map of relative paths",
       .command = {"--coordinator", "ipc://{folder}/farm", "--cache-dir", "{out}", "--path-map", "a=b"},
       .says = {"'a=b'", "FROM=TO", "absolute"},
       .program = "depthfarm-worker"},
      {.name = "a lease that is too short",
       .command = {"--listen", "ipc://{folder}/farm", "--journal", "none", "--lease-ms", "1"},
       .says = {"lease is 1 ms", "at least 3 heartbeats"},
       .program = "depthfarm-coordinator"},
      {.name = "a negative number of jobs",
       .command = {"--listen", "ipc://{folder}/farm", "--journal", "none", "--keep-jobs", "-1"},
       .says = {"--keep-jobs", "-1"},
       .program = "depthfarm-coordinator"},
  });
}

}  // namespace
}  // namespace depthfarm::system_test
