#include "common/wire/job_wire.h"

#include <limits>
#include <set>
#include <string>
#include <utility>

#include "common/wire/bounds.h"
#include "common/wire/render_wire.h"
#include "common/wire/sequence_wire.h"

namespace depthfarm {
namespace {

constexpr int kMaxInt = std::numeric_limits<int>::max();
constexpr int kMaxSide = 32768;

Result<DepthRange> RangeFromProto(const std::string& field, const v1::DepthRange& proto) {
  DEPTHFARM_RETURN_IF_ERROR(CheckFinite(field, proto.z_near()));
  DEPTHFARM_RETURN_IF_ERROR(CheckFinite(field, proto.z_far()));
  if (!(proto.z_near() > 0 && proto.z_near() < proto.z_far())) {
    return InvalidArgument(field + " is " + std::to_string(proto.z_near()) + " to " + std::to_string(proto.z_far()) +
                           ", expected 0 < near < far");
  }
  return DepthRange{proto.z_near(), proto.z_far()};
}

using Indices = google::protobuf::RepeatedField<std::uint32_t>;

Result<std::vector<int>> OtherViewsFromProto(const std::string& field, const Indices& proto, int view, int num_views,
                                             int most) {
  DEPTHFARM_RETURN_IF_ERROR(CheckCount(field, proto.size(), most));
  if (proto.empty()) return InvalidArgument(field + " is empty, expected at least one view");
  std::vector<int> others;
  std::set<int> distinct = {view};
  for (const std::uint32_t index : proto) {
    DEPTHFARM_ASSIGN_OR_RETURN(const int other, BoundedInt(field, index, num_views - 1));
    if (!distinct.insert(other).second) {
      return InvalidArgument(field + " names view " + std::to_string(other) + " twice, or the view itself");
    }
    others.push_back(other);
  }
  return others;
}

Result<JobView> ViewFromProto(const v1::JobView& proto, int index, int num_views, int downscale) {
  JobView view;
  DEPTHFARM_ASSIGN_OR_RETURN(view.camera, FromProto(proto.camera()));
  const std::string name = "view '" + view.camera.name + "': ";
  DEPTHFARM_ASSIGN_OR_RETURN(view.source_width, BoundedInt(name + "source width", proto.source_width(), kMaxSide));
  DEPTHFARM_ASSIGN_OR_RETURN(view.source_height, BoundedInt(name + "source height", proto.source_height(), kMaxSide));
  if (view.source_width / downscale != view.camera.width || view.source_height / downscale != view.camera.height) {
    return InvalidArgument(name + "source size " + std::to_string(view.source_width) + "x" +
                           std::to_string(view.source_height) + " does not fit its camera at downscale " +
                           std::to_string(downscale));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(view.format, FromProto(proto.format()));
  DEPTHFARM_ASSIGN_OR_RETURN(view.segments,
                             BoundedInt(name + "segments", proto.segments(), view.camera.width * view.camera.height));
  if (view.segments < 1) return InvalidArgument(name + "segments is 0, expected at least 1");
  DEPTHFARM_ASSIGN_OR_RETURN(view.own_range, RangeFromProto(name + "own range", proto.own_range()));
  DEPTHFARM_ASSIGN_OR_RETURN(
      view.neighbours, OtherViewsFromProto(name + "neighbours", proto.neighbours(), index, num_views, num_views - 1));
  DEPTHFARM_ASSIGN_OR_RETURN(view.compared,
                             OtherViewsFromProto(name + "compared", proto.compared(), index, num_views, kMostCompared));
  DEPTHFARM_ASSIGN_OR_RETURN(view.prior, FromProto(proto.prior_format()));
  view.masked = proto.masked();
  return view;
}

Result<std::vector<JobView>> ViewsFromProto(const v1::JobConfig& proto, int downscale) {
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("views", proto.views_size(), kMaxViews));
  if (proto.views_size() < 2) return InvalidArgument("a job has at least two views");
  std::vector<JobView> views;
  std::set<std::string> names;
  for (int i = 0; i < proto.views_size(); ++i) {
    DEPTHFARM_ASSIGN_OR_RETURN(JobView view, ViewFromProto(proto.views(i), i, proto.views_size(), downscale));
    if (!names.insert(view.camera.name).second) {
      return InvalidArgument("view '" + view.camera.name + "' is listed twice");
    }
    views.push_back(std::move(view));
  }
  return views;
}

Result<int> BlocksFromProto(const std::string& field, std::uint32_t value, int levels) {
  DEPTHFARM_ASSIGN_OR_RETURN(const int blocks, BoundedInt(field, value, levels));
  if (blocks < 1) return InvalidArgument(field + " is 0, expected at least 1");
  return blocks;
}

// The job's frames as first_frame and end_frame state them.
Result<int> FramesFromProto(const v1::JobConfig& proto, const EstimationParams& params) {
  DEPTHFARM_ASSIGN_OR_RETURN(const int frames, BoundedInt("number of frames", proto.num_frames(), kMaxFrames));
  if (frames < 1 || params.end_frame - params.first_frame != frames) {
    return InvalidArgument("number of frames is " + std::to_string(frames) + ", frames are " +
                           std::to_string(params.first_frame) + ":" + std::to_string(params.end_frame));
  }
  return frames;
}

Result<ResolvedJob> ResolvedFromProto(const v1::JobConfig& proto) {
  ResolvedJob job;
  DEPTHFARM_ASSIGN_OR_RETURN(job.params, FromProto(proto.params()));
  const EstimationParams& params = job.params;
  if (params.gop < 1) return InvalidArgument("gop of a resolved job is 0, expected at least 1");
  DEPTHFARM_ASSIGN_OR_RETURN(job.reference, FromProto(proto.reference()));
  DEPTHFARM_RETURN_IF_ERROR(DepthLevels::Create(job.reference, params.z_near, params.z_far, params.levels).status());
  DEPTHFARM_ASSIGN_OR_RETURN(job.views, ViewsFromProto(proto, params.downscale));
  DEPTHFARM_ASSIGN_OR_RETURN(job.num_frames, FramesFromProto(proto, params));
  DEPTHFARM_ASSIGN_OR_RETURN(job.level_blocks_i,
                             BlocksFromProto("level blocks of I frames", proto.level_blocks_i(), params.levels));
  DEPTHFARM_ASSIGN_OR_RETURN(job.level_blocks_p,
                             BlocksFromProto("level blocks of P frames", proto.level_blocks_p(), params.levels));
  return job;
}

}  // namespace

v1::EstimationParams ToProto(const EstimationParams& params) {
  v1::EstimationParams proto;
  proto.set_segments(static_cast<std::uint32_t>(params.segments));
  proto.set_segment_pixels(static_cast<std::uint32_t>(params.segment_pixels));
  proto.set_levels(static_cast<std::uint32_t>(params.levels));
  proto.set_z_near(params.z_near);
  proto.set_z_far(params.z_far);
  proto.set_smoothing(params.smoothing);
  proto.set_matching_window(static_cast<std::uint32_t>(params.matching_window));
  proto.set_matching_offset(params.matching_offset);
  proto.set_uniqueness(static_cast<std::uint32_t>(params.uniqueness));
  proto.set_snic_compactness(params.snic_compactness);
  proto.set_gop(static_cast<std::uint32_t>(params.gop));
  proto.set_one_gop(params.gop == 0);
  proto.set_anchor(params.anchor == Anchor::kShared ? v1::ANCHOR_SHARED : v1::ANCHOR_GOP);
  proto.set_p_threshold(static_cast<std::uint32_t>(params.p_threshold));
  proto.set_i_threshold(static_cast<std::uint32_t>(params.i_threshold));
  proto.set_level_blocks(static_cast<std::uint32_t>(params.level_blocks));
  proto.set_partition(params.partition == Partition::kContiguous ? v1::PARTITION_CONTIGUOUS
                                                                 : v1::PARTITION_INTERLEAVED);
  proto.set_search(params.search == Search::kFull ? v1::SEARCH_FULL : v1::SEARCH_SPARSE);
  proto.set_max_sweeps(static_cast<std::uint32_t>(params.max_sweeps));
  proto.set_neighbours(static_cast<std::uint32_t>(params.neighbours));
  proto.set_refine_rounds(static_cast<std::uint32_t>(params.refine_rounds));
  proto.set_choice_rounds(static_cast<std::uint32_t>(params.choice_rounds));
  proto.set_compared(static_cast<std::uint32_t>(params.compared));
  proto.set_confidence(params.confidence);
  proto.set_holes(params.holes);
  proto.set_output_format(static_cast<v1::DepthFormat>(params.output_format));
  proto.set_downscale(static_cast<std::uint32_t>(params.downscale));
  for (const std::string& view : params.views) proto.add_views(view);
  proto.set_first_frame(static_cast<std::uint32_t>(params.first_frame));
  proto.set_end_frame(params.end_frame);
  return proto;
}

Result<EstimationParams> FromProto(const v1::EstimationParams& proto) {
  EstimationParams params;
  const auto read = [](const char* field, std::uint32_t value, int& target) -> Status {
    DEPTHFARM_ASSIGN_OR_RETURN(target, BoundedInt(field, value, kMaxInt));
    return {};
  };
  DEPTHFARM_RETURN_IF_ERROR(read("segments", proto.segments(), params.segments));
  DEPTHFARM_RETURN_IF_ERROR(read("segment-pixels", proto.segment_pixels(), params.segment_pixels));
  DEPTHFARM_RETURN_IF_ERROR(read("levels", proto.levels(), params.levels));
  params.z_near = proto.z_near();
  params.z_far = proto.z_far();
  params.smoothing = proto.smoothing();
  DEPTHFARM_RETURN_IF_ERROR(read("matching-window", proto.matching_window(), params.matching_window));
  params.matching_offset = proto.matching_offset();
  DEPTHFARM_RETURN_IF_ERROR(read("uniqueness", proto.uniqueness(), params.uniqueness));
  params.snic_compactness = proto.snic_compactness();
  DEPTHFARM_RETURN_IF_ERROR(read("gop", proto.gop(), params.gop));
  if (proto.one_gop() != (params.gop == 0)) {
    return InvalidArgument("gop is " + std::to_string(params.gop) + (proto.one_gop() ? " and" : " and not") +
                           " one for all frames, expected at least 1 or that");
  }
  if (proto.anchor() != v1::ANCHOR_GOP && proto.anchor() != v1::ANCHOR_SHARED) {
    return InvalidArgument("anchor is " + std::to_string(proto.anchor()) + ", expected gop or shared");
  }
  params.anchor = proto.anchor() == v1::ANCHOR_SHARED ? Anchor::kShared : Anchor::kGop;
  DEPTHFARM_RETURN_IF_ERROR(read("p-threshold", proto.p_threshold(), params.p_threshold));
  DEPTHFARM_RETURN_IF_ERROR(read("i-threshold", proto.i_threshold(), params.i_threshold));
  DEPTHFARM_RETURN_IF_ERROR(read("level-blocks", proto.level_blocks(), params.level_blocks));
  if (proto.partition() != v1::PARTITION_CONTIGUOUS && proto.partition() != v1::PARTITION_INTERLEAVED) {
    return InvalidArgument("partition is " + std::to_string(proto.partition()) + ", expected blocks or interleaved");
  }
  params.partition = proto.partition() == v1::PARTITION_CONTIGUOUS ? Partition::kContiguous : Partition::kInterleaved;
  if (proto.search() != v1::SEARCH_FULL && proto.search() != v1::SEARCH_SPARSE) {
    return InvalidArgument("search is " + std::to_string(proto.search()) + ", expected sparse or full");
  }
  params.search = proto.search() == v1::SEARCH_FULL ? Search::kFull : Search::kSparse;
  DEPTHFARM_RETURN_IF_ERROR(read("sweeps", proto.max_sweeps(), params.max_sweeps));
  DEPTHFARM_RETURN_IF_ERROR(read("neighbors", proto.neighbours(), params.neighbours));
  DEPTHFARM_RETURN_IF_ERROR(read("refine", proto.refine_rounds(), params.refine_rounds));
  DEPTHFARM_RETURN_IF_ERROR(read("choice-rounds", proto.choice_rounds(), params.choice_rounds));
  DEPTHFARM_RETURN_IF_ERROR(read("compared", proto.compared(), params.compared));
  params.confidence = proto.confidence();
  params.holes = proto.holes();
  if (!v1::DepthFormat_IsValid(proto.output_format()))
    return InvalidArgument("output-format is " + std::to_string(proto.output_format()) + ", expected " +
                           std::string(DepthFormatNames()));
  params.output_format = static_cast<DepthFormat>(proto.output_format());
  DEPTHFARM_RETURN_IF_ERROR(read("downscale", proto.downscale(), params.downscale));
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("views", proto.views_size(), kMaxViews));
  for (const std::string& view : proto.views()) {
    DEPTHFARM_RETURN_IF_ERROR(CheckFileName("views: name", view));
    params.views.push_back(view);
  }
  DEPTHFARM_RETURN_IF_ERROR(read("frames: first", proto.first_frame(), params.first_frame));
  params.end_frame = proto.end_frame();
  DEPTHFARM_RETURN_IF_ERROR(params.Validate());
  return params;
}

v1::JobConfig ToProto(const JobConfig& config) {
  v1::JobConfig proto;
  const ResolvedJob& job = config.resolved;
  proto.set_job_id(config.job.value());
  proto.set_algorithm_version(config.algorithm_version);
  proto.set_num_frames(static_cast<std::uint32_t>(job.num_frames));
  proto.set_output_dir(config.output_dir);
  proto.set_keeps_results(config.keeps_results);
  proto.set_claim(config.claim);
  proto.set_sequence_name(config.sequence_name);
  proto.set_sequence_file(config.sequence_file);
  if (config.render) {
    *proto.mutable_render() = ToProto(*config.render);
    return proto;
  }
  *proto.mutable_params() = ToProto(job.params);
  *proto.mutable_reference() = ToProto(job.reference);
  for (const JobView& view : job.views) {
    v1::JobView* added = proto.add_views();
    *added->mutable_camera() = ToProto(view.camera);
    added->set_source_width(static_cast<std::uint32_t>(view.source_width));
    added->set_source_height(static_cast<std::uint32_t>(view.source_height));
    *added->mutable_format() = ToProto(view.format);
    *added->mutable_prior_format() = ToProto(view.prior);
    added->set_masked(view.masked);
    added->set_segments(static_cast<std::uint32_t>(view.segments));
    added->mutable_own_range()->set_z_near(view.own_range.z_near);
    added->mutable_own_range()->set_z_far(view.own_range.z_far);
    for (const int neighbour : view.neighbours) added->add_neighbours(static_cast<std::uint32_t>(neighbour));
    for (const int other : view.compared) added->add_compared(static_cast<std::uint32_t>(other));
  }
  proto.set_level_blocks_i(static_cast<std::uint32_t>(job.level_blocks_i));
  proto.set_level_blocks_p(static_cast<std::uint32_t>(job.level_blocks_p));
  return proto;
}

Result<JobConfig> FromProto(const v1::JobConfig& proto) {
  JobConfig config;
  config.job = JobId(proto.job_id());
  config.algorithm_version = proto.algorithm_version();
  if (proto.has_render()) {
    DEPTHFARM_ASSIGN_OR_RETURN(config.render, FromProto(proto.render()));
    DEPTHFARM_ASSIGN_OR_RETURN(const int parts, BoundedInt("number of parts", proto.num_frames(), kMaxVirtualPictures));
    if (parts < 1) return InvalidArgument("number of parts is 0, expected at least 1");
    DEPTHFARM_RETURN_IF_ERROR(CheckAbsolutePath("sequence file", proto.sequence_file()));
    config.resolved = PartsOnly(parts);
  } else {
    DEPTHFARM_ASSIGN_OR_RETURN(config.resolved, ResolvedFromProto(proto));
  }
  config.keeps_results = proto.keeps_results();
  config.claim = proto.claim();
  if (!config.keeps_results) {
    DEPTHFARM_RETURN_IF_ERROR(CheckAbsolutePath("output folder", proto.output_dir()));
  } else if (!proto.output_dir().empty() || config.render) {
    return InvalidArgument("a job that keeps its results has no output folder and estimates depth");
  }
  config.output_dir = proto.output_dir();
  DEPTHFARM_RETURN_IF_ERROR(CheckText("sequence name", proto.sequence_name(), kMaxNameBytes));
  config.sequence_name = proto.sequence_name();
  DEPTHFARM_RETURN_IF_ERROR(CheckText("sequence file", proto.sequence_file(), kMaxPathBytes));
  config.sequence_file = proto.sequence_file();
  return config;
}

}  // namespace depthfarm
