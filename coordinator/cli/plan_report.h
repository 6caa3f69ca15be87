#ifndef DEPTHFARM_COORDINATOR_CLI_PLAN_REPORT_H_
#define DEPTHFARM_COORDINATOR_CLI_PLAN_REPORT_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/job/resolved_job.h"
#include "coordinator/forecast/job_forecast.h"

namespace depthfarm {

// What "auto", or the sequence, decided for a job.
struct Choice {
  std::string option;
  std::string value;
  std::string reason;
  bool operator==(const Choice&) const = default;
};
// Of the options that `asked` left open, as ResolveJob chose them; and how the frames are divided.
[[nodiscard]] std::vector<Choice> ChoicesOf(const EstimationParams& asked, const ResolvedJob& job);

struct PlanReport {
  std::string sequence;     // its name
  std::string description;  // of the job, one line
  std::vector<Choice> choices;
  JobForecast forecast;
};

// For people: choices, tasks by stage, critical path, farms.
[[nodiscard]] std::string FormatPlan(const PlanReport& report);
// The same and every task of the critical path, for programs.
[[nodiscard]] nlohmann::ordered_json PlanToJson(const PlanReport& report);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_PLAN_REPORT_H_
