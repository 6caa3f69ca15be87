#include "common/wire/job_wire.h"
#include "coordinator/cli/estimation_options.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  auto params = ParseParamsJson(fuzz::Text(data, size), "params.json", "");
  if (!params.ok() || !params->Validate().ok()) return 0;
  ++fuzz::accepted;
  const auto again = FromProto(ToProto(*params));
  if (!again.ok()) return 0;  // names of views that no camera can have
  params->prior.clear();      // folders are not sent
  params->mask.clear();
  fuzz::Require(*again == *params, "params that a user may give can be sent");
  return 0;
}
