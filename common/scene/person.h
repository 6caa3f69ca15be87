#ifndef DEPTHFARM_COMMON_SCENE_PERSON_H_
#define DEPTHFARM_COMMON_SCENE_PERSON_H_

#include <Eigen/Core>
#include <vector>

#include "common/scene/shape.h"

namespace depthfarm {

// A person-like figure of capsules and ellipsoids that walks to and fro around a place and waves an arm. Its pose is a
// function of the frame alone, so that any frame can be rendered without the others.
struct Person {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // on the floor, the middle of the walk, metres
  double height_m = 1.75;
  double walk_m = 0.4;      // farthest from `place`, along world x
  double walk_frames = 64;  // one walk to and fro
  double phase = 0;         // of the walk at frame 0, radians
  double facing = 0;        // radians from the cameras towards -x while standing
  double wave = 0;          // 0 arms hang, 1 the left arm is raised and waves
  int skin = 0;             // indices into Scene::materials
  int hair = 0;
  int shirt = 0;
  int trousers = 0;
  int shoes = 0;
};

// The solids of `person` in frame `frame` >= 0, all of Zone::kPerson.
[[nodiscard]] std::vector<Shape> PosedPerson(const Person& person, int frame);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SCENE_PERSON_H_
