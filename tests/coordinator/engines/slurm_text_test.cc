#include "coordinator/engines/slurm_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

PilotSpec Spec() {
  return {.cluster = "render-1x2",
          .worker_program = "/opt/depth farm/depthfarm-worker",
          .coordinator = "tcp://head:7700",
          .keys_dir = "/home/anna/keys"};
}

TEST(SlurmScript, AsksForWhatAWorkerTakes) {
  PilotSpec spec = Spec();
  spec.slots = 4;
  spec.threads = 2;
  spec.memory_bytes = std::uint64_t{8} << 30;
  const std::string script = SlurmScript({.partition = "render",
                                          .time = "8:00:00",
                                          .account = "ftv",
                                          .qos = "low",
                                          .arguments = {"--constraint=avx2"},
                                          .log_dir = "/home/anna/log"},
                                         spec, "depthfarm-render-1x2");
  EXPECT_THAT(script, StartsWith("#!/bin/sh\n#SBATCH "));
  for (const char* line :
       {"--job-name=depthfarm-render-1x2", "--ntasks=1", "--cpus-per-task=4", "--mem=8192M", "--partition=render",
        "--time=8:00:00", "--account=ftv", "--qos=low", "--constraint=avx2", "--requeue", "--open-mode=append",
        "--signal=B:TERM@120", "--output=/home/anna/log/worker-%A_%a.log"}) {
    EXPECT_THAT(script, HasSubstr(std::string("#SBATCH ") + line + "\n"));
  }
  spec.threads = 6;  // shared by the slots
  EXPECT_THAT(SlurmScript({}, spec, "wide"), HasSubstr("#SBATCH --cpus-per-task=6\n"));
  // The worker takes the shell's place, or Slurm's signals would not reach it; each restart has a name of its own.
  EXPECT_THAT(script, HasSubstr("\nexec '/opt/depth farm/depthfarm-worker' --coordinator tcp://head:7700 "));
  EXPECT_THAT(script, HasSubstr(" --stop-grace 100 "));
  EXPECT_THAT(script, HasSubstr("--name \"render-1x2.${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}."
                                "${SLURM_RESTART_COUNT:-0}\"\n"));
}

TEST(SlurmScript, LeavesOutWhatWasNotSaid) {
  const std::string script = SlurmScript({}, Spec(), "depthfarm-render-1x2");
  for (const char* option : {"--partition", "--time", "--account", "--qos", "--mem"}) {
    EXPECT_THAT(script, Not(HasSubstr(option))) << option;
  }
  EXPECT_THAT(script, HasSubstr("--output=/dev/null\n"));
}

TEST(SlurmScript, NoKeyIsInIt) {
  const std::string script = SlurmScript({}, Spec(), "j");
  EXPECT_THAT(script, HasSubstr("--keys /home/anna/keys"));
}

TEST(ParseSlurmTime, TakesWhatSbatchTakes) {
  EXPECT_EQ(ParseSlurmTime("90").value(), 5400);
  EXPECT_EQ(ParseSlurmTime("1:30").value(), 90);
  EXPECT_EQ(ParseSlurmTime("8:00:00").value(), 28'800);
  EXPECT_EQ(ParseSlurmTime("2-0").value(), 172'800);
  EXPECT_EQ(ParseSlurmTime("1-2:30").value(), 95'400);
  EXPECT_EQ(ParseSlurmTime("1-02:30:15").value(), 95'415);
  EXPECT_EQ(ParseSlurmTime("UNLIMITED").value(), std::nullopt);
  for (const char* wrong : {"", "0", "4h", "-5", "1:2:3:4", "1-", "-", "1-2-3", "99999999999", "1 2", "5\n"}) {
    EXPECT_EQ(ParseSlurmTime(wrong).status().code(), ErrorCode::kInvalidArgument) << wrong;
  }
}

TEST(NoticeSeconds, IsShorterForShortLimits) {
  EXPECT_EQ(NoticeSeconds("8:00:00"), 120);
  EXPECT_EQ(NoticeSeconds("4"), 60);
  EXPECT_EQ(NoticeSeconds("0:02"), 1);
  EXPECT_EQ(NoticeSeconds(""), 120);
  EXPECT_EQ(NoticeSeconds("UNLIMITED"), 120);
}

TEST(SlurmArrayArguments, CountFromZero) {
  EXPECT_THAT(SlurmArrayArguments(1), ElementsAre("--parsable", "--array=0-0"));
  EXPECT_THAT(SlurmArrayArguments(500), ElementsAre("--parsable", "--array=0-499"));
}

// What squeue of Slurm 22.05 writes.
TEST(ParseSqueue, TellsWhatWaitsAndRuns) {
  const auto pilots = ParseSqueue(
      "6_0|RUNNING|w2|None\n"
      "6_1|PENDING||Resources\n"
      "6_2|COMPLETING|w1|None\n"
      "7_0|CONFIGURING|w3|None\n"
      "7_1|PENDING||BeginTime\n"
      "7_2|SOMETHING_NEW|w3|None\n");
  ASSERT_TRUE(pilots.ok()) << pilots.status().message();
  EXPECT_THAT(*pilots,
              ElementsAre(Pilot{"6_0", true, "w2", "RUNNING"}, Pilot{"6_1", false, "", "PENDING (Resources)"},
                          Pilot{"7_0", true, "w3", "CONFIGURING"}, Pilot{"7_1", false, "", "PENDING (BeginTime)"}));
  EXPECT_THAT(ParseSqueue("").value(), IsEmpty());
}

TEST(ParseSqueue, RefusesWhatItDidNotAskFor) {
  for (const char* wrong : {"6_0 RUNNING\n", "6_0|RUNNING|w2\n", "|RUNNING|w2|None\n", "6_0||w2|None\n"}) {
    EXPECT_EQ(ParseSqueue(wrong).status().code(), ErrorCode::kCorrupt) << wrong;
  }
}

}  // namespace
}  // namespace depthfarm
