#include "worker/execution/task_inputs.h"

#include <chrono>
#include <optional>
#include <utility>

#include "worker/estimation/label_field_codec.h"
#include "worker/segmentation/analysis_codec.h"

namespace depthfarm {
namespace {

bool IsAnalysis(InputRole role) {
  return role == InputRole::kAnalysis || role == InputRole::kPreviousAnalysis || role == InputRole::kIAnalysis;
}

std::string RoleName(InputRole role) {
  switch (role) {
    case InputRole::kAnalysis:
      return "analysis";
    case InputRole::kPreviousAnalysis:
      return "previous analysis";
    case InputRole::kPreviousLabels:
      return "previous labels";
    case InputRole::kIAnalysis:
      return "I frame analysis";
    case InputRole::kILabels:
      return "I frame labels";
    case InputRole::kLabels:
      return "labels";
  }
  return "unknown";
}

template <typename Object>
Result<std::shared_ptr<const Object>> Shared(Result<Object> decoded) {
  if (!decoded.ok()) return decoded.status();
  return std::make_shared<const Object>(std::move(*decoded));
}

}  // namespace

Status TaskInputs::Load(const TaskSpec& spec, int num_views) {
  num_views_ = num_views;
  Status failure;
  for (const TaskInput& input : spec.inputs) {
    if (stop_.stop_requested()) return Cancelled();
    if (IsAnalysis(input.role) && (input.view < 0 || input.view >= num_views)) {
      return InvalidArgument("input of view " + std::to_string(input.view) + " of a job with " +
                             std::to_string(num_views) + " views");
    }
    const Status loaded = LoadOne(input);
    if (loaded.code() == ErrorCode::kCancelled) return loaded;
    if (loaded.ok()) continue;
    missing_.push_back(input.artifact.key);
    if (failure.ok()) failure = loaded.WithContext(RoleName(input.role) + " of view " + std::to_string(input.view));
  }
  if (failure.ok()) return {};
  return {ErrorCode::kUnavailable, std::to_string(missing_.size()) + " of " + std::to_string(spec.inputs.size()) +
                                       " inputs are missing, the first: " + failure.message()};
}

Status TaskInputs::LoadOne(const TaskInput& input) {
  const ArtifactKey& key = input.artifact.key;
  // Another digest under the same key is a violation of determinism that the coordinator reports; all tasks of the job
  // must still see the same bytes.
  const std::optional<ArtifactInfo> held = store_.Find(key);
  if (held.has_value() && held->content_digest != input.artifact.content_digest) {
    cache_.Erase(key);
    store_.Drop(key);
  }
  Loaded loaded{.role = input.role, .view = input.view, .analysis = nullptr, .labels = nullptr};
  if (IsAnalysis(input.role)) {
    loaded.analysis = FindAnalysis(key);
    if (loaded.analysis == nullptr) {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, FetchAndStore(input));
      DEPTHFARM_ASSIGN_OR_RETURN(loaded.analysis, Shared(DecodeAnalysis(bytes)));
      cache_.Put(key, loaded.analysis);
    }
  } else {
    loaded.labels = FindLabels(key);
    if (loaded.labels == nullptr) {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, FetchAndStore(input));
      DEPTHFARM_ASSIGN_OR_RETURN(loaded.labels, Shared(DecodeLabelField(bytes)));
      cache_.Put(key, loaded.labels);
    }
  }
  loaded_.push_back(std::move(loaded));
  return {};
}

Result<std::string> TaskInputs::FetchAndStore(const TaskInput& input) {
  const auto start = std::chrono::steady_clock::now();
  Result<std::string> bytes = fetcher_.Fetch(input, stop_);
  fetch_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!bytes.ok()) return bytes;
  fetched_bytes_ += bytes->size();
  // A store too full to keep a copy is no reason to fail: the task has what it needs.
  (void)store_.Put(input.artifact.key, *bytes).ok();
  return bytes;
}

template <typename Object>
std::shared_ptr<const Object> TaskInputs::FindInStore(const ArtifactKey& key,
                                                      Result<Object> (*decode)(std::string_view)) {
  const Result<std::string> bytes = store_.Get(key);
  if (!bytes.ok()) return nullptr;
  auto decoded = Shared(decode(*bytes));
  if (!decoded.ok()) {
    store_.Drop(key);
    return nullptr;
  }
  cache_.Put(key, *decoded);
  return *decoded;
}

std::shared_ptr<const ViewAnalysis> TaskInputs::FindAnalysis(const ArtifactKey& key) {
  auto cached = cache_.FindAnalysis(key);
  return cached != nullptr ? cached : FindInStore(key, DecodeAnalysis);
}

std::shared_ptr<const LabelField> TaskInputs::FindLabels(const ArtifactKey& key) {
  auto cached = cache_.FindLabels(key);
  return cached != nullptr ? cached : FindInStore(key, DecodeLabelField);
}

Result<FrameAnalysis> TaskInputs::Analyses(InputRole role) const {
  FrameAnalysis analyses(static_cast<std::size_t>(num_views_));
  std::size_t count = 0;
  for (const Loaded& loaded : loaded_) {
    if (loaded.role != role) continue;
    ++count;
    analyses[static_cast<std::size_t>(loaded.view)] = loaded.analysis;
  }
  bool every_view = count == analyses.size();
  for (const auto& analysis : analyses) every_view = every_view && analysis != nullptr;
  if (every_view) return analyses;
  return InvalidArgument("inputs '" + RoleName(role) + "': " + std::to_string(count) + " for " +
                         std::to_string(num_views_) + " views, expected one each");
}

Result<std::vector<std::shared_ptr<const LabelField>>> TaskInputs::Labels(InputRole role, std::size_t count) const {
  std::vector<std::shared_ptr<const LabelField>> labels;
  for (const Loaded& loaded : loaded_) {
    if (loaded.role == role) labels.push_back(loaded.labels);
  }
  if (labels.size() == count) return labels;
  return InvalidArgument("inputs '" + RoleName(role) + "': " + std::to_string(labels.size()) + ", expected " +
                         std::to_string(count));
}

}  // namespace depthfarm
