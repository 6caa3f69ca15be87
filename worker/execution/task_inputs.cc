#include "worker/execution/task_inputs.h"

#include <chrono>
#include <optional>
#include <type_traits>
#include <utility>

#include "worker/confidence/confidence_codec.h"
#include "worker/estimation/label_field_codec.h"
#include "worker/execution/fetch_once.h"
#include "worker/refinement/refined_view_codec.h"
#include "worker/segmentation/analysis_codec.h"

namespace depthfarm {
namespace {

bool IsAnalysis(InputRole role) {
  return role == InputRole::kAnalysis || role == InputRole::kPreviousAnalysis || role == InputRole::kIAnalysis;
}

bool IsRefined(InputRole role) {
  return role == InputRole::kRefined || role == InputRole::kPreviousRefined || role == InputRole::kIRefined;
}

bool IsOfView(InputRole role) { return IsAnalysis(role) || IsRefined(role) || role == InputRole::kConfidence; }

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
    case InputRole::kPreviousRefined:
      return "previous refined depth";
    case InputRole::kIRefined:
      return "I frame refined depth";
    case InputRole::kRefined:
      return "refined depth";
    case InputRole::kConfidence:
      return "confidence";
  }
  return "unknown";
}

template <typename T>
Result<std::shared_ptr<const T>> Decode(const std::string& bytes) {
  Result<T> decoded = [&] {
    if constexpr (std::is_same_v<T, ViewAnalysis>) {
      return DecodeAnalysis(bytes);
    } else if constexpr (std::is_same_v<T, LabelField>) {
      return DecodeLabelField(bytes);
    } else if constexpr (std::is_same_v<T, ConfidenceMap>) {
      return DecodeConfidence(bytes);
    } else {
      return DecodeRefinedView(bytes);
    }
  }();
  if (!decoded.ok()) return decoded.status();
  return std::make_shared<const T>(std::move(*decoded));
}

}  // namespace

Status TaskInputs::Load(const TaskSpec& spec, int num_views) {
  num_views_ = num_views;
  Status failure;
  for (const TaskInput& input : spec.inputs) {
    if (stop_.stop_requested()) return Cancelled();
    if (IsOfView(input.role) && (input.view < 0 || input.view >= num_views)) {
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
  Loaded loaded{.role = input.role,
                .view = input.view,
                .analysis = nullptr,
                .labels = nullptr,
                .refined = nullptr,
                .confidence = nullptr};
  if (IsAnalysis(input.role)) {
    DEPTHFARM_ASSIGN_OR_RETURN(loaded.analysis, FindOrFetch<ViewAnalysis>(input));
  } else if (input.role == InputRole::kConfidence) {
    DEPTHFARM_ASSIGN_OR_RETURN(loaded.confidence, FindOrFetch<ConfidenceMap>(input));
  } else if (IsRefined(input.role)) {
    DEPTHFARM_ASSIGN_OR_RETURN(loaded.refined, FindOrFetch<RefinedView>(input));
  } else {
    DEPTHFARM_ASSIGN_OR_RETURN(loaded.labels, FindOrFetch<LabelField>(input));
  }
  loaded_.push_back(std::move(loaded));
  return {};
}

template <typename T>
Result<std::shared_ptr<const T>> TaskInputs::FindOrFetch(const TaskInput& input) {
  if (auto here = Find<T>(input.artifact.key); here != nullptr) return here;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, Fetch(input));
  DEPTHFARM_ASSIGN_OR_RETURN(auto decoded, Decode<T>(bytes));
  cache_.Put(input.artifact.key, decoded);
  return decoded;
}

Result<std::string> TaskInputs::Fetch(const TaskInput& input) {
  const auto start = std::chrono::steady_clock::now();
  Result<Fetched> fetched = FetchOnce(store_, fetcher_, input, stop_);
  fetch_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!fetched.ok()) return fetched.status();
  fetched_bytes_ += fetched->fetched_bytes;
  return std::move(fetched->artifact);
}

template <typename T>
std::shared_ptr<const T> TaskInputs::Find(const ArtifactKey& key) {
  if (auto cached = cache_.Find<T>(key); cached != nullptr) return cached;
  const Result<std::string> bytes = store_.Get(key);
  if (!bytes.ok()) return nullptr;
  auto decoded = Decode<T>(*bytes);
  if (!decoded.ok()) {
    store_.Drop(key);
    return nullptr;
  }
  cache_.Put(key, *decoded);
  return *decoded;
}

template std::shared_ptr<const ViewAnalysis> TaskInputs::Find(const ArtifactKey&);
template std::shared_ptr<const LabelField> TaskInputs::Find(const ArtifactKey&);
template std::shared_ptr<const RefinedView> TaskInputs::Find(const ArtifactKey&);
template std::shared_ptr<const ConfidenceMap> TaskInputs::Find(const ArtifactKey&);

FrameAnalysis TaskInputs::ListedAnalyses(InputRole role) const {
  FrameAnalysis analyses(static_cast<std::size_t>(num_views_));
  for (const Loaded& loaded : loaded_)
    if (loaded.role == role) analyses[static_cast<std::size_t>(loaded.view)] = loaded.analysis;
  return analyses;
}

FrameRefinement TaskInputs::ListedRefined(InputRole role) const {
  FrameRefinement refined(static_cast<std::size_t>(num_views_));
  for (const Loaded& loaded : loaded_)
    if (loaded.role == role) refined[static_cast<std::size_t>(loaded.view)] = loaded.refined;
  return refined;
}

std::vector<std::shared_ptr<const ConfidenceMap>> TaskInputs::ListedConfidence() const {
  std::vector<std::shared_ptr<const ConfidenceMap>> maps(static_cast<std::size_t>(num_views_));
  for (const Loaded& loaded : loaded_)
    if (loaded.role == InputRole::kConfidence) maps[static_cast<std::size_t>(loaded.view)] = loaded.confidence;
  return maps;
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
