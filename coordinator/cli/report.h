#ifndef DEPTHFARM_COORDINATOR_CLI_REPORT_H_
#define DEPTHFARM_COORDINATOR_CLI_REPORT_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "depthfarm/v1/farm.pb.h"

namespace depthfarm {

// What the coordinator tells, for people (texts end with a newline) and for programs (JSON of the same content).

// "running", "done", "failed", "cancelled"; "unknown" for states of a newer coordinator.
[[nodiscard]] std::string JobStateName(v1::JobState state);

// "analyse", "estimate", ...; "unknown" for those of a newer coordinator.
[[nodiscard]] std::string StageName(const v1::StageStatus& stage);

[[nodiscard]] nlohmann::ordered_json JobToJson(const v1::JobStatus& job);
[[nodiscard]] nlohmann::ordered_json WorkerToJson(const v1::WorkerStatus& worker);

// What begins a job that failed anew: `depthfarm retry` on a farm that knows it and its pictures; else what was typed.
enum class BegunAnewBy { kRetry, kSameCommand };

// State, size and stages of one job.
[[nodiscard]] std::string FormatJob(const v1::JobStatus& job, BegunAnewBy anew = BegunAnewBy::kRetry);
// One line per job.
[[nodiscard]] std::string FormatJobs(const std::vector<v1::JobStatus>& jobs);
// One line per worker.
[[nodiscard]] std::string FormatWorkers(const std::vector<v1::WorkerStatus>& workers);

// One line without newline: "frame 3/6, task 41/78, 12.0 s, about 11 s left", the last as the coordinator expects it.
[[nodiscard]] std::string FormatProgress(const v1::JobStatus& job);

// "850 ms", "12.3 s", "4 min 05 s", "2 h 03 min".
[[nodiscard]] std::string FormatDuration(double seconds);
// Of what is only expected: "11 s", "3 min", "2 h 05 min".
[[nodiscard]] std::string FormatRoughDuration(double seconds);
// "512 KiB", "1.4 GiB".
[[nodiscard]] std::string FormatBytes(double bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_REPORT_H_
