#ifndef DEPTHFARM_TESTS_FUZZ_WIRE_ROUND_TRIP_H_
#define DEPTHFARM_TESTS_FUZZ_WIRE_ROUND_TRIP_H_

#include <optional>
#include <type_traits>

#include "common/wire/envelope.h"
#include "common/wire/job_wire.h"
#include "common/wire/results_wire.h"
#include "common/wire/sequence_wire.h"
#include "common/wire/task_wire.h"
#include "tests/fuzz/fuzz_target.h"

namespace depthfarm::fuzz {

// Message -> ours -> message -> ours -> message: from the first of ours on nothing may change. Returns that one.
template <typename Proto>
auto RequireWireRoundTrip(const Proto& proto) -> std::optional<std::decay_t<decltype(*FromProto(proto))>> {
  auto first = FromProto(proto);
  if (!first.ok()) return std::nullopt;
  ++accepted;
  const Proto sent = ToProto(*first);
  const auto second = FromProto(sent);
  Require(second.ok(), "what was taken is taken again");
  Require(ToProto(*second).SerializeAsString() == sent.SerializeAsString(), "a message comes back");
  return std::move(first).value();
}

}  // namespace depthfarm::fuzz

#endif  // DEPTHFARM_TESTS_FUZZ_WIRE_ROUND_TRIP_H_
