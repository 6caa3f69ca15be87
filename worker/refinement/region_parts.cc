#include "worker/refinement/region_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

namespace depthfarm {
namespace {

constexpr int kTile = 24;  // pixels; more where fewer than kJudged of its pixels would be judged
constexpr double kJudged = 16;
constexpr std::ptrdiff_t kFewestTiles = 4;  // of a part
constexpr std::size_t kFewestJudged = 9;    // pixels of a tile
constexpr double kMuchWorse = 4;            // times as badly as the region's median tile
constexpr double kRemains = 0.25;           // of a tile's misfit, elsewhere
constexpr double kLeastBetter = 0.5;        // of a tile's pixels
constexpr double kStep = 0.5;               // pixels of u
constexpr double kLeastNearer = 1;          // pixels of u: a plane less far off is refinement's to move
constexpr int kMostSteps = 24;              // nearer; a part may go on beyond
constexpr std::size_t kManyPixels = 8000;   // judged at a time
constexpr int kRings = 2;                   // of segments around one, by which it is judged

class Finder {
 public:
  Finder(const RegionFit& fit, const SegmentMap& segments, std::span<const SegmentIndex> region,
         std::span<const PixelPosition> pixels, std::span<const PixelPosition> judged,
         std::span<const SlantedPlane> planes)
      : fit_(fit),
        segments_(segments),
        region_(region),
        pixels_(pixels),
        planes_(planes),
        side_(SideOf(pixels.size(), judged.size())),
        columns_((segments.labels.width() + side_ - 1) / side_),
        rows_((segments.labels.height() + side_ - 1) / side_),
        tiles_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
    for (const PixelPosition& pixel : judged) tiles_[TileOf(pixel)].judged.push_back(pixel);
  }

  std::vector<RegionPart> Find() {
    std::vector<RegionPart> parts;
    if (!MarkSuspects()) return parts;
    MoveSuspects();
    if (std::count_if(tiles_.begin(), tiles_.end(), [](const Tile& tile) { return tile.nearer; }) < kFewestTiles)
      return parts;
    LinkSegments();
    for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
      if (!tiles_[tile].nearer) continue;
      const std::vector<std::size_t> together = TakeTogether(tile);
      if (std::ssize(together) < kFewestTiles) continue;
      const std::optional<SlantedPlane> fitted = FitTo(together);
      if (!fitted) continue;
      RegionPart part{.plane = Improved(*fitted, JudgedOf(together)), .segments = {}};
      std::vector<double> gains = Gains(part.plane);
      // More of it tells more of how it slants.
      part.plane = Improved(part.plane, JudgedOf(Better(gains, together)));
      gains = Gains(part.plane);
      part.segments = Better(gains, together);
      for (const SegmentIndex s : part.segments) gains_[s] = gains[s];
      if (!part.segments.empty()) parts.push_back(std::move(part));
    }
    return parts;
  }

 private:
  struct Tile {
    std::vector<PixelPosition> judged;
    Judgement fit;        // as decided
    bool nearer = false;  // suspected, then found to be
    double by = 0;        // pixels of u
  };

  static int SideOf(std::size_t pixels, std::size_t judged) {
    const double of_each = static_cast<double>(pixels) / static_cast<double>(std::max<std::size_t>(judged, 1));
    return std::max(kTile, static_cast<int>(std::sqrt(kJudged * of_each)));
  }
  [[nodiscard]] std::size_t TileAt(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] std::size_t TileOf(const PixelPosition& p) const { return TileAt(p.x / side_, p.y / side_); }
  [[nodiscard]] double Decided(int x, int y) const { return planes_[segments_.labels(x, y)].At(x, y); }

  // Returns whether there are enough of them for a part.
  bool MarkSuspects() {
    std::vector<double> means;
    for (Tile& tile : tiles_) {
      if (tile.judged.size() < kFewestJudged) continue;
      tile.fit = fit_.Judge(tile.judged, [this](int x, int y) { return Decided(x, y); });
      if (tile.fit.seen > 0) means.push_back(MeanOf(tile));
    }
    if (std::ssize(means) < kFewestTiles) return false;
    const auto middle = means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2);
    std::nth_element(means.begin(), middle, means.end());
    usual_ = *middle;
    std::ptrdiff_t suspects = 0;
    for (Tile& tile : tiles_) {
      tile.nearer = tile.fit.seen > 0 && MeanOf(tile) > kMuchWorse * usual_;
      suspects += tile.nearer ? 1 : 0;
    }
    return suspects >= kFewestTiles;
  }
  static double MeanOf(const Tile& tile) { return tile.fit.cost / static_cast<double>(tile.fit.seen); }

  // Of the suspects those stay that fit much better nearer.
  void MoveSuspects() {
    for (Tile& tile : tiles_) {
      if (!tile.nearer) continue;
      double gain = 0;
      std::size_t pixels = 0;
      for (int steps = 1; steps <= kMostSteps; ++steps) {
        const double by = steps * kStep;
        const Judgement moved = fit_.Judge(tile.judged, [&](int x, int y) { return Decided(x, y) + by; });
        const double better = fit_.Excess(tile.fit, moved);
        if (better <= gain) continue;
        gain = better;
        pixels = PixelsBetter(tile, moved);
        tile.by = by;
      }
      const auto count = static_cast<double>(tile.judged.size());
      tile.nearer = tile.by >= kLeastNearer && tile.fit.cost - gain < kRemains * tile.fit.cost &&
                    gain > kMuchWorse * usual_ * count && static_cast<double>(pixels) >= kLeastBetter * count;
    }
  }

  // How many pixels of a tile fit better so. What is hidden or mixed at an edge has few of them.
  [[nodiscard]] std::size_t PixelsBetter(const Tile& tile, const Judgement& moved) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < tile.judged.size(); ++i) count += fit_.Excess(tile.fit, moved, i) > usual_ ? 1 : 0;
    return count;
  }

  // Only where there are parts: a view has many regions, and this takes as long as it has segments.
  void LinkSegments() {
    gains_.resize(planes_.size());
    std::vector<std::uint8_t> inside(planes_.size());
    for (const SegmentIndex s : region_) inside[s] = 1;
    for (const auto& pair : segments_.adjacency) {
      if (inside[pair.first] != 0 && inside[pair.second] != 0) links_.emplace_back(pair.first, pair.second);
    }
  }

  // The marked tiles that touch, of which `first` is one; their marks are gone then.
  std::vector<std::size_t> TakeTogether(std::size_t first) {
    std::vector<std::size_t> together{first};
    tiles_[first].nearer = false;
    for (std::size_t i = 0; i < together.size(); ++i) {
      const int x = static_cast<int>(together[i]) % columns_;
      const int y = static_cast<int>(together[i]) / columns_;
      for (int to_y = std::max(0, y - 1); to_y <= std::min(rows_ - 1, y + 1); ++to_y) {
        for (int to_x = std::max(0, x - 1); to_x <= std::min(columns_ - 1, x + 1); ++to_x) {
          const std::size_t next = TileAt(to_x, to_y);
          if (!std::exchange(tiles_[next].nearer, false)) continue;
          together.push_back(next);
        }
      }
    }
    return together;
  }

  [[nodiscard]] std::optional<SlantedPlane> FitTo(const std::vector<std::size_t>& together) const {
    std::vector<DepthPoint> points;
    DepthPoint middle;
    for (const std::size_t index : together) {
      const Tile& tile = tiles_[index];
      DepthPoint& point = points.emplace_back();
      for (const auto& [x, y] : tile.judged) {
        point.x += x;
        point.y += y;
        point.u += Decided(x, y) + tile.by;
      }
      const auto count = static_cast<double>(tile.judged.size());
      point = {point.x / count, point.y / count, point.u / count};
      middle.x += point.x / static_cast<double>(together.size());
      middle.y += point.y / static_cast<double>(together.size());
    }
    return FitPlane(points, middle.x, middle.y);
  }

  [[nodiscard]] std::vector<PixelPosition> JudgedOf(const std::vector<std::size_t>& together) const {
    std::vector<PixelPosition> pixels;
    for (const std::size_t index : together)
      pixels.insert(pixels.end(), tiles_[index].judged.begin(), tiles_[index].judged.end());
    return pixels;
  }
  [[nodiscard]] std::vector<PixelPosition> JudgedOf(const std::vector<SegmentIndex>& part) const {
    std::vector<std::uint8_t> inside(planes_.size());
    for (const SegmentIndex s : part) inside[s] = 1;
    std::vector<PixelPosition> pixels;
    for (const Tile& tile : tiles_) {
      for (const PixelPosition& pixel : tile.judged)
        if (inside[segments_.labels(pixel.x, pixel.y)] != 0) pixels.push_back(pixel);
    }
    return pixels;
  }

  // Moved and turned while the pixels fit better.
  [[nodiscard]] SlantedPlane Improved(const SlantedPlane& plane, const std::vector<PixelPosition>& pixels) const {
    constexpr double kUnit = 100;  // pixels from the centre at which slopes are told
    constexpr double kFirst = 4;   // pixels of u; then half of it, and so on
    constexpr int kSizes = 6;
    constexpr int kMostMoves = 8;  // of each size
    if (pixels.empty()) return plane;
    double center_x = 0;
    double center_y = 0;
    for (const auto& [x, y] : pixels) {
      center_x += x;
      center_y += y;
    }
    center_x /= static_cast<double>(pixels.size());
    center_y /= static_cast<double>(pixels.size());
    std::array<double, 3> best{plane.a * kUnit, plane.b * kUnit, plane.At(center_x, center_y)};
    const auto cost_of = [&](const std::array<double, 3>& of) {
      const Judgement judgement = fit_.Judge(pixels, [&](int x, int y) {
        return of[0] * (x - center_x) / kUnit + of[1] * (y - center_y) / kUnit + of[2];
      });
      // The worst that a misfit may be, or a plane that takes pixels out of sight would be better for it.
      return judgement.cost + static_cast<double>(pixels.size() - judgement.seen);
    };
    double least = cost_of(best);
    double step = kFirst;
    for (int size = 0; size < kSizes; ++size, step /= 2) {
      bool moved = true;
      for (int moves = 0; moved && moves < kMostMoves; ++moves) {
        moved = false;
        for (std::size_t i = 0; i < best.size(); ++i) {
          for (const double by : {-step, step}) {
            std::array<double, 3> next = best;
            next[i] += by;
            const double cost = cost_of(next);
            if (cost >= least) continue;
            least = cost;
            best = next;
            moved = true;
          }
        }
      }
    }
    const double a = best[0] / kUnit;
    const double b = best[1] / kUnit;
    return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(best[2] - a * center_x - b * center_y)};
  }

  // How much better each segment of the region, with those around it, fits on the plane than as decided.
  [[nodiscard]] std::vector<double> Gains(const SlantedPlane& plane) const {
    std::vector<double> gain(planes_.size());
    for (std::size_t begin = 0; begin < pixels_.size(); begin += kManyPixels) {
      const std::span<const PixelPosition> some = pixels_.subspan(begin, std::min(kManyPixels, pixels_.size() - begin));
      const Judgement decided = fit_.Judge(some, [this](int x, int y) { return Decided(x, y); });
      const Judgement moved = fit_.Judge(some, [&](int x, int y) { return plane.At(x, y); });
      for (std::size_t i = 0; i < some.size(); ++i)
        gain[segments_.labels(some[i].x, some[i].y)] += fit_.Excess(decided, moved, i);
    }
    for (int ring = 0; ring < kRings; ++ring) {
      std::vector<double> wide = gain;
      for (const auto& [s, t] : links_) {
        wide[s] += gain[t];
        wide[t] += gain[s];
      }
      gain = std::move(wide);
    }
    return gain;
  }

  // The segments that fit better, than in a part found before as well, as far as they continue the tiles.
  [[nodiscard]] std::vector<SegmentIndex> Better(const std::vector<double>& gains,
                                                 const std::vector<std::size_t>& together) const {
    const auto is_better = [&](SegmentIndex s) { return gains[s] > gains_[s]; };
    std::vector<std::uint8_t> taken(planes_.size());
    for (const std::size_t index : together) {
      for (const auto& [x, y] : tiles_[index].judged) {
        const SegmentIndex s = segments_.labels(x, y);
        if (is_better(s)) taken[s] = 1;
      }
    }
    for (bool grows = true; grows;) {
      grows = false;
      for (const auto& [s, t] : links_) {
        if (taken[s] == taken[t] || !is_better(s) || !is_better(t)) continue;
        taken[s] = taken[t] = 1;
        grows = true;
      }
    }
    std::vector<SegmentIndex> better;
    for (const SegmentIndex s : region_)
      if (taken[s] != 0) better.push_back(s);
    return better;
  }

  const RegionFit& fit_;
  const SegmentMap& segments_;
  std::span<const SegmentIndex> region_;
  std::span<const PixelPosition> pixels_;
  std::span<const SlantedPlane> planes_;
  int side_;  // of a tile, pixels
  int columns_;
  int rows_;
  std::vector<Tile> tiles_;
  std::vector<std::pair<SegmentIndex, SegmentIndex>> links_;  // adjacent segments of the region
  std::vector<double> gains_;                                 // of each segment in the part that has it
  double usual_ = 0;                                          // misfit of a pixel
};

}  // namespace

std::vector<RegionPart> FindNearerParts(const RegionFit& fit, const SegmentMap& segments,
                                        std::span<const SegmentIndex> region, std::span<const PixelPosition> pixels,
                                        std::span<const PixelPosition> judged, std::span<const SlantedPlane> planes) {
  return Finder(fit, segments, region, pixels, judged, planes).Find();
}

}  // namespace depthfarm
