#include <iostream>

#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/job_request.h"
#include "coordinator/cli/plan_report.h"
#include "coordinator/planning/job_plan.h"

namespace depthfarm {

int Execute(const PlanArguments& arguments) {
  const Result<JobRequest> request = ReadJobRequest(arguments.job);
  if (!request.ok()) return Fail(request.status());
  const Status plannable = CheckPlannable(request->resolved);  // as the coordinator does
  if (!plannable.ok()) return Fail(plannable);
  const PlanReport report{.sequence = request->sequence.name,
                          .description = DescribeJob(request->resolved),
                          .choices = ChoicesOf(request->params, request->resolved),
                          .forecast = Forecast(request->resolved, {.workers = arguments.workers})};
  std::cout << (arguments.json ? PlanToJson(report).dump(2) + "\n" : FormatPlan(report));
  return kExitOk;
}

}  // namespace depthfarm
