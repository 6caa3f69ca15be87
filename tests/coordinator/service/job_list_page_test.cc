#include "coordinator/service/job_list_page.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace depthfarm {
namespace {

v1::ListJobs Request(std::uint32_t max_jobs, std::uint64_t after = 0) {
  v1::ListJobs request;
  request.set_max_jobs(max_jobs);
  request.set_after(after);
  return request;
}

v1::JobStatus Job(std::uint64_t id, std::size_t name_bytes = 0) {
  v1::JobStatus job;
  job.set_job_id(id);
  job.set_name(std::string(name_bytes, 'n'));
  return job;
}

// The page that holds what comes after, of `count` jobs with such names.
v1::JobList PageOf(const v1::ListJobs& request, std::uint64_t count, std::size_t name_bytes = 0) {
  JobListPage page(request);
  for (std::uint64_t id = 1; id <= count; ++id) {
    if (page.IsAfter(JobId(id)) && !page.Add(Job(id, name_bytes))) break;
  }
  return std::move(page).Take();
}

// How many jobs each page has, one after the other.
std::vector<int> Pages(std::uint32_t max_jobs, std::uint64_t count, std::size_t name_bytes = 0) {
  std::vector<int> pages;
  std::uint64_t seen = 0;
  std::uint64_t after = 0;
  do {
    const v1::JobList page = PageOf(Request(max_jobs, after), count, name_bytes);
    pages.push_back(page.jobs_size());
    for (const v1::JobStatus& job : page.jobs()) EXPECT_EQ(job.job_id(), ++seen);
    after = page.next();
  } while (after != 0);
  EXPECT_EQ(seen, count);
  return pages;
}

TEST(JobListPage, HasAsManyJobsAsWereAskedFor) {
  EXPECT_EQ(Pages(3, 7), (std::vector<int>{3, 3, 1}));
  EXPECT_EQ(Pages(3, 6), (std::vector<int>{3, 3}));
  EXPECT_EQ(Pages(3, 0), (std::vector<int>{0}));
  EXPECT_EQ(Pages(1, 2), (std::vector<int>{1, 1}));
}

TEST(JobListPage, HasAThousandJobsAtMost) {
  EXPECT_EQ(Pages(~std::uint32_t{0}, 2500), (std::vector<int>{1000, 1000, 500}));
}

TEST(JobListPage, HasFourMebibytesAtMostOrOneJob) {
  EXPECT_EQ(Pages(1000, 5, std::size_t{3} << 19), (std::vector<int>{2, 2, 1}));
  EXPECT_EQ(Pages(1000, 3, std::size_t{5} << 20), (std::vector<int>{1, 1, 1}));
}

TEST(JobListPage, IsTheWholeListForWhoAsksForNoNumber) { EXPECT_EQ(Pages(0, 2500, 4000), (std::vector<int>{2500})); }

TEST(JobListPage, GoesOnAfterAJobThatIsNoLongerThere) {
  const v1::JobList page = PageOf(Request(10, 100), 5);
  EXPECT_EQ(page.jobs_size(), 0);
  EXPECT_EQ(page.next(), 0U);
}

}  // namespace
}  // namespace depthfarm
