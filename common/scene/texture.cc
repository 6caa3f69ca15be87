#include "common/scene/texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/scene/hash.h"

namespace depthfarm {
namespace {

// Amplitude of each octave relative to the next coarser one: detail at every scale, so that small windows can be
// matched.
constexpr double kPersistence = 0.9;
constexpr int kMaxOctaves = 12;

// The value at a lattice point, uniform in [-1, 1). 32-bit mixing: this is called a hundred times per colour sample.
double LatticeValue(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  std::uint32_t h = seed ^ (static_cast<std::uint32_t>(x) * 0x8da6b343u) ^
                    (static_cast<std::uint32_t>(y) * 0xd8163841u) ^ (static_cast<std::uint32_t>(z) * 0xcb1ab31fu);
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  h ^= h >> 16;
  return static_cast<double>(h) * 0x1.0p-31 - 1.0;
}

double Blend(double a, double b, double t) { return a + (b - a) * t; }
Rgb Blend(const Rgb& a, const Rgb& b, double t) { return a + (b - a) * t; }
// Continuous second derivative: no creases at lattice planes.
double Ease(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

double ValueNoise(const Eigen::Vector3d& p, std::uint32_t seed) {
  const double fx = std::floor(p.x());
  const double fy = std::floor(p.y());
  const double fz = std::floor(p.z());
  const auto x = static_cast<std::int32_t>(fx);
  const auto y = static_cast<std::int32_t>(fy);
  const auto z = static_cast<std::int32_t>(fz);
  const double tx = Ease(p.x() - fx);
  const double ty = Ease(p.y() - fy);
  const double tz = Ease(p.z() - fz);
  double layers[2];
  for (int dz = 0; dz < 2; ++dz) {
    const double top = Blend(LatticeValue(x, y, z + dz, seed), LatticeValue(x + 1, y, z + dz, seed), tx);
    const double bottom = Blend(LatticeValue(x, y + 1, z + dz, seed), LatticeValue(x + 1, y + 1, z + dz, seed), tx);
    layers[dz] = Blend(top, bottom, ty);
  }
  return Blend(layers[0], layers[1], tz);
}

// How much of a line of `width` around multiples of `period` covers a pixel of `footprint` at `x`: a box-filtered line,
// in [0, 1].
double LineCover(double x, double period, double width, double footprint) {
  const double from_line = std::abs(x - period * std::round(x / period));
  const double pixel = std::max(footprint, 1e-9);
  const double left = std::max(from_line - pixel / 2, -width / 2);
  const double right = std::min(from_line + pixel / 2, width / 2);
  return std::clamp((right - left) / pixel, 0.0, 1.0);
}

// A wave between 0 and 1 with soft edges; flat 1/2 where the period is finer than a pixel.
double SoftWave(double x, double period, double footprint) {
  const double wave = std::sin(2 * std::numbers::pi * x / period);
  const double visible = std::clamp(period / std::max(footprint, 1e-9) / 2 - 1, 0.0, 1.0);
  return 0.5 + 0.5 * visible * std::clamp(1.6 * wave, -1.0, 1.0);
}

struct Cells {
  double column = 0;
  double row = 0;
  double joint = 0;  // how much of a joint covers the pixel
};

// Rows of height `height` whose cells of length `length` are shifted row by row.
Cells Masonry(double along, double across, double length, double height, double joint_m, double footprint,
              std::uint64_t seed) {
  Cells cells;
  cells.row = std::floor(across / height);
  const double shift = length * Uniform(seed, static_cast<std::uint64_t>(static_cast<std::int64_t>(cells.row)));
  cells.column = std::floor((along - shift) / length);
  cells.joint =
      std::max(LineCover(across, height, joint_m, footprint), LineCover(along - shift, length, joint_m, footprint));
  return cells;
}

double CellTone(const Cells& cells, std::uint64_t seed) {
  const auto row = static_cast<std::uint64_t>(static_cast<std::int64_t>(cells.row));
  const auto column = static_cast<std::uint64_t>(static_cast<std::int64_t>(cells.column));
  return Uniform(DerivedKey(seed, row), column);
}

Rgb Painted(const Material& m, const Eigen::Vector3d& point, const Eigen::Vector2d& s, double footprint) {
  switch (m.pattern) {
    case Material::Pattern::kPlain:
      break;
    case Material::Pattern::kNoise: {
      const double patch = OctaveNoise(point, m.coarsest_m, std::max(footprint, m.coarsest_m / 8), Mix(m.seed));
      return Blend(m.base, m.accent, std::clamp(0.5 + 0.5 * patch, 0.0, 1.0));
    }
    case Material::Pattern::kBricks: {
      const Cells bricks = Masonry(s.x(), s.y(), 2.6 * m.cell_m, m.cell_m, 0.08 * m.cell_m, footprint, m.seed);
      return Blend(Blend(m.base, m.accent, CellTone(bricks, m.seed)), m.line, 0.8 * bricks.joint);
    }
    case Material::Pattern::kPlanks: {
      const Cells boards = Masonry(s.y(), s.x(), 9 * m.cell_m, m.cell_m, 0.05 * m.cell_m, footprint, m.seed);
      return Blend(Blend(m.base, m.accent, CellTone(boards, m.seed)), m.line, 0.8 * boards.joint);
    }
    case Material::Pattern::kStripes:
      return Blend(m.base, m.accent, SoftWave(s.x(), m.cell_m, footprint));
    case Material::Pattern::kChecks: {
      const double bands = 0.5 * (SoftWave(s.x(), m.cell_m, footprint) + SoftWave(s.y(), m.cell_m, footprint));
      const double lines = std::max(LineCover(s.x() + 0.25 * m.cell_m, m.cell_m, 0.1 * m.cell_m, footprint),
                                    LineCover(s.y() + 0.25 * m.cell_m, m.cell_m, 0.1 * m.cell_m, footprint));
      return Blend(Blend(m.base, m.accent, bands), m.line, 0.6 * lines);
    }
  }
  return m.base;
}

}  // namespace

double OctaveNoise(const Eigen::Vector3d& point, double coarsest_m, double footprint_m, std::uint64_t seed) {
  // Value noise on [-1, 1) has a deviation of about 0.3; the sum is scaled so that all octaves together have about 1.
  constexpr double kScale = 1.5;
  double sum = 0;
  double amplitude = 1;
  double lattice_m = coarsest_m;
  for (int octave = 0; octave < kMaxOctaves; ++octave) {
    const double weight = std::min(1.0, lattice_m / footprint_m - 1);
    if (weight <= 0) break;
    // Octaves are shifted against each other, else their lattices share the planes where all of them are smooth.
    const Eigen::Vector3d p = point / lattice_m + Eigen::Vector3d(17.3, 5.9, 11.1) * octave;
    sum += amplitude * weight *
           ValueNoise(p, static_cast<std::uint32_t>(seed) + 0x9e3779b9u * static_cast<std::uint32_t>(octave));
    amplitude *= kPersistence;
    lattice_m /= 2;
  }
  return kScale * sum;
}

Rgb MaterialColour(const Material& material, const Eigen::Vector3d& point, const Eigen::Vector2d& on_surface,
                   double footprint_m) {
  const Rgb painted = Painted(material, point, on_surface, footprint_m);
  if (material.contrast == 0) return painted;
  return painted * (1 + material.contrast * OctaveNoise(point, material.coarsest_m, footprint_m, material.seed));
}

}  // namespace depthfarm
