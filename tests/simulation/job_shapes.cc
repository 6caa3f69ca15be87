#include "tests/simulation/job_shapes.h"

#include <array>
#include <cstddef>

#include "common/digest/sha256.h"
#include "common/wire/job_wire.h"
#include "common/wire/render_wire.h"
#include "common/wire/sequence_wire.h"

namespace depthfarm::simulation {
namespace {

struct Shape {
  int views;
  int frames;
  int gop;
  int blocks;
  int rounds;
  bool confidence;
  Anchor anchor;
};

constexpr std::array<Shape, kNumShapes + 1> kShapes{{
    {2, 1, 1, 1, 0, false, Anchor::kGop},
    {2, 4, 2, 2, 0, false, Anchor::kGop},
    {3, 3, 1, 3, 1, false, Anchor::kGop},
    {2, 6, 3, 1, 1, false, Anchor::kGop},
    {2, 6, 2, 1, 1, false, Anchor::kShared},
    {3, 2, 2, 5, 2, true, Anchor::kGop},
    {2, 5, 0, 2, 0, false, Anchor::kGop},
    {2, 40, 4, 1, 0, false, Anchor::kGop},
}};

// Cameras side by side.
Sequence MakeSequence(const JobKind& kind, const Shape& shape) {
  Sequence sequence;
  sequence.name = kind.sequence;
  sequence.z_near = 2;
  sequence.z_far = 8;
  for (int view = 0; view < shape.views; ++view) {
    SequenceCamera camera;
    camera.camera.name = "cam" + std::to_string(view);
    camera.camera.width = 64;
    camera.camera.height = 48;
    camera.camera.intrinsics << 60, 0, 31.5, 0, 60, 23.5, 0, 0, 1;
    camera.camera.cam_from_world_translation << -0.2 * view, 0, 0;
    for (int frame = 0; frame < shape.frames; ++frame) {
      camera.images.push_back("/in/" + kind.pictures + "/" + camera.camera.name + "/" + std::to_string(frame) + ".png");
    }
    sequence.cameras.push_back(camera);
  }
  return sequence;
}

// Of some parts, the last one short.
v1::SubmitJob Rendering(const JobKind& kind) {
  v1::SubmitJob submission;
  submission.mutable_sequence()->set_name(kind.sequence);
  submission.mutable_sequence()->set_file("/in/sequence.json");
  *submission.mutable_render()->mutable_source() =
      ToProto(RenderSource{"/in/" + kind.pictures, Sha256("depth of " + kind.pictures)});
  for (int number = 0; number < 8 * kind.shape + 3; ++number) {
    VirtualPicture view;
    view.camera.name = "virtual";
    view.camera.width = 64;
    view.camera.height = 48;
    view.camera.intrinsics << 60, 0, 31.5, 0, 60, 23.5, 0, 0, 1;
    view.sources = {"cam0", "cam1"};
    view.number = number;
    *submission.mutable_render()->add_views() = ToProto(view);
  }
  return submission;
}

}  // namespace

v1::SubmitJob Submission(const JobKind& kind, const std::string& name, const std::string& output_dir) {
  if (kind.renders) {
    v1::SubmitJob submission = Rendering(kind);
    submission.set_name(name);
    submission.set_output_dir(output_dir);
    return submission;
  }
  const Shape& shape = kShapes.at(static_cast<std::size_t>(kind.shape));
  EstimationParams params;
  params.gop = shape.gop;
  params.levels = 16;
  params.level_blocks = shape.blocks;
  params.refine_rounds = shape.rounds;
  params.choice_rounds = 0;
  params.confidence = shape.confidence;
  params.anchor = shape.anchor;
  v1::SubmitJob submission;
  *submission.mutable_sequence() = ToProto(MakeSequence(kind, shape));
  *submission.mutable_params() = ToProto(params);
  submission.set_name(name);
  submission.set_keeps_results(kind.keeps_results);
  if (!kind.keeps_results) submission.set_output_dir(output_dir);
  return submission;
}

}  // namespace depthfarm::simulation
