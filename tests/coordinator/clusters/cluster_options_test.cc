#include "coordinator/clusters/cluster_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace depthfarm {
namespace {

using testing::HasSubstr;

TEST(ParseWorkerRange, TakesANumberOrBounds) {
  EXPECT_EQ(ParseWorkerRange("3").value(), (WorkerRange{3, 3}));
  EXPECT_EQ(ParseWorkerRange("4..64").value(), (WorkerRange{4, 64}));
  EXPECT_EQ(ParseWorkerRange("0..1").value(), (WorkerRange{0, 1}));
  for (const char* wrong : {"", "0", "-1", "many", "0..0", "5..4", "1...4", "1..", "..4", "1..5000", "1-4", "1..4 "}) {
    EXPECT_EQ(ParseWorkerRange(wrong).status().code(), ErrorCode::kInvalidArgument) << wrong;
  }
}

TEST(ParseEngine, NamesAreTaken) {
  for (const char* name : {"local", "slurm", "ssh"}) EXPECT_EQ(EngineName(ParseEngine(name).value()), name);
  EXPECT_THAT(ParseEngine("kubernetes").status().message(), HasSubstr("expected local, slurm or ssh"));
}

ClusterOptions AllOptions() {
  return {.name = "render",
          .state_dir = "/home/anna/state",
          .engine = EngineKind::kSlurm,
          .workers = {4, 64},
          .slots = 8,
          .threads = 2,
          .worker_memory_bytes = 12'345'678'901,
          .worker_program = "/opt/worker",
          .cache_dir = "/scratch",
          .cache_size = "20GB",
          .tags = {"fast", "room2"},
          .path_map = {"/a=/b"},
          .idle_seconds = 30,
          .coordinator = "tcp://head:7700",
          .keys_dir = "/keys",
          .insecure = true,
          .host = "head-ib",
          .port = 7700,
          .keeps_journal = false,
          .manager_as_job = true,
          .partition = "p",
          .time = "1:00:00",
          .account = "a",
          .qos = "q",
          .engine_arguments = {"--constraint=avx2"},
          .hosts_file = "/hosts"};
}

TEST(ClusterOptions, ComeBackFromJson) {
  EXPECT_EQ(ClusterOptionsFromJson(ClusterOptionsToJson(AllOptions())).value(), AllOptions());
  EXPECT_EQ(ClusterOptionsFromJson(ClusterOptionsToJson({})).value(), ClusterOptions());
  for (const char* wrong : {"", "{}", "[]", "null", R"({"engine": "cloud"})"}) {
    EXPECT_FALSE(ClusterOptionsFromJson(wrong).ok()) << wrong;
  }
}

TEST(CheckClusterOptions, SaysWhatDoesNotFit) {
  EXPECT_TRUE(CheckClusterOptions({}).ok());
  ClusterOptions slurm;
  slurm.engine = EngineKind::kSlurm;
  ClusterOptions ssh;
  ssh.engine = EngineKind::kSsh;
  ssh.hosts_file = "/hosts";
  const ClusterOptions local;
  struct Row {
    ClusterOptions base;
    std::function<void(ClusterOptions&)> change;
    const char* expected;
  };
  const std::vector<Row> rows = {
      {local, [](auto& o) { o.name = ""; }, "--name is ''"},
      {local, [](auto& o) { o.name = "a/b"; }, "--name is 'a/b'"},
      {local, [](auto& o) { o.name = std::string(33, 'a'); }, "--name is"},
      {local, [](auto& o) { o.partition = "p"; }, "--partition is for --engine slurm"},
      {ssh, [](auto& o) { o.time = "1:00"; }, "--time is for --engine slurm"},
      {ssh, [](auto& o) { o.account = "a"; }, "--account is for --engine slurm"},
      {local, [](auto& o) { o.qos = "q"; }, "--qos is for --engine slurm"},
      {slurm, [](auto& o) { o.partition = "p\n#SBATCH --wrap=x"; }, "--partition holds a control character"},
      {slurm, [](auto& o) { o.engine_arguments = {"--x\nrm -rf"}; }, "--engine-option holds a control character"},
      {slurm, [](auto& o) { o.engine_arguments = {"constraint"}; }, "an option of sbatch"},
      {ssh, [](auto& o) { o.engine_arguments = {"host"}; }, "an option of ssh"},
      {local, [](auto& o) { o.engine_arguments = {"-v"}; }, "--engine-option is for"},
      {ssh, [](auto& o) { o.manager_as_job = true; }, "--batch is for --engine slurm"},
      {ssh, [](auto& o) { o.hosts_file = ""; }, "--engine ssh needs --hosts"},
      {slurm, [](auto& o) { o.hosts_file = "/hosts"; }, "--hosts is for --engine ssh"},
      {slurm, [](auto& o) { o.coordinator = "tcp://head:7700", o.port = 7700; }, "--host and --port"},
      {slurm, [](auto& o) { o.coordinator = "tcp://head:7700", o.host = "head"; }, "--host and --port"},
      {slurm, [](auto& o) { o.keys_dir = "/keys"; }, "belong to --coordinator"},
      {local, [](auto& o) { o.insecure = true; }, "belong to --coordinator"},
  };
  for (const Row& row : rows) {
    ClusterOptions options = row.base;
    EXPECT_TRUE(CheckClusterOptions(options).ok());
    row.change(options);
    const Status status = CheckClusterOptions(options);
    EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument) << row.expected;
    EXPECT_THAT(status.message(), HasSubstr(row.expected));
  }
}

}  // namespace
}  // namespace depthfarm
