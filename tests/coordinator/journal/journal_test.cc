#include "coordinator/journal/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/digest/sha256.h"
#include "coordinator/journal/database.h"
#include "coordinator/journal/frame_codec.h"
#include "coordinator/journal/schema.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

CommittedFrame FrameOf(const std::string& content) { return {{{Sha256(content), content.size()}}, {Sha256("p")}}; }

class JournalTest : public testing::Test {
 protected:
  void SetUp() override { Reopen(); }
  void Reopen() {
    journal_.reset();
    Result<std::unique_ptr<Journal>> opened = Journal::Open(path_, options_);
    ASSERT_TRUE(opened.ok()) << opened.status().message();
    journal_ = std::move(opened).value();
  }
  void Admit(std::uint64_t id, const std::string& folder = "/out") {
    ASSERT_TRUE(journal_->Admit({JobId(id), 9, folder, "job " + std::to_string(id), JobState::kRunning, ""}).ok());
  }
  void End(std::uint64_t id, JobState state) {
    ASSERT_TRUE(journal_->End(JobId(id), state, "ended " + std::to_string(id)).ok());
  }
  std::vector<std::uint64_t> Ids() {
    std::vector<std::uint64_t> ids;
    const std::vector<JournaledJob> jobs = journal_->Jobs().value();
    for (const JournaledJob& job : jobs) ids.push_back(job.id.value());
    return ids;
  }

  testing_support::TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "journal.sqlite").string();
  JournalOptions options_;
  std::unique_ptr<Journal> journal_;
};

TEST_F(JournalTest, KeepsJobsAndFramesOverARestart) {
  Admit(7);
  ASSERT_TRUE(journal_->Commit(JobId(7), 3, FrameOf("three")).ok());
  ASSERT_TRUE(journal_->Commit(JobId(7), 0, FrameOf("zero")).ok());
  ASSERT_TRUE(journal_->Commit(JobId(7), 3, FrameOf("three again")).ok());
  Reopen();
  const std::vector<JournaledJob> jobs = journal_->Jobs().value();
  ASSERT_EQ(jobs.size(), 1U);
  EXPECT_EQ(jobs[0].id, JobId(7));
  EXPECT_EQ(jobs[0].algorithm_version, 9U);
  EXPECT_EQ(jobs[0].output_dir, "/out");
  EXPECT_EQ(journal_->Find(JobId(7)).value()->submission, "job 7");
  EXPECT_EQ(jobs[0].state, JobState::kRunning);
  EXPECT_EQ(journal_->Frames(JobId(7)).value(), (CommittedFrames{{0, FrameOf("zero")}, {3, FrameOf("three again")}}));
  EXPECT_EQ(journal_->LastJob().value(), JobId(7));
  EXPECT_FALSE(journal_->Find(JobId(8)).value().has_value());
}

TEST_F(JournalTest, SubmissionsMayHoldAnyBytes) {
  const std::string any("\0\xff'\"\n\0", 6);
  ASSERT_TRUE(journal_->Admit({JobId(1), 9, "/out", any, JobState::kRunning, ""}).ok());
  Reopen();
  EXPECT_EQ(journal_->Find(JobId(1)).value()->submission, any);
}

TEST_F(JournalTest, AJobThatIsDoneNeedsItsFramesNoMore) {
  Admit(1);
  ASSERT_TRUE(journal_->Commit(JobId(1), 0, FrameOf("zero")).ok());
  End(1, JobState::kDone);
  const std::optional<JournaledJob> job = journal_->Find(JobId(1)).value();
  ASSERT_TRUE(job);
  EXPECT_EQ(job->state, JobState::kDone);
  EXPECT_EQ(job->status, "ended 1");
  EXPECT_EQ(job->submission, "");
  EXPECT_TRUE(journal_->Frames(JobId(1)).value().empty());
}

TEST_F(JournalTest, ResultsThatWorkersKeepCanBeFoundLater) {
  Admit(1);
  ASSERT_TRUE(journal_->Commit(JobId(1), 0, FrameOf("zero")).ok());
  ASSERT_TRUE(journal_->End(JobId(1), JobState::kDone, "ended", true).ok());
  EXPECT_EQ(journal_->Find(JobId(1)).value()->submission, "job 1");
  EXPECT_EQ(journal_->Frames(JobId(1)).value().size(), 1U);
}

TEST_F(JournalTest, AJobThatFailedMayGoOn) {
  Admit(1);
  ASSERT_TRUE(journal_->Commit(JobId(1), 0, FrameOf("zero")).ok());
  End(1, JobState::kFailed);
  EXPECT_EQ(journal_->Find(JobId(1)).value()->submission, "job 1");
  EXPECT_EQ(journal_->Frames(JobId(1)).value().size(), 1U);
  ASSERT_TRUE(journal_->Commit(JobId(1), 1, FrameOf("one")).ok());
  const JournaledJob again{JobId(1), 9, "/out", "job 1", JobState::kRunning, ""};
  ASSERT_TRUE(journal_->Admit(again, {{1, FrameOf("one")}}).ok());
  EXPECT_EQ(journal_->Find(JobId(1)).value()->state, JobState::kRunning);
  EXPECT_EQ(journal_->Frames(JobId(1)).value(), (CommittedFrames{{1, FrameOf("one")}}));
  ASSERT_TRUE(journal_->Forget(JobId(1), 1).ok());
  EXPECT_TRUE(journal_->Frames(JobId(1)).value().empty());
}

TEST_F(JournalTest, AnEndThatWasAskedForIsRemembered) {
  Admit(1);
  ASSERT_TRUE(journal_->Cancel(JobId(1)).ok());
  Reopen();
  EXPECT_EQ(journal_->Find(JobId(1)).value()->state, JobState::kCancelled);
  EXPECT_FALSE(journal_->Find(JobId(1)).value()->ended);
  End(1, JobState::kCancelled);
  EXPECT_TRUE(journal_->Find(JobId(1)).value()->ended);
  ASSERT_TRUE(journal_->Cancel(JobId(1)).ok());
  Admit(1);
  EXPECT_EQ(journal_->Find(JobId(1)).value()->state, JobState::kRunning);
}

TEST_F(JournalTest, KeepsTheJobsThatEndedLast) {
  options_ = {.kept_jobs = 3, .kept_submissions = 1};
  Reopen();
  for (std::uint64_t id = 1; id <= 6; ++id) Admit(id);
  for (const std::uint64_t id : {5U, 2U, 1U}) End(id, JobState::kCancelled);
  End(3, JobState::kDone);
  EXPECT_THAT(Ids(), ElementsAre(4, 6, 2, 1, 3)) << "4 and 6 run, 5 ended first";
  EXPECT_EQ(journal_->Find(JobId(1)).value()->submission, "job 1");
  EXPECT_EQ(journal_->Find(JobId(2)).value()->submission, "");
  EXPECT_EQ(journal_->LastJob().value(), JobId(6));
}

TEST_F(JournalTest, IdsAreNotUsedAgainWhenJobsAreForgotten) {
  options_.kept_jobs = 0;
  Reopen();
  Admit(9);
  End(9, JobState::kDone);
  EXPECT_TRUE(Ids().empty());
  EXPECT_EQ(journal_->LastJob().value(), JobId(9));
}

TEST_F(JournalTest, FramesAreThoseOfTheLastJobThatHadTheFolder) {
  const auto commit = [&](std::uint64_t id) { ASSERT_TRUE(journal_->Commit(JobId(id), 0, FrameOf("zero")).ok()); };
  const auto frames = [&](std::uint64_t id) { return journal_->Frames(JobId(id)).value().size(); };
  Admit(1, "/a");
  commit(1);
  End(1, JobState::kCancelled);
  Admit(2, "/b");
  commit(2);
  Admit(3, "/a");
  EXPECT_EQ(frames(1), 0U);
  EXPECT_EQ(frames(2), 1U);
  commit(3);
  End(3, JobState::kCancelled);
  Admit(1, "/a");  // goes on, after another one
  EXPECT_EQ(frames(3), 0U);
  // Results on workers have no folder.
  Admit(4, "");
  commit(4);
  Admit(5, "");
  EXPECT_EQ(frames(4), 1U);
}

TEST_F(JournalTest, BelongsToOneProcessAtATime) {
  const Result<std::unique_ptr<Journal>> second = Journal::Open(path_);
  EXPECT_EQ(second.status().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(second.status().message(), HasSubstr("another process uses it"));
  EXPECT_THAT(second.status().message(), HasSubstr(path_));
}

TEST_F(JournalTest, IsItsOwnersAlone) {
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(JournalTest, RefusesWhatIsNoJournalOrANewerOne) {
  const std::string text = (folder_.path() / "text").string();
  std::ofstream(text) << std::string(5000, 'x');
  EXPECT_EQ(Journal::Open(text).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(Journal::Open((folder_.path() / "no/such/folder").string()).status().code(), ErrorCode::kUnavailable);
  journal_.reset();
  std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(60);  // user_version of the SQLite header, big-endian
  file.write("\0\0\0\x09", 4);
  file.close();
  const Status newer = Journal::Open(path_).status();
  EXPECT_EQ(newer.code(), ErrorCode::kIncompatible) << newer.message();
  EXPECT_THAT(newer.message(), HasSubstr("newer depthfarm"));
}

TEST_F(JournalTest, ACheckReadsAllOfIt) {
  Admit(1);
  ASSERT_TRUE(journal_->Commit(JobId(1), 0, FrameOf("zero")).ok());
  Admit(2, "/b");
  End(2, JobState::kDone);
  journal_.reset();
  EXPECT_EQ(CheckJournal(path_).value(), "ok: 2 jobs, 1 of them running, 1 frames in place");
  fs::resize_file(path_, fs::file_size(path_) - 4096);
  EXPECT_FALSE(CheckJournal(path_).ok());
  const std::string other = path_ + "-of-nobody";
  EXPECT_EQ(CheckJournal(other).status().code(), ErrorCode::kUnavailable);
  EXPECT_FALSE(fs::exists(other));
}

// As the first journals of version 1 were made (coordinator/journal/journal.cc of 28 November 2026), with a job in each
// state.
constexpr const char* kFirstVersion = R"(
CREATE TABLE jobs (id INTEGER PRIMARY KEY, algorithm_version INTEGER NOT NULL, output_dir TEXT NOT NULL,
                   submission BLOB NOT NULL, state INTEGER NOT NULL, status BLOB NOT NULL, ended INTEGER NOT NULL);
CREATE INDEX jobs_of_folder ON jobs (output_dir);
CREATE TABLE frames (job INTEGER NOT NULL, frame INTEGER NOT NULL, committed BLOB NOT NULL,
                     PRIMARY KEY (job, frame)) WITHOUT ROWID;
CREATE TABLE last_job (id INTEGER NOT NULL);
INSERT INTO last_job VALUES (3);
INSERT INTO jobs VALUES (1, 9, '/a', x'', 1, x'64', 1);
INSERT INTO jobs VALUES (2, 9, '/b', x'6a32', 2, x'66', 2);
INSERT INTO jobs VALUES (3, 9, '/c', x'6a33', 0, x'', 0);
PRAGMA application_id = 1684433457;
PRAGMA user_version = 1;
)";

class OldJournal : public testing::Test {
 protected:
  void SetUp() override {
    const std::unique_ptr<Database> database = Database::Open(path_, true).value();
    const Status made = database->Execute(kFirstVersion);
    ASSERT_TRUE(made.ok()) << made.message();
    ASSERT_TRUE(
        database->Prepare("INSERT INTO frames VALUES (3, 0, ?)").BindBlob(EncodeFrame(FrameOf("zero"))).Run().ok());
  }
  std::int64_t Version() { return JournalVersionOf(*Database::Open(path_, false).value()).value(); }

  testing_support::TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "journal.sqlite").string();
};

TEST_F(OldJournal, IsBroughtUpToDateWithAllThatIsInIt) {
  std::unique_ptr<Journal> journal = Journal::Open(path_).value();
  EXPECT_EQ(journal->LastJob().value(), JobId(3));
  EXPECT_EQ(journal->Jobs().value().size(), 3U);
  EXPECT_EQ(journal->Find(JobId(3)).value()->submission, "j3");
  EXPECT_EQ(journal->Frames(JobId(3)).value().at(0).files, FrameOf("zero").files);
  // Written as in a new one.
  ASSERT_TRUE(journal->Admit({JobId(4), 9, "/d", "j4", JobState::kRunning, ""}).ok());
  ASSERT_TRUE(journal->End(JobId(3), JobState::kFailed, "f").ok());
  EXPECT_EQ(journal->Find(JobId(2)).value()->submission, "j2") << "one that failed can still go on";
  EXPECT_EQ(journal->Find(JobId(3)).value()->submission, "j3");
  journal.reset();
  EXPECT_EQ(Version(), kJournalVersion);
  EXPECT_EQ(Journal::Open(path_).value()->Jobs().value().size(), 4U);
}

TEST_F(OldJournal, ACheckTellsItsVersionAndChangesNothing) {
  EXPECT_EQ(CheckJournal(path_).value(),
            "ok: 3 jobs, 1 of them running, 1 frames in place; of journal version 1: the next coordinator makes it "
            "version 2");
  EXPECT_EQ(Version(), 1);
}

TEST_F(OldJournal, OneThatHasTheColumnIsOnlyRenumbered) {
  {
    const std::unique_ptr<Database> database = Database::Open(path_, false).value();
    ASSERT_TRUE(database
                    ->Execute("ALTER TABLE jobs ADD COLUMN wanted INTEGER NOT NULL DEFAULT 0;"
                              "UPDATE jobs SET wanted = 7 WHERE id = 2")
                    .ok());
  }
  (void)Journal::Open(path_).value();
  const std::unique_ptr<Database> database = Database::Open(path_, false).value();
  Statement wanted = database->Prepare("SELECT wanted FROM jobs WHERE id = 2");
  ASSERT_TRUE(wanted.Next().value());
  EXPECT_EQ(wanted.Integer(0), 7);
  EXPECT_EQ(JournalVersionOf(*database).value(), kJournalVersion);
}

// A step that fails leaves the old version whole.
TEST_F(OldJournal, AChangeThatFailsChangesNothing) {
  {
    const std::unique_ptr<Database> database = Database::Open(path_, false).value();
    ASSERT_TRUE(
        database->Execute("CREATE TRIGGER disk_full BEFORE UPDATE ON jobs BEGIN SELECT raise(ABORT, 'full'); END")
            .ok());
  }
  EXPECT_FALSE(Journal::Open(path_).ok());
  EXPECT_EQ(Version(), 1);
  const std::unique_ptr<Database> database = Database::Open(path_, false).value();
  Statement columns = database->Prepare("SELECT count(*) FROM pragma_table_info('jobs')");
  ASSERT_TRUE(columns.Next().value());
  EXPECT_EQ(columns.Integer(0), 7);
}

TEST(JournalInMemory, DoesTheSame) {
  const std::unique_ptr<Journal> journal = Journal::Open("").value();
  ASSERT_TRUE(journal->Admit({JobId(1), 9, "/out", "job", JobState::kRunning, ""}).ok());
  EXPECT_EQ(journal->Jobs().value().size(), 1U);
  EXPECT_TRUE(Journal::Open("").ok()) << "each its own";
}

}  // namespace
}  // namespace depthfarm
