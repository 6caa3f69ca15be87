#include "coordinator/service/submission.h"

#include <gtest/gtest.h>

#include "common/wire/render_wire.h"
#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/service/fake_peers.h"
#include "tests/coordinator/service/small_sequence.h"

namespace depthfarm {
namespace {

Result<PlannedJob> Plan(const v1::Envelope& request) { return PlanSubmission(request.submit_job(), JobId(5)); }

TEST(Submission, PicturesAreThoseOfTheJobsFramesAndViews) {
  v1::Envelope request = SubmitRequest(6, "/out");
  v1::EstimationParams* params = request.mutable_submit_job()->mutable_params();
  params->set_first_frame(2);
  params->set_end_frame(5);
  params->add_views("cam2");
  params->add_views("cam1");
  const Result<PlannedJob> job = Plan(request);
  ASSERT_TRUE(job.ok()) << job.status().message();
  ASSERT_EQ(job->pictures.size(), 2U);
  EXPECT_EQ(job->config.resolved.views[0].camera.name, "cam1");
  EXPECT_EQ(job->pictures[0], (std::vector<std::string>{"/in/cam1/2.png", "/in/cam1/3.png", "/in/cam1/4.png"}));
  EXPECT_EQ(job->config.job, JobId(5));
}

TEST(Submission, GuidesAreThoseOfTheJobsFramesAndViews) {
  v1::Envelope request = SubmitRequest(3, "/out");
  EXPECT_TRUE(Plan(request)->guides.empty());
  request.mutable_submit_job()->mutable_params()->set_first_frame(1);
  v1::SequenceCamera& camera = *request.mutable_submit_job()->mutable_sequence()->mutable_cameras(1);
  for (const char* mask : {"", "/m/1.png", ""}) camera.add_masks(mask);
  for (const char* prior : {"/p/0.pfm", "", "/p/2.pfm"}) camera.add_prior(prior);
  camera.mutable_prior_format()->set_content(v1::PRIOR_CONTENT_DEPTH);
  camera.mutable_prior_format()->set_unit(1);
  const Result<PlannedJob> job = Plan(request);
  ASSERT_TRUE(job.ok()) << job.status().message();
  ASSERT_EQ(job->guides.size(), job->pictures.size());
  EXPECT_EQ(job->guides[0], (std::vector<GuideFiles>{{}, {}}));
  EXPECT_EQ(job->guides[1], (std::vector<GuideFiles>{{"/m/1.png", "", ""}, {"", "/p/2.pfm", ""}}));
  EXPECT_EQ(job->config.resolved.views[1].prior.holds, PriorFormat::Holds::kDepth);
  EXPECT_TRUE(job->config.resolved.views[1].masked);
}

v1::SubmitJob RenderRequest(int views) {
  v1::SubmitJob request;
  request.set_output_dir("/out");
  request.mutable_sequence()->set_name("line");
  request.mutable_sequence()->set_file("/in/line.json");
  *request.mutable_render()->mutable_source() = ToProto(RenderSource{"/depth", {}});
  for (const VirtualPicture& view : MakeViews(views)) *request.mutable_render()->add_views() = ToProto(view);
  return request;
}

TEST(Submission, ARenderingJobHasItsViewsInParts) {
  const Result<PlannedJob> job = PlanSubmission(RenderRequest(9), JobId(5));
  ASSERT_TRUE(job.ok()) << job.status().message();
  EXPECT_EQ(job->config.job, JobId(5));
  EXPECT_EQ(job->config.resolved.num_frames, 2);
  EXPECT_EQ(job->config.sequence_file, "/in/line.json");
  EXPECT_EQ(job->views, MakeViews(9));
  EXPECT_EQ(Summary(*job), "9 virtual views, 16x16");
}

TEST(Submission, RenderingJobsOfNothingOrNowhereAreRefused) {
  EXPECT_EQ(PlanSubmission(RenderRequest(0), JobId(5)).status().code(), ErrorCode::kInvalidArgument);
  v1::SubmitJob request = RenderRequest(2);
  request.mutable_sequence()->set_file("line.json");
  EXPECT_EQ(PlanSubmission(request, JobId(5)).status().code(), ErrorCode::kInvalidArgument);
  request = RenderRequest(2);
  request.mutable_sequence()->set_file("/in/line\n.json");  // workers would refuse it
  EXPECT_EQ(PlanSubmission(request, JobId(5)).status().code(), ErrorCode::kInvalidArgument);
  request = RenderRequest(2);
  request.mutable_render()->mutable_source()->set_depth_dir("");
  EXPECT_EQ(PlanSubmission(request, JobId(5)).status().code(), ErrorCode::kInvalidArgument);
}

TEST(Submission, OutputFoldersHaveOneSpelling) {
  for (const char* spelling : {"/out/a", "/out/a/", "/out//a/.", "/out/b/../a"}) {
    EXPECT_EQ(Plan(SubmitRequest(2, spelling))->config.output_dir, "/out/a") << spelling;
  }
  for (const char* refused : {"", "out", "/", "//", "/a/.."}) {
    EXPECT_EQ(Plan(SubmitRequest(2, refused)).status().code(), ErrorCode::kInvalidArgument) << refused;
  }
}

TEST(Submission, AJobThatKeepsItsResultsHasNoFolder) {
  v1::Envelope request = SubmitRequest(2, "");
  EXPECT_FALSE(Plan(request).ok());
  request.mutable_submit_job()->set_keeps_results(true);
  const Result<PlannedJob> job = Plan(request);
  ASSERT_TRUE(job.ok()) << job.status().message();
  EXPECT_TRUE(job->config.keeps_results);
  EXPECT_EQ(job->config.output_dir, "");
  request.mutable_submit_job()->set_output_dir("/out");
  EXPECT_EQ(Plan(request).status().code(), ErrorCode::kInvalidArgument);
}

TEST(Submission, UploadsAreThoseOfTheJobsFramesAndViews) {
  v1::Envelope request = SubmitRequest(3, "/out");
  v1::SubmitJob& submit = *request.mutable_submit_job();
  submit.mutable_params()->set_first_frame(1);
  submit.mutable_uploads_from()->set_endpoint("tcp://submitter:7");
  EXPECT_EQ(Plan(request).status().code(), ErrorCode::kInvalidArgument) << "pictures without digests";
  for (int c = 0; c < 3; ++c) {
    v1::UploadedFiles& files = *submit.mutable_sequence()->mutable_cameras(c)->mutable_uploads();
    files.add_images();  // frame 0 is not read
    for (int f = 1; f < 3; ++f) {
      v1::UploadedFile& image = *files.add_images();
      image.mutable_file()->set_sha256(std::string(32, static_cast<char>('a' + 3 * c + f)));
      image.mutable_file()->set_bytes(100);
      image.set_artifact_digest(std::string(32, 'z'));
    }
  }
  const Result<PlannedJob> job = Plan(request);
  ASSERT_TRUE(job.ok()) << job.status().message();
  EXPECT_EQ(job->uploads_from, (ArtifactLocation{"tcp://submitter:7", ""}));
  ASSERT_EQ(job->uploads.size(), 3U);
  ASSERT_EQ(job->uploads[2].size(), 2U);
  EXPECT_EQ(job->uploads[2][0].picture.file.sha256[0], 'a' + 7);
  EXPECT_FALSE(job->uploads[2][0].mask.has_value());
  submit.mutable_uploads_from()->set_endpoint("http://submitter");
  EXPECT_FALSE(Plan(request).ok());
  submit.mutable_uploads_from()->set_endpoint("tcp://submitter:7");
  submit.mutable_uploads_from()->set_public_key(std::string(40, '"'));
  EXPECT_FALSE(Plan(request).ok());
}

}  // namespace
}  // namespace depthfarm
