#ifndef DEPTHFARM_TESTS_WORKER_REFINEMENT_PLAIN_SCENE_H_
#define DEPTHFARM_TESTS_WORKER_REFINEMENT_PLAIN_SCENE_H_

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "worker/refinement/other_view.h"
#include "worker/refinement/plain_regions.h"
#include "worker/segmentation/describe.h"

namespace depthfarm {

// A view between two others of a textured wall with a plain board, and a dark rod before the board from top to bottom.
// What is at x in the view is at x - u in the right one, x + u in the left one. Segments are squares.
class PlainScene {
 public:
  static constexpr int kWidth = 120;
  static constexpr int kHeight = 80;
  static constexpr int kCell = 5;
  static constexpr double kWall = 4;
  static constexpr double kRod = 12;

  // The board's depth; `rod`: whether there is one.
  explicit PlainScene(double board, bool rod = false) : board_(board), rod_(rod) {
    picture = YcbcrImage(kWidth, kHeight);
    Grid<SegmentIndex> cells(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        picture(x, y) = SeenAt(x, y, 0);
        cells(x, y) = static_cast<SegmentIndex>(y / kCell * (kWidth / kCell) + x / kCell);
      }
    }
    segments = DescribeSegments(std::move(cells), picture);
    for (const int side : {-1, 1}) {
      PairGeometry pair;
      pair.other = side < 0 ? 1 : 2;
      pair.m = Eigen::Matrix3d::Identity();
      pair.e = {static_cast<double>(side), 0, 0};
      pair.other_scale = 1;
      pairs.push_back(pair);
      YcbcrImage colour(kWidth, kHeight);
      InverseDepthMap map(kWidth, kHeight);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          colour(x, y) = SeenAt(x, y, side);
          map(x, y) = static_cast<float>(DepthAt(x, side));
        }
      }
      colours.push_back(colour);
      maps.push_back(map);
    }
  }
  PlainScene(const PlainScene&) = delete;
  PlainScene& operator=(const PlainScene&) = delete;

  // Every segment at the depth of its centre, those of the board at `board_guess`.
  [[nodiscard]] RefinedView View(double board_guess) const {
    RefinedView view{
        .planes = {}, .kept = std::vector<std::uint8_t>(segments.centers.size()), .plane_of_pixel = segments.labels};
    for (const auto& [x, y] : segments.centers) {
      const bool guessed = OnBoard(x, y) && !OnRod(x, 0);
      view.planes.push_back({0, 0, static_cast<float>(guessed ? board_guess : OnRod(x, 0) ? kRod : kWall)});
    }
    return view;
  }
  [[nodiscard]] std::vector<std::uint8_t> Plain() const { return PlainSegments(Blurred(picture), segments); }
  // The others' maps are exact but for the board, which hides nothing.
  [[nodiscard]] std::vector<OtherView> Others() const {
    std::vector<OtherView> others;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      others.push_back({.pair = &pairs[i], .colour = colours[i], .map = &maps[i]});
    return others;
  }
  [[nodiscard]] static bool OnBoard(double x, int y) { return x >= 32 && x < 92 && y >= 17 && y < 63; }

  // A segment at a corner touches none that is plain.
  [[nodiscard]] static bool AtCorner(double x, int y) { return (x < 35 || x >= 90) && (y < 20 || y >= 60); }

  YcbcrImage picture;
  SegmentMap segments;
  std::vector<PairGeometry> pairs;
  std::vector<YcbcrImage> colours;
  std::vector<InverseDepthMap> maps;

 private:
  [[nodiscard]] bool OnRod(double x, int side) const {
    const double at = x - side * kRod;
    return rod_ && at >= 60 && at < 63;
  }
  [[nodiscard]] double DepthAt(double x, int side) const { return OnRod(x, side) ? kRod : -1e9; }

  // What the middle view shows, seen from the side: of the surfaces along the ray the nearest.
  [[nodiscard]] Ycbcr SeenAt(double x, int y, int side) const {
    if (OnRod(x, side)) return {20, 110, 140};
    if (OnBoard(x - side * board_, y)) return {135, 122, 126};
    const double at = x - side * kWall;
    const double value = 90 + 30 * std::sin(0.7 * at + 0.3 * y) + 25 * std::cos(0.9 * y - 0.4 * at);
    return {static_cast<std::uint8_t>(value), 128, 128};
  }

  double board_;
  bool rod_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_WORKER_REFINEMENT_PLAIN_SCENE_H_
