#include "coordinator/service/submission.h"
#include "tests/fuzz/wire_round_trip.h"

// A client's SubmitJob as far as the coordinator plans it: what it accepts, it must be able to hand to workers.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  v1::SubmitJob request;
  if (!request.ParseFromArray(data, static_cast<int>(size))) return 0;
  const auto planned = PlanSubmission(request, JobId(7));
  if (!planned.ok()) {
    fuzz::Require(!planned.status().message().empty(), "a refusal has a reason");
    return 0;
  }
  fuzz::Require(!Summary(*planned).empty(), "a job can be summed up");
  fuzz::Require(fuzz::RequireWireRoundTrip(ToProto(planned->config)).has_value(), "a worker takes what was accepted");
  const JobPlan plan(*planned);
  for (const TaskId& task : plan.TasksOfGop(0)) {
    fuzz::Require(fuzz::RequireWireRoundTrip(ToProto(task)).has_value(), "a worker takes the name of a task");
    for (const PlannedInput& input : plan.Inputs(task))
      fuzz::Require(input.producer.frame <= task.frame, "inputs are of this frame or before");
  }
  return 0;
}
