#ifndef DEPTHFARM_TESTS_FUZZ_CALIBRATION_ROUND_TRIP_H_
#define DEPTHFARM_TESTS_FUZZ_CALIBRATION_ROUND_TRIP_H_

#include "common/calibration/calibration.h"
#include "common/calibration/picture_size.h"
#include "common/sequence/format_sequence.h"
#include "common/sequence/read_sequence.h"
#include "tests/fuzz/fuzz_target.h"

namespace depthfarm::fuzz {

inline constexpr PictureSize kSize{640, 480};

// What a calibration was taken for is a sequence: the text that is written of it is read back unchanged.
inline void RequireSequenceOf(const Result<Calibration>& calibration) {
  if (!calibration.ok()) {
    Require(calibration.status().code() == ErrorCode::kInvalidArgument && !calibration.status().message().empty(),
            "a refusal has a reason");
    return;
  }
  Sequence sequence;
  sequence.file = "/arrays/one/sequence.json";
  sequence.frame_rate = calibration->frame_rate;
  for (const CalibratedCamera& camera : calibration->cameras) {
    SequenceCamera& entry = sequence.cameras.emplace_back();
    entry.camera = camera.camera;
    entry.z_near = camera.z_near;
    entry.z_far = camera.z_far;
    (void)CameraOfSize(camera.camera, kSize);
  }
  const Result<std::string> text = FormatSequence(sequence);
  Require(text.ok(), "what was imported can be written");
  ++accepted;
  const Result<Sequence> read = ParseSequence(*text, sequence.file);
  Require(read.ok(), "what was imported is read");
  Require(read->frame_rate == sequence.frame_rate && read->cameras.size() == sequence.cameras.size(),
          "a sequence is read as it was written");
  for (std::size_t i = 0; i < sequence.cameras.size(); ++i) {
    Require(read->cameras[i].camera == sequence.cameras[i].camera &&
                read->cameras[i].z_near == sequence.cameras[i].z_near &&
                read->cameras[i].z_far == sequence.cameras[i].z_far,
            "a camera is read as it was written");
  }
}

}  // namespace depthfarm::fuzz

#endif  // DEPTHFARM_TESTS_FUZZ_CALIBRATION_ROUND_TRIP_H_
