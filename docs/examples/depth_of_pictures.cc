// Depth of cameras in a row, from pictures in the PPM format: depth_of_pictures FOCAL BASELINE NEAR FAR cam0.ppm
// cam1.ppm ...
#include <depthfarm/depthfarm.h>

#include <fstream>
#include <iostream>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  if (argc < 7) return std::cerr << "usage: depth_of_pictures FOCAL BASELINE NEAR FAR PPM PPM...\n", 2;
  using namespace depthfarm::library;
  Scene scene;
  scene.z_near = std::stod(argv[3]);
  scene.z_far = std::stod(argv[4]);
  scene.frames.resize(1);
  std::vector<std::string> samples(static_cast<std::size_t>(argc));
  for (int i = 5; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    std::string magic;
    int width = 0, height = 0, most = 0;
    file >> magic >> width >> height >> most;
    file.ignore(1);
    std::string& rgb = samples[static_cast<std::size_t>(i)];
    if (magic == "P6" && most == 255 && width > 0 && height > 0)
      rgb.resize(3UL * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    if (rgb.empty() || !file.read(rgb.data(), static_cast<std::streamsize>(rgb.size())))
      return std::cerr << argv[i] << " is no PPM\n", 2;
    const double focal = std::stod(argv[1]), offset = -std::stod(argv[2]) * (i - 5);
    scene.cameras.push_back({"cam" + std::to_string(i - 5),
                             width,
                             height,
                             {focal, 0, (width - 1) / 2.0, 0, focal, (height - 1) / 2.0, 0, 0, 1},
                             {1, 0, 0, 0, 1, 0, 0, 0, 1},
                             {offset, 0, 0}});
    scene.frames[0].push_back({rgb.data()});
  }
  const Result result = EstimateDepth(scene);
  if (result.code != Code::kDone) return std::cerr << result.message << "\n", 1;
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    const DepthMap& map = result.depth[0][c];  // as PFM, which has the last row first
    std::ofstream file(scene.cameras[c].name + ".pfm", std::ios::binary);
    file << "Pf\n" << map.width << " " << map.height << "\n-1\n";
    for (int y = map.height - 1; y >= 0; --y)
      file.write(
          reinterpret_cast<const char*>(&map.z[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width)]),
          4L * map.width);
  }
}
