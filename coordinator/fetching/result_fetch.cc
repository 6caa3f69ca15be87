#include "coordinator/fetching/result_fetch.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "common/digest/sha256.h"
#include "common/files/file_bundle.h"
#include "common/job/job_manifest.h"
#include "common/wire/job_wire.h"
#include "common/wire/results_wire.h"

namespace depthfarm {
namespace {

constexpr std::size_t kMostRanges = 20;

// Of the job as it is defined, not of this run of it: the same job, submitted again, goes on in the same folder.
std::string IdentityOf(const JobConfig& config) {
  JobConfig job = config;
  job.job = JobId();
  job.sequence_file.clear();
  job.claim = 0;
  return Hex(Sha256(ToProto(job).SerializeAsString()));
}

std::uint64_t BundleBytes(const std::vector<std::string>& names, const std::vector<FileDigest>& files) {
  std::vector<BundledFile> empty;
  for (const std::string& name : names) empty.push_back({name, {}});
  std::uint64_t bytes = EncodeFileBundle(empty).size();
  for (const FileDigest& file : files) bytes += file.bytes;
  return bytes;
}

}  // namespace

Result<std::unique_ptr<ResultFetch>> ResultFetch::Open(Client& client, ArtifactClient& peers, std::uint64_t job_id,
                                                       const std::string& dir) {
  std::unique_ptr<ResultFetch> fetch(new ResultFetch(client, peers, job_id));
  DEPTHFARM_ASSIGN_OR_RETURN(const v1::Results first, client.GetResults(job_id, 0));
  DEPTHFARM_ASSIGN_OR_RETURN(fetch->config_, FromProto(first.job()));
  fetch->frames_.resize(static_cast<std::size_t>(fetch->num_frames()));
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(dir, error);
  if (dir.empty() || error) return InvalidArgument("output folder '" + dir + "': is none");
  Result<FetchedFolder> folder = FetchedFolder::Open(absolute.lexically_normal(), IdentityOf(fetch->config_));
  // Not for want of a coordinator.
  if (folder.status().code() == ErrorCode::kUnavailable) return Internal(folder.status().message());
  if (!folder.ok()) return folder.status();
  fetch->folder_ = std::move(*folder);
  return fetch;
}

Status ResultFetch::Take(const v1::Results& page) {
  const std::size_t num_files = FilesOfFrame(config_.resolved, 0).size();
  for (const v1::FrameResult& proto : page.frames()) {
    DEPTHFARM_ASSIGN_OR_RETURN(FrameResult result, FromProto(proto));
    if (result.frame >= num_frames() || result.files.size() != num_files ||
        result.picture_digests.size() != config_.resolved.views.size()) {
      return Corrupt("results of job " + std::to_string(job_id_) + ": frame " + std::to_string(result.frame) + " has " +
                     std::to_string(result.files.size()) + " files and " +
                     std::to_string(result.picture_digests.size()) + " pictures, expected " +
                     std::to_string(num_files) + " and " + std::to_string(config_.resolved.views.size()) +
                     " of each frame below " + std::to_string(num_frames()));
    }
    Frame& frame = frames_[static_cast<std::size_t>(result.frame)];
    if (!frame.here) frame.result = std::move(result);
  }
  return {};
}

Status ResultFetch::AskWhatIsDone() {
  const auto first = std::ranges::find_if(frames_, [](const Frame& frame) { return !frame.here; });
  auto next = static_cast<std::uint32_t>(first - frames_.begin());
  for (Frame& frame : frames_) {
    if (!frame.here) frame.result.reset();  // may have been lost since
  }
  bool first_page = true;
  do {
    DEPTHFARM_ASSIGN_OR_RETURN(const v1::Results page, client_.GetResults(job_id_, next));
    if (first_page) {  // a job that has ended by now has all its frames in the pages from here on
      state_ = page.state();
      job_error_ = FromProto(page.error());
      first_page = false;
    }
    DEPTHFARM_RETURN_IF_ERROR(Take(page));
    if (page.next_frame() <= next && next < frames_.size())
      return Corrupt("results of job " + std::to_string(job_id_) + ": the list does not go on after frame " +
                     std::to_string(next));
    next = page.next_frame();
  } while (next < frames_.size());
  return {};
}

Result<std::string> ResultFetch::ManifestText() const {
  std::vector<OutputFile> files;
  std::vector<ContentDigest> pictures;
  for (const Frame& frame : frames_) {
    const std::vector<std::string> names = FilesOfFrame(config_.resolved, frame.result->frame);
    for (std::size_t i = 0; i < names.size(); ++i)
      files.push_back({names[i], frame.result->files[i].sha256, frame.result->files[i].bytes});
    pictures.insert(pictures.end(), frame.result->picture_digests.begin(), frame.result->picture_digests.end());
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest, ManifestOf(config_, files, pictures));
  return FormatDepthManifest(manifest);
}

Status ResultFetch::OfFolder(Status status) {
  folder_failed_ = folder_failed_ || !status.ok();
  return status;
}

Status ResultFetch::Round(const std::stop_token& stop, const std::function<void()>& on_frame) {
  if (complete_) return {};
  DEPTHFARM_RETURN_IF_ERROR(AskWhatIsDone());
  const bool all_done = std::ranges::all_of(frames_, [](const Frame& frame) { return frame.result.has_value(); });
  if (folder_->finished()) {
    bool same = false;
    if (all_done) {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, ManifestText());
      same = text == *folder_->finished();
    }
    if (!same) {
      return InvalidArgument(folder_->path().string() +
                             ": holds the depth of another job (its depth.json differs): choose another folder");
    }
  }
  lost_.clear();
  for (Frame& frame : frames_) {
    if (stop.stop_requested()) return Cancelled();
    if (frame.here || !frame.result) continue;
    DEPTHFARM_RETURN_IF_ERROR(FetchFrame(frame, stop));
    if (!frame.here) continue;
    ++frames_here_;
    on_frame();
  }
  if (frames_here_ < num_frames()) return {};
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, ManifestText());
  DEPTHFARM_RETURN_IF_ERROR(OfFolder(folder_->Finish(text)));
  complete_ = true;
  return {};
}

Status ResultFetch::FetchFrame(Frame& frame, const std::stop_token& stop) {
  const FrameResult& result = *frame.result;
  const std::vector<std::string> names = FilesOfFrame(config_.resolved, result.frame);
  bool all_here = true;
  for (std::size_t i = 0; i < names.size() && all_here; ++i) all_here = folder_->Has(names[i], result.files[i]);
  if (all_here) {
    frame.here = true;
    return {};
  }
  const auto lose = [&](const std::string& reason) {
    lost_[InSequence(result.frame)] = reason;
    return Status();
  };
  if (result.locations.empty()) return lose("no worker holds it any more");
  if (result.bundle.stored_bytes != BundleBytes(names, result.files))
    return lose("its " + std::to_string(result.bundle.stored_bytes) + " bytes are not those of its files");
  const Result<std::string> bundle = peers_.Fetch(result.bundle, result.locations, stop);
  if (!bundle.ok())
    return bundle.status().code() == ErrorCode::kCancelled ? bundle.status() : lose(bundle.status().message());
  const Status written = WriteFrame(result, *bundle);
  if (!written.ok()) return written.code() == ErrorCode::kCorrupt ? lose(written.message()) : OfFolder(written);
  frame.here = true;
  ++frames_fetched_;
  bytes_fetched_ += bundle->size();
  return {};
}

Status ResultFetch::WriteFrame(const FrameResult& result, const std::string& bundle) {
  const std::vector<std::string> names = FilesOfFrame(config_.resolved, result.frame);
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<BundledFile> files, DecodeFileBundle(bundle));
  if (files.size() != names.size()) return Corrupt("has " + std::to_string(files.size()) + " files");
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (files[i].path != names[i]) return Corrupt("has '" + std::string(files[i].path) + "' for " + names[i]);
    if (Sha256(files[i].bytes) != result.files[i].sha256) return Corrupt(names[i] + " has another digest");
  }
  for (const BundledFile& file : files) DEPTHFARM_RETURN_IF_ERROR(folder_->Write(std::string(file.path), file.bytes));
  return {};
}

std::vector<int> ResultFetch::not_done() const {
  std::vector<int> numbers;
  for (std::size_t frame = 0; frame < frames_.size(); ++frame) {
    if (!frames_[frame].result) numbers.push_back(InSequence(static_cast<int>(frame)));
  }
  return numbers;
}

std::string FormatRanges(const std::vector<int>& numbers) {
  std::string text;
  std::size_t ranges = 0;
  for (std::size_t begin = 0; begin < numbers.size(); ++ranges) {
    if (ranges == kMostRanges) return text + " and " + std::to_string(numbers.size() - begin) + " more";
    std::size_t end = begin;
    while (end + 1 < numbers.size() && numbers[end + 1] == numbers[end] + 1) ++end;
    text += (text.empty() ? "" : ", ") + std::to_string(numbers[begin]);
    if (end > begin) text += (end == begin + 1 ? ", " : " to ") + std::to_string(numbers[end]);
    begin = end + 1;
  }
  return text;
}

}  // namespace depthfarm
