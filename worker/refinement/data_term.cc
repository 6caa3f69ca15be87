#include "worker/refinement/data_term.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace depthfarm {
namespace {

constexpr double kHiddenBy = 1;      // pixels of u
constexpr double kNoiseFloor = 1.5;  // grey levels
constexpr double kKappaSquared = 9;
constexpr double kAgreement = 50;        // weight of another view's depth
constexpr double kAgreementScale = 0.5;  // pixels of u

double SquaredNorm(const Colour& a, const Colour& b) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += static_cast<double>(a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

bool Inside(const ColourGrid& grid, double x, double y) {
  return x >= 0 && y >= 0 && x <= grid.width() - 1 && y <= grid.height() - 1;
}

struct Fit {
  double rho = 0;
  int pixels = 0;
  NormalEquations equations;
};

}  // namespace

std::optional<Seen> SeenIn(const PairGeometry& pair, const InverseDepthMap& other_map, double x, double y, double u) {
  const auto& m = pair.m;
  const double qz = m[2][0] * x + m[2][1] * y + m[2][2] + pair.e[2] * u;
  if (!(qz > 1e-6)) return std::nullopt;
  Seen seen;
  seen.x = (m[0][0] * x + m[0][1] * y + m[0][2] + pair.e[0] * u) / qz;
  seen.y = (m[1][0] * x + m[1][1] * y + m[1][2] + pair.e[1] * u) / qz;
  if (!(seen.x >= 0 && seen.y >= 0 && seen.x <= other_map.width() - 1 && seen.y <= other_map.height() - 1))
    return std::nullopt;
  seen.u_in_other = pair.other_scale * u / qz;
  const float there = other_map(static_cast<int>(std::floor(seen.x + 0.5)), static_cast<int>(std::floor(seen.y + 0.5)));
  if (there > seen.u_in_other + kHiddenBy) return std::nullopt;
  seen.dx = (pair.e[0] - seen.x * pair.e[2]) / qz;
  seen.dy = (pair.e[1] - seen.y * pair.e[2]) / qz;
  return seen;
}

double MeasureNoise(const ColourGrid& own, const InverseDepthMap& map, const OtherView& other) {
  std::vector<double> squares;
  for (int y = 1; y < own.height(); y += 3) {
    for (int x = 1; x < own.width(); x += 3) {
      const auto seen = SeenIn(*other.pair, *other.map, x, y, map(x, y));
      if (seen) squares.push_back(SquaredNorm(SampleAt(*other.colour, seen->x, seen->y), own(x, y)));
    }
  }
  if (squares.empty()) return kNoiseFloor;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::max(kNoiseFloor, std::sqrt(*middle) / 1.54);
}

std::vector<NormalEquations> DataTerm(const ColourGrid& own, const InverseDepthMap& map,
                                      const Grid<SegmentIndex>& segments, std::span<const PixelPosition> centers,
                                      std::span<const OtherView> others, bool blurred) {
  std::vector<std::vector<Fit>> fits(others.size(), std::vector<Fit>(centers.size()));
  for (std::size_t j = 0; j < others.size(); ++j) {
    const OtherView& other = others[j];
    const double variance = other.sigma * other.sigma;
    const double base = 1 / (variance * (blurred ? 13 : 1));
    for (int y = 0; y < own.height(); ++y) {
      for (int x = 0; x < own.width(); ++x) {
        const auto seen = SeenIn(*other.pair, *other.map, x, y, map(x, y));
        if (!seen) continue;
        const double motion = std::sqrt(seen->dx * seen->dx + seen->dy * seen->dy);
        if (!(motion > 1e-9)) continue;
        const double nx = 0.5 * seen->dx / motion;
        const double ny = 0.5 * seen->dy / motion;
        if (!Inside(own, seen->x - nx, seen->y - ny) || !Inside(own, seen->x + nx, seen->y + ny)) continue;
        const Colour there = SampleAt(*other.colour, seen->x, seen->y);
        const Colour after = SampleAt(*other.colour, seen->x + nx, seen->y + ny);
        const Colour before = SampleAt(*other.colour, seen->x - nx, seen->y - ny);
        double gg = 0;
        double gr = 0;
        double rr = 0;
        for (int i = 0; i < 3; ++i) {
          const double g = motion * (after[i] - before[i]);
          const double r = there[i] - own(x, y)[i];
          gg += g * g;
          gr += g * r;
          rr += r * r;
        }
        const SegmentIndex s = segments(x, y);
        Fit& fit = fits[j][s];
        const double t = rr / (kKappaSquared * variance);
        const double weight = base / ((1 + t) * (1 + t));
        fit.rho += t / (1 + t);
        ++fit.pixels;
        const double px = x - centers[s].x;
        const double py = y - centers[s].y;
        auto& [h, rhs] = fit.equations;
        const double wgg = weight * gg;
        const double wgr = weight * gr;
        h[0] += wgg * px * px;
        h[1] += wgg * px * py;
        h[2] += wgg * px;
        h[3] += wgg * py * py;
        h[4] += wgg * py;
        h[5] += wgg;
        rhs[0] -= wgr * px;
        rhs[1] -= wgr * py;
        rhs[2] -= wgr;
      }
    }
  }
  std::vector<NormalEquations> result(centers.size());
  for (std::size_t s = 0; s < centers.size(); ++s) {
    double best = 1;
    for (const auto& view : fits)
      if (view[s].pixels > 0) best = std::min(best, view[s].rho / view[s].pixels);
    for (const auto& view : fits) {
      const Fit& fit = view[s];
      if (fit.pixels == 0) continue;
      const double ratio = (best + 0.03) / (fit.rho / fit.pixels + 0.03);
      for (std::size_t i = 0; i < 6; ++i) result[s].h[i] += ratio * ratio * fit.equations.h[i];
      for (std::size_t i = 0; i < 3; ++i) result[s].rhs[i] += ratio * ratio * fit.equations.rhs[i];
    }
  }
  return result;
}

void AddAgreement(const InverseDepthMap& map, std::span<const PixelPosition> centers, std::span<const OtherView> others,
                  std::vector<NormalEquations>& equations) {
  for (const OtherView& other : others) {
    const InverseDepthMap& there = *other.map;
    for (std::size_t s = 0; s < centers.size(); ++s) {
      const double u = map(centers[s].x, centers[s].y);
      const auto seen = SeenIn(*other.pair, there, centers[s].x, centers[s].y, u);
      if (!seen || !(seen->u_in_other > 0)) continue;
      const int x = std::min(static_cast<int>(seen->x), there.width() - 2);
      const int y = std::min(static_cast<int>(seen->y), there.height() - 2);
      const auto [low, high] = std::minmax({there(x, y), there(x + 1, y), there(x, y + 1), there(x + 1, y + 1)});
      if (high - low > kAgreementScale) continue;
      const double fx = seen->x - x;
      const double fy = seen->y - y;
      const double value = (1 - fy) * ((1 - fx) * there(x, y) + fx * there(x + 1, y)) +
                           fy * ((1 - fx) * there(x, y + 1) + fx * there(x + 1, y + 1));
      const double change = value * u / seen->u_in_other - u;  // u and u' of a point are in one ratio
      const double t = change / kAgreementScale;
      const double weight = kAgreement / ((1 + t * t) * (1 + t * t));
      equations[s].h[5] += weight;
      equations[s].rhs[2] += weight * change;
    }
  }
}

std::optional<double> Misfit(const Colour& own, const OtherView& other, double x, double y, double u) {
  const auto seen = SeenIn(*other.pair, *other.map, x, y, u);
  if (!seen) return std::nullopt;
  const double t =
      SquaredNorm(SampleAt(*other.colour, seen->x, seen->y), own) / (kKappaSquared * other.sigma * other.sigma);
  return t / (1 + t);
}

}  // namespace depthfarm
