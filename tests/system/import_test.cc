// A rendered array, written in each format that `depthfarm import` reads, comes back as it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <numbers>
#include <sstream>

#include "common/sequence/read_sequence.h"
#include "tests/support/calibration_samples.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

void Write(const fs::path& file, const std::string& bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

// All digits of a double.
std::ostringstream Text() {
  std::ostringstream text;
  text << std::setprecision(17);
  return text;
}

class Import : public ::testing::Test {
 protected:
  void SetUp() override {
    scene_ = ReadSequence(RenderScene(Scene(), {.cameras = 3, .frames = 2})).value();
    for (const SequenceCamera& camera : scene_.cameras) cameras_.push_back(camera.camera);
  }

  [[nodiscard]] fs::path Scene() const { return folder_.path() / "scene"; }
  [[nodiscard]] std::string File(const std::string& name) const { return (Scene() / name).string(); }
  [[nodiscard]] std::string OutputFile() const { return File("imported.json"); }
  [[nodiscard]] Words Range() const {
    return {"--z-near", std::to_string(*scene_.z_near), "--z-far", std::to_string(*scene_.z_far)};
  }

  // Runs the command, which must do, and returns what it wrote.
  [[nodiscard]] Sequence Imported(const std::string& format, const std::string& calibration, const Words& options) {
    const Outcome import = Depthfarm(Words{"import", format, File(calibration), "-o", OutputFile()} + options);
    EXPECT_EQ(import.exit_code, 0) << import.output;
    EXPECT_THAT(import.output, AllOf(HasSubstr("3 cameras, 3 of them with pictures"), HasSubstr("disparity about")));
    EXPECT_FALSE(fs::exists(Scene() / "imported.json.tmp"));
    const Outcome plan = Depthfarm({"plan", OutputFile()});
    EXPECT_EQ(plan.exit_code, 0) << plan.output;
    const auto sequence = ReadSequence(OutputFile());
    EXPECT_TRUE(sequence.ok()) << sequence.status().message();
    return sequence.ok() ? *sequence : Sequence();
  }

  // The same cameras but for their names; `world` is X_scene = world * X_imported.
  void ExpectTheScene(const Sequence& imported, const Eigen::Matrix3d& world = Eigen::Matrix3d::Identity()) const {
    ASSERT_EQ(imported.cameras.size(), cameras_.size());
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      const Camera& camera = imported.cameras[i].camera;
      EXPECT_EQ(camera.width, cameras_[i].width);
      EXPECT_EQ(camera.height, cameras_[i].height);
      EXPECT_LT((camera.intrinsics - cameras_[i].intrinsics).norm(), 1e-9);
      EXPECT_LT((camera.cam_from_world_rotation - cameras_[i].cam_from_world_rotation * world).norm(), 1e-9);
      EXPECT_LT((camera.cam_from_world_translation - cameras_[i].cam_from_world_translation).norm(), 1e-9);
      EXPECT_EQ(imported.cameras[i].images.front(), scene_.cameras[i].images.front());
    }
  }

  TemporaryFolder folder_;
  Sequence scene_;
  std::vector<Camera> cameras_;
};

std::string FtvText(const std::vector<Camera>& cameras) {
  std::ostringstream text = Text();
  for (const Camera& camera : cameras) {
    Eigen::Matrix<double, 3, 4> pose;
    pose << camera.cam_from_world_rotation, CenterInWorld(camera);
    text << camera.name << "\n" << camera.intrinsics << "\n0 0\n" << pose << "\n\n";
  }
  return text.str();
}

TEST_F(Import, FtvWithFramesIsEstimated) {
  Write(Scene() / "cam_param.txt", FtvText(cameras_));
  const Sequence imported =
      Imported("ftv", "cam_param.txt",
               Words{"--size", "160x120", "--images", File("{camera}/{frame:04}.png"), "--frames", "0:2"} + Range());
  ExpectTheScene(imported);
  EXPECT_EQ(imported.cameras[2].images, scene_.cameras[2].images);
  const Outcome run = Depthfarm(Words{"run", OutputFile(), "-o", folder_ / "depth", "--workers", "1"} + SmallJob());
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_TRUE(fs::exists(folder_.path() / "depth" / "depth.json"));
}

TEST_F(Import, FtvOfRawPicturesByNumber) {
  Write(Scene() / "cam_param.txt", FtvText(cameras_));
  for (const char* camera : {"0", "2"})
    Write(Scene() / ("v" + std::string(camera) + ".yuv"), std::string(160 * 120 * 3, 'x'));
  const Words options = Words{"--size",         "160x120",     "--images", File("v{number}.yuv"),
                              "--pixel-format", "yuv420p10le", "--range",  "full"} +
                        Range();
  const Words command = Words{"import", "ftv", File("cam_param.txt"), "-o", OutputFile()} + options;
  const Outcome missing = Depthfarm(command);
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.output,
              AllOf(HasSubstr("camera 'cam1'"), HasSubstr(File("v1.yuv")), HasSubstr("--allow-missing")));
  EXPECT_FALSE(fs::exists(OutputFile()));
  const Outcome allowed = Depthfarm(command + Words{"--allow-missing", "--json"});
  ASSERT_EQ(allowed.exit_code, 0) << allowed.output;
  EXPECT_EQ(ParseJsonTail(allowed.output)["camerasWithPictures"], 2);
  const Sequence sequence = ReadSequence(OutputFile()).value();
  EXPECT_THAT(sequence.cameras[1].images, IsEmpty());
  EXPECT_EQ(sequence.cameras[0].format, (PictureFormat{PictureFormat::Kind::kYuv420, 10, true, false}));
}

TEST_F(Import, Msr) {
  const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, 1).asDiagonal();
  std::ostringstream text = Text();
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    Eigen::Matrix3d k = cameras_[i].intrinsics;
    k(1, 2) = cameras_[i].height - 1 - k(1, 2);
    Eigen::Matrix<double, 3, 4> pose;
    // Its world has y up too.
    pose << flip * cameras_[i].cam_from_world_rotation * flip, flip * cameras_[i].cam_from_world_translation;
    text << i << "\n" << k << "\n0 0\n" << pose << "\n\n";
  }
  Write(Scene() / "calibParams.txt", text.str());
  ExpectTheScene(
      Imported("msr", "calibParams.txt",
               Words{"--size", "160x120", "--images", File("{camera}/{frame:04}.png"), "--frames", "0:2"} + Range()));
}

TEST_F(Import, Middlebury) {
  std::ostringstream text = Text();
  const Eigen::IOFormat line(17, Eigen::DontAlignCols, " ", " ");
  text << cameras_.size() << "\n";
  for (const Camera& camera : cameras_) {
    text << camera.name << "/0000.png " << camera.intrinsics.format(line) << " "
         << camera.cam_from_world_rotation.format(line) << " " << camera.cam_from_world_translation.format(line)
         << "\n";
  }
  Write(Scene() / "scene_par.txt", text.str());
  const Sequence imported =
      Imported("middlebury", "scene_par.txt", Words{"--size", "160x120", "--images", Scene().string()} + Range());
  ExpectTheScene(imported);
  EXPECT_EQ(imported.cameras[1].camera.name, "cam1_0000");
}

TEST_F(Import, Llff) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    const Eigen::Matrix3d& r = cameras_[i].cam_from_world_rotation;
    const Eigen::Vector3d centre = CenterInWorld(cameras_[i]);
    // Calibrated at twice the size.
    const Eigen::Vector3d size(240, 320, 2 * cameras_[i].intrinsics(0, 0));
    for (int k = 0; k < 3; ++k) {
      for (const double number : {r(1, k), r(0, k), -r(2, k), centre[k], size[k]}) numbers.push_back(number);
    }
    numbers.push_back(*scene_.z_near);
    numbers.push_back(*scene_.z_far + static_cast<double>(i));
    fs::create_directories(Scene() / "images");
    fs::copy(scene_.cameras[i].images[0], Scene() / "images" / (std::to_string(i) + ".png"));
    scene_.cameras[i].images[0] = File("images/" + std::to_string(i) + ".png");
  }
  Write(Scene() / "poses_bounds.npy",
        samples::Npy("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 17), }", numbers));
  const Sequence imported =
      Imported("llff", "poses_bounds.npy", {"--size", "160x120", "--images", File("images"), "--reference", "2"});
  ExpectTheScene(imported);
  EXPECT_EQ(imported.reference, "2");
  EXPECT_EQ(imported.cameras[1].z_far, *scene_.z_far + 1);
}

TEST_F(Import, Miv) {
  Eigen::Matrix3d omaf;  // our axes of those of OMAF
  omaf << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  nlohmann::json file = {{"Fps", 30}, {"cameras", nlohmann::json::array()}};
  for (const Camera& camera : cameras_) {
    // The world in OMAF's axes too.
    const Eigen::Matrix3d world = omaf.transpose() * camera.cam_from_world_rotation.transpose() * omaf;
    const Eigen::Vector3d centre = omaf.transpose() * CenterInWorld(camera);
    const double degree = 180 / std::numbers::pi;
    const Eigen::Matrix3d& k = camera.intrinsics;
    file["cameras"].push_back({{"Name", camera.name},
                               {"Projection", "Perspective"},
                               {"Position", {centre[0], centre[1], centre[2]}},
                               {"Rotation",
                                {degree * std::atan2(world(1, 0), world(0, 0)), degree * std::asin(-world(2, 0)),
                                 degree * std::atan2(world(2, 1), world(2, 2))}},
                               {"Depth_range", {*scene_.z_near, *scene_.z_far}},
                               {"Resolution", {camera.width, camera.height}},
                               {"Focal", {k(0, 0), k(1, 1)}},
                               {"Principle_point", {k(0, 2) + 0.5, k(1, 2) + 0.5}}});
  }
  Write(Scene() / "miv.json", file.dump());
  const Sequence imported =
      Imported("miv", "miv.json", {"--images", File("{camera}/{frame:04}.png"), "--frames", "0:2"});
  ExpectTheScene(imported, omaf);
  EXPECT_EQ(imported.frame_rate, 30);
}

TEST_F(Import, Colmap) {
  std::ostringstream cameras = Text();
  std::ostringstream images = Text();
  std::ostringstream points = Text();
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    const Camera& camera = cameras_[i];
    const Eigen::Matrix3d& k = camera.intrinsics;
    const Eigen::Quaterniond q(camera.cam_from_world_rotation);
    const Eigen::Vector3d& t = camera.cam_from_world_translation;
    cameras << i << " PINHOLE 160 120 " << k(0, 0) << " " << k(1, 1) << " " << k(0, 2) + 0.5 << " " << k(1, 2) + 0.5
            << "\n";
    images << 10 + i << " " << q.w() << " " << q.x() << " " << q.y() << " " << q.z() << " " << t[0] << " " << t[1]
           << " " << t[2] << " " << i << " " << camera.name << "/0000.png\n\n";
  }
  const Eigen::Matrix3d inverse = cameras_[1].cam_from_world_rotation.transpose();
  for (int i = 0; i < 100; ++i) {
    const double z = *scene_.z_near + i * (*scene_.z_far - *scene_.z_near) / 99;
    const Eigen::Vector3d point = inverse * (Eigen::Vector3d(0, 0, z) - cameras_[1].cam_from_world_translation);
    points << i << " " << point[0] << " " << point[1] << " " << point[2] << " 0 0 0 0.5 11 " << i << "\n";
  }
  Write(Scene() / "sparse" / "cameras.txt", cameras.str());
  Write(Scene() / "sparse" / "images.txt", images.str());
  Write(Scene() / "sparse" / "points3D.txt", points.str());
  const Sequence imported = Imported("colmap", "sparse", {"--images", Scene().string()});
  ExpectTheScene(imported);
  EXPECT_EQ(imported.reference, "cam1_0000");
  EXPECT_NEAR(*imported.z_near, *scene_.z_near / 1.1, 0.1);
  EXPECT_NEAR(*imported.z_far, *scene_.z_far / 0.8, 0.2);
}

}  // namespace
}  // namespace depthfarm::system_test
