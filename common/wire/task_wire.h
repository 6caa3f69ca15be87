#ifndef DEPTHFARM_COMMON_WIRE_TASK_WIRE_H_
#define DEPTHFARM_COMMON_WIRE_TASK_WIRE_H_

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "common/wire/digest_wire.h"
#include "depthfarm/v1/task.pb.h"

namespace depthfarm {

[[nodiscard]] v1::TaskKind ToProto(TaskKind kind);
[[nodiscard]] v1::TaskId ToProto(const TaskId& id);
[[nodiscard]] v1::ArtifactInfo ToProto(const ArtifactInfo& artifact);
[[nodiscard]] v1::ArtifactLocation ToProto(const ArtifactLocation& location);
[[nodiscard]] v1::OutputFile ToProto(const OutputFile& file);
[[nodiscard]] v1::TaskStats ToProto(const TaskStats& stats);
[[nodiscard]] v1::TaskLog ToProto(const TaskLog& log);
[[nodiscard]] v1::TaskSpec ToProto(const TaskSpec& spec);

// Everything from a peer is checked: kInvalidArgument names field, value and bound.
[[nodiscard]] Result<TaskKind> FromProto(v1::TaskKind kind);
[[nodiscard]] Result<TaskId> FromProto(const v1::TaskId& id);
[[nodiscard]] Result<ArtifactInfo> FromProto(const v1::ArtifactInfo& artifact);
[[nodiscard]] Result<ArtifactLocation> FromProto(const v1::ArtifactLocation& location);
// The path is "<camera>/<file>.png": two legal names, nothing that leaves the folder.
[[nodiscard]] Result<OutputFile> FromProto(const v1::OutputFile& file);
// Numbers that are not finite or negative become 0: statistics never fail a task.
[[nodiscard]] TaskStats FromProto(const v1::TaskStats& stats);
// Its last lines within the bounds, cleaned (CleanLine): a log never fails a task.
[[nodiscard]] TaskLog FromProto(const v1::TaskLog& log);
[[nodiscard]] Result<TaskSpec> FromProto(const v1::TaskSpec& spec);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_WIRE_TASK_WIRE_H_
