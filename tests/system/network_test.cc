// A farm over several hosts whose network fails. The coordinator and its clients are on host 0, a worker on each of the
// others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <ostream>
#include <set>
#include <string>

#include "tests/system/disturbed_job.h"
#include "tests/system/network_lab.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

using namespace std::chrono_literals;

constexpr int kWorkers = 3;

int Count(const std::string& text, const std::string& word) {
  int count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

class Network : public DisturbedJob {
 protected:
  void SetUp() override {
    lab_.emplace(1 + kWorkers);
    const std::string problem = lab_->problem().empty() ? Lay() : lab_->problem();
    if (!problem.empty()) GTEST_SKIP() << problem;
    DisturbedJob::SetUp();
    expected_ = Undisturbed();
    ASSERT_EQ(Depthfarm({"keygen", "-o", folder_ / "keys"}).exit_code, 0);
    coordinators_.emplace(*lab_, 0);
    farm_.emplace("tcp://" + NetworkLab::AddressOf(0) + ":*", folder_ / "keys");
    ASSERT_TRUE(farm_->ok()) << farm_->problem();
    for (int host = 1; host <= kWorkers; ++host) {
      const NetworkLab::On its_host(*lab_, host);
      farm_->AddWorker({"--advertise", NetworkLab::AddressOf(host), "--name", "host-" + std::to_string(host)});
    }
    ASSERT_TRUE(WaitForWorkers(kWorkers)) << farm_->Logs();
  }
  void TearDown() override { coordinators_.reset(); }
  // Makes the network something else than hosts on a switch, before anybody uses it. Why it can't; empty if it could.
  [[nodiscard]] virtual std::string Lay() { return ""; }

  [[nodiscard]] bool WaitForWorkers(std::size_t workers) {
    return WaitUntil([&] {
      const auto there = farm_->client().ListWorkers();
      return there.ok() && there->size() == workers;
    });
  }
  // How attempts of a job's tasks ended, other than well, because a duplicate elsewhere was faster, or given back by a
  // worker that was asked for them. (What is given back unasked is a grant that never arrived.)
  [[nodiscard]] std::set<std::string> Mishaps(std::uint64_t job) {
    const Outcome told = Depthfarm(Words{"logs", std::to_string(job), "--json"} + farm_->Options());
    const nlohmann::json logs = ParseJsonTail(told.output);
    std::multiset<std::string> ends;
    for (const nlohmann::json& attempt : logs.at("attempts")) ends.insert(attempt.at("outcome"));
    std::size_t asked_for = 0;
    for (int host = 1; host <= kWorkers; ++host)
      asked_for += static_cast<std::size_t>(Count(farm_->LogOf(host - 1), " given_back=true"));
    std::set<std::string> mishaps(ends.begin(), ends.end());
    for (const char* ended_well : {"done", "overtaken"}) mishaps.erase(ended_well);
    if (ends.count("given back") == asked_for) mishaps.erase("given back");
    return mishaps;
  }
  // Times that the worker of a host has said Hello.
  [[nodiscard]] int Hellos(int host) const { return Count(farm_->LogOf(host - 1), " hello "); }

  std::optional<NetworkLab> lab_;
  std::map<std::string, std::string> expected_;
  std::optional<NetworkLab::On> coordinators_;  // host, where this thread is
  std::optional<Farm> farm_;
};

struct Cut {
  const char* name;
  std::string (NetworkLab::*make)(int host) const;
};
void PrintTo(const Cut& cut, std::ostream* out) { *out << cut.name; }

class CutOff : public Network, public testing::WithParamInterface<Cut> {};
INSTANTIATE_TEST_SUITE_P(By, CutOff,
                         testing::Values(Cut{"ItsCable", &NetworkLab::Cut}, Cut{"NotBeingHeard", &NetworkLab::Mute},
                                         Cut{"NotHearing", &NetworkLab::Deafen}),
                         [](const testing::TestParamInfo<Cut>& cut) { return std::string(cut.param.name); });

TEST_P(CutOff, AWorkerIsReplacedAndWelcomeAgain) {
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 20));
  ASSERT_EQ(((*lab_).*GetParam().make)(1), "");
  ExpectDone(*farm_, job, output, expected_);
  ASSERT_TRUE(WaitForWorkers(kWorkers - 1)) << farm_->Logs();
  ASSERT_EQ(lab_->Heal(1), "");
  ASSERT_TRUE(WaitForWorkers(kWorkers)) << farm_->Logs();
  ExpectNextJobIsRight(*farm_, expected_);
}

TEST_F(Network, HealedInTheMiddleOfAJobHasItGoOnWithAllWorkers) {
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 10));
  ASSERT_EQ(lab_->Cut(1), "");
  ASSERT_EQ(lab_->Cut(2), "");
  ASSERT_EQ(lab_->Cut(3), "");
  ASSERT_TRUE(WaitForWorkers(0)) << farm_->Logs();
  for (int host = 1; host <= kWorkers; ++host) ASSERT_EQ(lab_->Heal(host), "");
  ASSERT_TRUE(WaitForWorkers(kWorkers)) << farm_->Logs();
  ExpectDone(*farm_, job, output, expected_);
  ExpectNextJobIsRight(*farm_, expected_);
}

TEST_F(Network, WithoutTheCoordinatorForMoreThanALeaseHasTheJobGoOn) {
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 20));
  ASSERT_EQ(lab_->Cut(0), "");
  // Those that are lost say Hello again to nobody.
  ASSERT_TRUE(WaitUntil([&] { return Hellos(1) > 1 && Hellos(2) > 1 && Hellos(3) > 1; })) << farm_->Logs();
  ASSERT_TRUE(WaitForWorkers(0)) << farm_->Logs();
  EXPECT_EQ(farm_->client().GetStatus(job).value().state(), v1::JOB_STATE_RUNNING);
  ASSERT_EQ(lab_->Heal(0), "");
  ExpectDone(*farm_, job, output, expected_);
  ASSERT_TRUE(WaitForWorkers(kWorkers)) << farm_->Logs();
  ExpectNextJobIsRight(*farm_, expected_);
}

TEST_F(Network, ThatLosesATenthOfAllPacketsIsSlowerAndNoMore) {
  constexpr int kPercent = 10;
  const std::string output = folder_ / "out";
  for (int host = 1; host <= kWorkers; ++host) ASSERT_EQ(lab_->Lose(host, kPercent), "");
  const std::uint64_t job = Submit(*farm_, output);
  ExpectDone(*farm_, job, output, expected_);
  for (int host = 1; host <= kWorkers; ++host) ASSERT_EQ(lab_->Heal(host), "");
  ExpectNextJobIsRight(*farm_, expected_);
}

TEST_F(Network, ThatPartsTwoWorkersHasThemMakeAgainWhatTheyCannotFetch) {
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 20));
  ASSERT_EQ(lab_->Part(1, 2), "");
  ExpectDone(*farm_, job, output, expected_);
  ASSERT_EQ(lab_->Heal(1), "");
  ExpectNextJobIsRight(*farm_, expected_);
}

// Most of what such a job takes is the way to and fro: few tasks.
Words JobOfFewTasks() {
  return {"--segments", "600", "--levels", "24", "--gop", "2", "--level-blocks", "2", "--refine", "1"};
}

// As between cities: each host is so far from the switch.
class LongNetwork : public Network {
 protected:
  LongNetwork() { job_ = JobOfFewTasks(); }
  std::string Lay() override {
    for (int host = 1; host <= kWorkers; ++host) {
      std::string problem = lab_->Delay(host, {.delay = 80ms, .jitter = 20ms});
      if (!problem.empty()) return problem;
    }
    return "";
  }
};

TEST_F(LongNetwork, HasAJobDoneAsByTheNeighbours) {
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ExpectDone(*farm_, job, output, expected_);
  EXPECT_THAT(Mishaps(job), testing::IsEmpty()) << farm_->Logs();
}

class SlowedNetwork : public Network {
 protected:
  SlowedNetwork() { job_ = JobOfFewTasks(); }
  std::string Lay() override { return lab_->Delay(0, {}); }
};

// Of the coordinator: the answer to a heartbeat comes after the next one was sent (they are sent every second), and far
// within a lease (6 s).
TEST_F(SlowedNetwork, InTheMiddleOfAJobCostsNoLease) {
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 70));
  ASSERT_EQ(lab_->Delay(0, {.delay = 600ms, .jitter = 50ms}), "");
  ExpectDone(*farm_, job, output, expected_);
  EXPECT_THAT(Mishaps(job), testing::IsEmpty()) << farm_->Logs();
  for (int host = 1; host <= kWorkers; ++host) EXPECT_EQ(Hellos(host), 1) << farm_->Logs();
  ASSERT_EQ(lab_->Heal(0), "");
  ExpectNextJobIsRight(*farm_, expected_);
}

}  // namespace
}  // namespace depthfarm::system_test
