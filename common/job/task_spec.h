#ifndef DEPTHFARM_COMMON_JOB_TASK_SPEC_H_
#define DEPTHFARM_COMMON_JOB_TASK_SPEC_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/job/resolved_job.h"
#include "common/job/task.h"
#include "common/job/virtual_picture.h"

namespace depthfarm {

// A SHA-256 of bytes (content of an artifact, of a picture file, of a depth file).
using ContentDigest = std::array<std::uint8_t, 32>;

// What an input of a task is for. Inputs of a task are ordered by role, then by view.
enum class InputRole : std::uint8_t {
  kAnalysis,          // of this frame, one per view
  kPreviousAnalysis,  // of ResolvedJob::PreviousOf (P frames): Analyse, Refine: of the view; Estimate: one per view
  kPreviousLabels,    // label field of that frame
  kIAnalysis,         // of the GOP's I frame, one per view (P frames)
  kILabels,           // label field of the GOP's I frame
  kLabels,            // Merge: the two partial fields, first and second; Refine, Emit: the final one
  kPreviousRefined,   // Refine: the view's depth in that frame after the last round
  kIRefined,          // Refine: the view's depth in the GOP's I frame after the last round
  kRefined,           // Refine: depth of the round before, the view and those it is compared with; Assess: the
                      // same after the last round; Emit: of all views
  kConfidence,        // Emit: of all views
};

// Where an artifact can be fetched.
struct ArtifactLocation {
  std::string endpoint;    // ZeroMQ endpoint of a worker's artifact server
  std::string public_key;  // its CURVE public key, Z85; empty on ipc
  bool operator==(const ArtifactLocation&) const = default;
};

// An artifact that a task made or a worker holds.
struct ArtifactInfo {
  ArtifactKey key{};
  std::uint64_t stored_bytes = 0;
  ContentDigest content_digest{};
  bool operator==(const ArtifactInfo&) const = default;
};

struct TaskInput {
  ArtifactInfo artifact;  // a fetch must yield exactly these bytes
  InputRole role = InputRole::kAnalysis;
  int view = 0;  // of the analysis, refined and confidence roles
  std::vector<ArtifactLocation> locations;
  bool operator==(const TaskInput&) const = default;
};

// A depth file, a confidence file or a virtual view: written by Emit or Render, renamed into place by Commit.
struct OutputFile {
  std::string path;  // relative to DIR: "depth/cam0/0000.png", "confidence/cam0/0000.png", "views/0000.png"
  ContentDigest sha256{};
  std::uint64_t bytes = 0;
  bool operator==(const OutputFile&) const = default;
};

// What besides its picture guides the depth of a view in a frame: absolute paths, empty for none.
struct GuideFiles {
  std::string mask;
  std::string prior;
  std::string prior_confidence;
  bool operator==(const GuideFiles&) const = default;
};

// What a file holds.
struct FileDigest {
  ContentDigest sha256{};
  std::uint64_t bytes = 0;
  bool operator==(const FileDigest&) const = default;
};

// A frame of a job that keeps its results: its files are in one artifact (file_bundle.h).
struct FrameResult {
  int frame = 0;  // of the job
  ArtifactInfo bundle;
  std::vector<ArtifactLocation> locations;     // of the bundle; none: it is lost
  std::vector<FileDigest> files;               // that the bundle holds: those that FilesOfFrame names
  std::vector<ContentDigest> picture_digests;  // of the picture of each view
  bool operator==(const FrameResult&) const = default;
};

// A file that the submitter of its job serves: an artifact whose key is the SHA-256 of the file.
struct UploadedFile {
  FileDigest file;
  ContentDigest artifact_digest{};  // a fetch must yield exactly these bytes
  bool operator==(const UploadedFile&) const = default;
};

// The files of an Analyse task whose submitter serves them.
struct SourceDigests {
  UploadedFile picture;
  std::optional<UploadedFile> mask;
  std::optional<UploadedFile> prior;
  std::optional<UploadedFile> prior_confidence;
  bool operator==(const SourceDigests&) const = default;
};

// Those files, and where they are served.
struct UploadedSources {
  SourceDigests files;
  ArtifactLocation from;
  bool operator==(const UploadedSources&) const = default;
};

// All that a worker needs for a task besides its JobConfig.
struct TaskSpec {
  TaskId id;
  std::optional<ArtifactKey> output_key;  // Estimate, Merge, Refine, Assess; Emit of a job that keeps its results
  std::vector<TaskInput> inputs;
  std::optional<TaskInput> known;          // Analyse: what such a task made when it was done before; may be out of date
  std::string picture;                     // Analyse: absolute path
  GuideFiles guides;                       // Analyse
  std::optional<UploadedSources> uploads;  // Analyse: then picture and guides are names only
  std::string staging;  // Emit, Render, Commit: folder below DIR/.depthfarm-staging; not with an output key
  // Commit: of the frame; Manifest: of all frames, by frame, then view; Prepare: those that must be there already.
  std::vector<OutputFile> files;
  std::vector<ContentDigest> picture_digests;  // Manifest: of each picture, by frame, then view
  std::vector<VirtualPicture> views;           // Render: of the part; Manifest of a rendering job: all, as `files`
  bool operator==(const TaskSpec&) const = default;
};

// What a task used and found.
struct TaskStats {
  double wall_seconds = 0;
  double cpu_seconds = 0;               // user + system of the computing thread and its helpers
  std::uint64_t peak_memory_bytes = 0;  // of the process so far
  double fetch_seconds = 0;             // waiting for inputs
  std::uint64_t fetched_bytes = 0;      // from other workers
  std::uint32_t sweeps = 0;             // Estimate
  std::int64_t energy = 0;              // Estimate, Merge: E of eq. (1), less constants of the frame; energy units
  std::uint32_t nodes = 0;              // Estimate: segments with a node (not unchanged)
  std::uint32_t segments = 0;           // Analyse: actual; Estimate: of all views
  bool reused = false;                  // the artifact was there already
  // Analyse: a mask, Refine (last round): a prior was given that what the pictures tell contradicts; it changed nothing
  // or next to nothing.
  bool left_aside = false;
  bool operator==(const TaskStats&) const = default;
};

// What was logged while a task ran, for people: the last lines, each valid UTF-8 without control characters.
struct TaskLog {
  std::vector<std::string> lines;  // oldest first
  std::uint64_t left_out = 0;      // lines before those
  bool operator==(const TaskLog&) const = default;
};

// What the tasks of a job have in common. A job estimates depth, or it renders views from depth that is there; then
// `resolved` has no cameras, and its frames are the parts of the job.
struct JobConfig {
  JobId job;
  std::uint32_t algorithm_version = kAlgorithmVersion;
  ResolvedJob resolved;
  std::string output_dir;  // absolute, as the submitter sees it; empty for a job that keeps its results
  // Of this run of the job alone: says whose its output folder is. No result depends on it.
  std::uint64_t claim = 0;
  bool keeps_results = false;  // each frame's files stay one artifact of its Emit, for whoever fetches them
  std::string sequence_name;
  std::string sequence_file;
  std::optional<RenderSource> render;  // set: a rendering job
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_JOB_TASK_SPEC_H_
