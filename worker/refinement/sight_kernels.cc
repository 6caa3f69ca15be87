#include "worker/refinement/sight_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

// Vectors are members of structs here, which those without a fixed size cannot be.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
// This file is compiled once for each kind of vector.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "worker/refinement/sight_kernels.cc"
#include <hwy/foreach_target.h>
// The order is Highway's.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace depthfarm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMostLanes = 8;
using Doubles = hn::CappedTag<double, kMostLanes>;
using Floats = hn::CappedTag<float, kMostLanes>;
using Double = hn::Vec<Doubles>;
using Float = hn::Vec<Floats>;
using Seen = hn::Mask<Doubles>;

// Up to whole vectors.
inline std::size_t Padded(std::size_t count) { return (count + kMostLanes - 1) / kMostLanes * kMostLanes; }

template <typename T>
void FillUp(std::size_t count, ListOf<T>& list) {
  for (std::size_t i = count; i < Padded(count); ++i) list[i] = list[count - 1];
}

// The pixels whose colours a position is between, and how far it is from the left and the upper ones.
struct Between {
  ListOf<std::int32_t> top_left;
  ListOf<float> right;
  ListOf<float> down;
};

// The four colours around each position, as 32-bit words.
template <typename Pixel>
struct Corners;

template <>
struct Corners<Ycbcr> {
  ListOf<std::array<std::uint32_t, 2>> top;
  ListOf<std::array<std::uint32_t, 2>> bottom;

  void Load(std::size_t i, const Ycbcr* pixels, std::ptrdiff_t width) {
    std::memcpy(&top[i], pixels, sizeof(top[i]));
    std::memcpy(&bottom[i], pixels + width, sizeof(bottom[i]));
  }
};

template <>
struct Corners<FineYcbcr> {
  ListOf<std::array<std::uint32_t, 2>> top_left;
  ListOf<std::array<std::uint32_t, 2>> top_right;
  ListOf<std::array<std::uint32_t, 2>> bottom_left;
  ListOf<std::array<std::uint32_t, 2>> bottom_right;

  void Load(std::size_t i, const FineYcbcr* pixels, std::ptrdiff_t width) {
    std::memcpy(&top_left[i], pixels, sizeof(top_left[i]));
    std::memcpy(&top_right[i], pixels + 1, sizeof(top_right[i]));
    std::memcpy(&bottom_left[i], pixels + width, sizeof(bottom_left[i]));
    std::memcpy(&bottom_right[i], pixels + width + 1, sizeof(bottom_right[i]));
  }
};

struct ColourLanes {
  Float y, cb, cr;
};

template <class Words>
Float GreyLevels(Words words) {
  const Floats d;
  return hn::ConvertTo(d, hn::BitCast(hn::RebindToSigned<Floats>(), words));
}

template <class Words>
ColourLanes ColoursOfBytes(Words pixels) {
  const auto byte = hn::Set(hn::RebindToUnsigned<Floats>(), 0xFFU);
  return {GreyLevels(hn::And(pixels, byte)), GreyLevels(hn::And(hn::ShiftRight<8>(pixels), byte)),
          GreyLevels(hn::And(hn::ShiftRight<16>(pixels), byte))};
}

inline ColourLanes LoadColours(const ListOf<Ycbcr>& pixels, std::size_t i) {
  const hn::RebindToUnsigned<Floats> d;
  return ColoursOfBytes(hn::LoadU(d, reinterpret_cast<const std::uint32_t*>(&pixels[i])));
}

// Of 64-bit pixels.
inline ColourLanes LoadFineColours(const std::uint32_t* pixels) {
  const hn::RebindToUnsigned<Floats> d;
  hn::Vec<decltype(d)> y_cb;
  hn::Vec<decltype(d)> cr_matte;
  hn::LoadInterleaved2(d, pixels, y_cb, cr_matte);
  const auto low = hn::Set(d, 0xFFFFU);
  const auto unit = hn::Set(Floats(), 1.0F / kFineScale);
  return {hn::Mul(GreyLevels(hn::And(y_cb, low)), unit), hn::Mul(GreyLevels(hn::ShiftRight<16>(y_cb)), unit),
          hn::Mul(GreyLevels(hn::And(cr_matte, low)), unit)};
}

inline ColourLanes LoadColours(const ListOf<FineYcbcr>& pixels, std::size_t i) {
  return LoadFineColours(reinterpret_cast<const std::uint32_t*>(&pixels[i]));
}

inline Float Mix(Float from, Float to, Float share) { return hn::Add(from, hn::Mul(share, hn::Sub(to, from))); }

inline ColourLanes Mix(const ColourLanes& from, const ColourLanes& to, Float share) {
  return {Mix(from.y, to.y, share), Mix(from.cb, to.cb, share), Mix(from.cr, to.cr, share)};
}

inline ColourLanes Minus(const ColourLanes& a, const ColourLanes& b) {
  return {hn::Sub(a.y, b.y), hn::Sub(a.cb, b.cb), hn::Sub(a.cr, b.cr)};
}

// Sampler::At of the positions from the i-th on.
inline ColourLanes Sample(const Between& between, const Corners<Ycbcr>& corners, std::size_t i) {
  const Floats d;
  const hn::RebindToUnsigned<Floats> words;
  hn::Vec<decltype(words)> left;
  hn::Vec<decltype(words)> right;
  const Float share = hn::Load(d, &between.right[i]);
  hn::LoadInterleaved2(words, corners.top[i].data(), left, right);
  const ColourLanes upper = Mix(ColoursOfBytes(left), ColoursOfBytes(right), share);
  hn::LoadInterleaved2(words, corners.bottom[i].data(), left, right);
  const ColourLanes lower = Mix(ColoursOfBytes(left), ColoursOfBytes(right), share);
  return Mix(upper, lower, hn::Load(d, &between.down[i]));
}

inline ColourLanes Sample(const Between& between, const Corners<FineYcbcr>& corners, std::size_t i) {
  const Floats d;
  const Float share = hn::Load(d, &between.right[i]);
  const ColourLanes upper =
      Mix(LoadFineColours(corners.top_left[i].data()), LoadFineColours(corners.top_right[i].data()), share);
  const ColourLanes lower =
      Mix(LoadFineColours(corners.bottom_left[i].data()), LoadFineColours(corners.bottom_right[i].data()), share);
  return Mix(upper, lower, hn::Load(d, &between.down[i]));
}

struct ColourList {
  ListOf<float> y, cb, cr;

  void Store(const ColourLanes& colours, std::size_t i) {
    const Floats d;
    hn::Store(colours.y, d, &y[i]);
    hn::Store(colours.cb, d, &cb[i]);
    hn::Store(colours.cr, d, &cr[i]);
  }
};

inline Double LoadWide(const ListOf<float>& list, std::size_t i) {
  return hn::PromoteTo(Doubles(), hn::LoadU(hn::Rebind<float, Doubles>(), &list[i]));
}

// y, cb, cr products summed in this order.
inline Double Dot(const ColourList& a, const ColourList& b, std::size_t i) {
  const Double y = hn::Mul(LoadWide(a.y, i), LoadWide(b.y, i));
  const Double cb = hn::Mul(LoadWide(a.cb, i), LoadWide(b.cb, i));
  const Double cr = hn::Mul(LoadWide(a.cr, i), LoadWide(b.cr, i));
  return hn::Add(hn::Add(y, cb), cr);
}

struct PositionLanes {
  Double x, y;
};

// Sight on vectors. What is not seen is at (0, 0), where all may be read.
class SightLanes {
 public:
  SightLanes(const OtherView& other, const PixelList& list)
      : pair_(*other.pair),
        list_(list),
        width_(other.map->width()),
        last_column_(other.map->width() - 2),
        last_row_(other.map->height() - 2),
        right_(other.map->width() - 1),
        bottom_(other.map->height() - 1) {}

  // Projects the pixels from the i-th on.
  void Project(std::size_t i) {
    const Doubles d;
    const hn::Rebind<std::int32_t, Doubles> di;
    const Double x = hn::PromoteTo(d, hn::LoadU(di, &list_.x[i]));
    const Double y = hn::PromoteTo(d, hn::LoadU(di, &list_.y[i]));
    const Double u = hn::Load(d, &list_.u[i]);
    const auto row = [&](int r) {
      const Double of_pixel = hn::Add(hn::Mul(hn::Set(d, pair_.m(r, 0)), x), hn::Mul(hn::Set(d, pair_.m(r, 1)), y));
      return hn::Add(hn::Add(of_pixel, hn::Set(d, pair_.m(r, 2))), hn::Mul(hn::Set(d, pair_.e[r]), u));
    };
    const Double qz = row(2);
    inverse_ = hn::Div(hn::Set(d, 1.0), qz);
    at_ = {hn::Mul(row(0), inverse_), hn::Mul(row(1), inverse_)};
    inside_ = hn::And(hn::Gt(qz, hn::Set(d, 1e-6)), Inside(at_));
    u_there_ = hn::Mul(hn::Mul(hn::Set(d, pair_.other_scale), u), inverse_);
  }

  [[nodiscard]] const PositionLanes& at() const { return at_; }
  [[nodiscard]] Double u_there() const { return u_there_; }
  [[nodiscard]] Seen inside() const { return inside_; }

  // dX / du.
  [[nodiscard]] PositionLanes Motion() const {
    const Doubles d;
    const Double ez = hn::Set(d, pair_.e[2]);
    return {hn::Mul(hn::Sub(hn::Set(d, pair_.e[0]), hn::Mul(at_.x, ez)), inverse_),
            hn::Mul(hn::Sub(hn::Set(d, pair_.e[1]), hn::Mul(at_.y, ez)), inverse_)};
  }

  [[nodiscard]] Seen Inside(const PositionLanes& p) const {
    const Doubles d;
    const auto zero = hn::Zero(d);
    const Seen x = hn::And(hn::Ge(p.x, zero), hn::Le(p.x, hn::Set(d, right_)));
    const Seen y = hn::And(hn::Ge(p.y, zero), hn::Le(p.y, hn::Set(d, bottom_)));
    return hn::And(x, y);
  }

  void StoreBetween(const PositionLanes& p, Seen seen, std::size_t i, Between& between) const {
    const Doubles d;
    const hn::Rebind<std::int32_t, Doubles> di;
    const hn::Rebind<float, Doubles> df;
    const Double x = hn::IfThenElseZero(seen, p.x);
    const Double y = hn::IfThenElseZero(seen, p.y);
    // On the last column or row, which has none beside it, the one before.
    const auto column = hn::Min(hn::DemoteTo(di, x), hn::Set(di, last_column_));
    const auto row = hn::Min(hn::DemoteTo(di, y), hn::Set(di, last_row_));
    hn::StoreU(Index(column, row), di, &between.top_left[i]);
    hn::StoreU(hn::DemoteTo(df, hn::Sub(x, hn::PromoteTo(d, column))), df, &between.right[i]);
    hn::StoreU(hn::DemoteTo(df, hn::Sub(y, hn::PromoteTo(d, row))), df, &between.down[i]);
  }

  void StoreNearest(const PositionLanes& p, Seen seen, std::size_t i, ListOf<std::int32_t>& nearest) const {
    const Doubles d;
    const hn::Rebind<std::int32_t, Doubles> di;
    const auto half = hn::Set(d, 0.5);
    const auto column = hn::DemoteTo(di, hn::Add(hn::IfThenElseZero(seen, p.x), half));
    const auto row = hn::DemoteTo(di, hn::Add(hn::IfThenElseZero(seen, p.y), half));
    hn::StoreU(Index(column, row), di, &nearest[i]);
  }

 private:
  template <class Whole>
  [[nodiscard]] Whole Index(Whole column, Whole row) const {
    const hn::Rebind<std::int32_t, Doubles> di;
    return hn::Add(hn::Mul(row, hn::Set(di, width_)), column);
  }

  const PairGeometry& pair_;
  const PixelList& list_;
  std::int32_t width_;
  std::int32_t last_column_, last_row_;
  double right_, bottom_;
  PositionLanes at_{};
  Double inverse_{};
  Double u_there_{};
  Seen inside_{};
};

inline void StoreSeen(Seen seen, std::size_t i, ListOf<double>& list) {
  const Doubles d;
  hn::Store(hn::IfThenElseZero(seen, hn::Set(d, 1.0)), d, &list[i]);
}

inline Seen LoadSeen(const ListOf<double>& list, std::size_t i) {
  const Doubles d;
  return hn::Gt(hn::Load(d, &list[i]), hn::Zero(d));
}

// Not hidden by what the other view shows there.
inline Seen LoadVisible(const ListOf<double>& inside, const ListOf<float>& there, const ListOf<double>& u_there,
                        std::size_t i) {
  const Doubles d;
  const Double limit = hn::Add(hn::Load(d, &u_there[i]), hn::Set(d, kHiddenBy));
  return hn::AndNot(hn::Gt(LoadWide(there, i), limit), LoadSeen(inside, i));
}

template <typename Pixel>
void FitPixels(const OtherView& other, const Grid<Pixel>& picture, double base, ListOf<Pixel>& own, PixelList& list,
               PixelFits& result) {
  const Doubles d;
  const std::size_t padded = Padded(list.count);
  FillUp(list.count, list.x);
  FillUp(list.count, list.y);
  FillUp(list.count, list.u);
  FillUp(list.count, own);
  Between at;
  Between before;
  Between after;
  ListOf<std::int32_t> nearest;
  ListOf<double> inside;
  ListOf<double> u_there;
  ListOf<double> squared_motion;
  SightLanes sight(other, list);
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    sight.Project(i);
    const auto [dx, dy] = sight.Motion();
    const Double squared = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
    const Double to_half = hn::Div(hn::Set(d, 0.5), hn::Sqrt(squared));
    const Double half_x = hn::Mul(to_half, dx);
    const Double half_y = hn::Mul(to_half, dy);
    const auto [x, y] = sight.at();
    const PositionLanes half_before{hn::Sub(x, half_x), hn::Sub(y, half_y)};
    const PositionLanes half_after{hn::Add(x, half_x), hn::Add(y, half_y)};
    const Seen all_inside = hn::And(hn::And(sight.inside(), hn::Gt(squared, hn::Set(d, 1e-18))),
                                    hn::And(sight.Inside(half_before), sight.Inside(half_after)));
    sight.StoreBetween(sight.at(), all_inside, i, at);
    sight.StoreBetween(half_before, all_inside, i, before);
    sight.StoreBetween(half_after, all_inside, i, after);
    sight.StoreNearest(sight.at(), all_inside, i, nearest);
    StoreSeen(all_inside, i, inside);
    hn::Store(sight.u_there(), d, &u_there[i]);
    hn::Store(squared, d, &squared_motion[i]);
  }
  const float* const map = other.map->row(0);
  const Pixel* const pixels = picture.row(0);
  const std::ptrdiff_t width = picture.width();
  ListOf<float> there;
  Corners<Pixel> corners_at;
  Corners<Pixel> corners_before;
  Corners<Pixel> corners_after;
  for (std::size_t i = 0; i < padded; ++i) {
    there[i] = map[nearest[i]];
    corners_at.Load(i, pixels + at.top_left[i], width);
    corners_before.Load(i, pixels + before.top_left[i], width);
    corners_after.Load(i, pixels + after.top_left[i], width);
  }
  ColourList gradient;
  ColourList difference;
  for (std::size_t i = 0; i < padded; i += hn::Lanes(Floats())) {
    gradient.Store(Minus(Sample(after, corners_after, i), Sample(before, corners_before, i)), i);
    difference.Store(Minus(Sample(at, corners_at, i), LoadColours(own, i)), i);
  }
  const Double one = hn::Set(d, 1.0);
  const Double inverse_scale = hn::Set(d, 1 / (kKappa * kKappa * other.sigma * other.sigma));
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    const Seen visible = LoadVisible(inside, there, u_there, i);
    const Double t = hn::Mul(Dot(difference, difference, i), inverse_scale);
    const Double robust = hn::Div(one, hn::Add(one, t));
    const Double weight = hn::Mul(hn::Mul(hn::Set(d, base), robust), robust);
    const Double squared = hn::Load(d, &squared_motion[i]);
    const Double gg = hn::Mul(hn::Mul(weight, squared), Dot(gradient, gradient, i));
    const Double gr = hn::Mul(hn::Mul(weight, hn::Sqrt(squared)), Dot(gradient, difference, i));
    StoreSeen(visible, i, result.fits);
    hn::Store(hn::IfThenElseZero(visible, hn::Mul(t, robust)), d, &result.rho[i]);
    hn::Store(hn::IfThenElseZero(visible, gg), d, &result.gg[i]);
    hn::Store(hn::IfThenElseZero(visible, gr), d, &result.gr[i]);
  }
}

void FitPixelsOf(const OtherView& other, double base, PixelList& list, PixelFits& result) {
  if (other.colour.smoothed() != nullptr) {
    FitPixels(other, *other.colour.smoothed(), base, list.smoothed, list, result);
  } else {
    FitPixels(other, *other.colour.sharp(), base, list.sharp, list, result);
  }
}

// Where pixels of a list appear in another view and how far their colours are from those there.
struct Distances {
  ListOf<double> inside;
  ListOf<double> u_there;
  ListOf<float> there;  // what the other view shows at the nearest pixel
  ListOf<std::int32_t> nearest;
  ColourList difference;
};

template <typename Pixel>
void FindDistances(const OtherView& other, const Grid<Pixel>& picture, ListOf<Pixel>& own, PixelList& list,
                   Distances& result) {
  const Doubles d;
  const std::size_t padded = Padded(list.count);
  FillUp(list.count, list.x);
  FillUp(list.count, list.y);
  FillUp(list.count, list.u);
  FillUp(list.count, own);
  Between at;
  SightLanes sight(other, list);
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    sight.Project(i);
    sight.StoreBetween(sight.at(), sight.inside(), i, at);
    sight.StoreNearest(sight.at(), sight.inside(), i, result.nearest);
    StoreSeen(sight.inside(), i, result.inside);
    hn::Store(sight.u_there(), d, &result.u_there[i]);
  }
  const float* const map = other.map->row(0);
  const Pixel* const pixels = picture.row(0);
  const std::ptrdiff_t width = picture.width();
  Corners<Pixel> corners;
  for (std::size_t i = 0; i < padded; ++i) {
    result.there[i] = map[result.nearest[i]];
    corners.Load(i, pixels + at.top_left[i], width);
  }
  for (std::size_t i = 0; i < padded; i += hn::Lanes(Floats()))
    result.difference.Store(Minus(Sample(at, corners, i), LoadColours(own, i)), i);
}

void FindDistances(const OtherView& other, PixelList& list, Distances& result) {
  if (other.colour.smoothed() != nullptr) {
    FindDistances(other, *other.colour.smoothed(), list.smoothed, list, result);
  } else {
    FindDistances(other, *other.colour.sharp(), list.sharp, list, result);
  }
}

void DistancesOf(const OtherView& other, PixelList& list, ListOf<double>& result) {
  const Doubles d;
  Distances found;
  FindDistances(other, list, found);
  for (std::size_t i = 0; i < Padded(list.count); i += hn::Lanes(d)) {
    const Seen visible = LoadVisible(found.inside, found.there, found.u_there, i);
    const Double squared = Dot(found.difference, found.difference, i);
    hn::Store(hn::IfThenElse(visible, squared, hn::Set(d, kNotSeen)), d, &result[i]);
  }
}

// rho of the pixels from the i-th on, whether they are seen or not.
inline Double Rho(const ColourList& difference, double scale, std::size_t i) {
  const Doubles d;
  const Double t = hn::Div(Dot(difference, difference, i), hn::Set(d, scale));
  return hn::Div(t, hn::Add(hn::Set(d, 1.0), t));
}

void MisfitsOf(const OtherView& other, PixelList& list, ListOf<double>& result) {
  const Doubles d;
  Distances found;
  FindDistances(other, list, found);
  const double scale = kChoiceKappa * kChoiceKappa * other.sigma * other.sigma;
  for (std::size_t i = 0; i < Padded(list.count); i += hn::Lanes(d)) {
    const Seen visible = LoadVisible(found.inside, found.there, found.u_there, i);
    const Double rho = Rho(found.difference, scale, i);
    hn::Store(hn::IfThenElse(visible, rho, hn::Set(d, kNotSeen)), d, &result[i]);
  }
}

void MisfitsInFreeSpaceOf(const OtherView& other, PixelList& list, ListOf<double>& result) {
  const Doubles d;
  Distances found;
  FindDistances(other, list, found);
  const std::size_t padded = Padded(list.count);
  ListOf<double> through;
  const InverseDepthMap& map = *other.map;
  for (std::size_t i = 0; i < padded; ++i) {
    through[i] = 0;
    const double bound = found.u_there[i] - kHiddenBy;
    if (found.there[i] >= bound || found.inside[i] == 0) continue;
    through[i] = AllFarther(map, found.nearest[i] % map.width(), found.nearest[i] / map.width(), bound) ? 1 : 0;
  }
  const double scale = kChoiceKappa * kChoiceKappa * other.sigma * other.sigma;
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    const Seen visible = LoadVisible(found.inside, found.there, found.u_there, i);
    const Double rho = Rho(found.difference, scale, i);
    const Double doubled = hn::Add(hn::Mul(hn::Set(d, 2.0), rho), hn::Set(d, kInMidAir));
    const Double misfit = hn::IfThenElse(LoadSeen(through, i), hn::Min(hn::Set(d, 1.0), doubled), rho);
    hn::Store(hn::IfThenElse(visible, misfit, hn::Set(d, kNotSeen)), d, &result[i]);
  }
}

}  // namespace depthfarm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace depthfarm {

HWY_EXPORT(FitPixelsOf);
HWY_EXPORT(DistancesOf);
HWY_EXPORT(MisfitsOf);
HWY_EXPORT(MisfitsInFreeSpaceOf);

void FitColours(const OtherView& other, double base, PixelList& list, PixelFits& result) {
  if (list.count > 0) HWY_DYNAMIC_DISPATCH(FitPixelsOf)(other, base, list, result);
}

void SquaredDistances(const OtherView& other, PixelList& list, ListOf<double>& result) {
  if (list.count > 0) HWY_DYNAMIC_DISPATCH(DistancesOf)(other, list, result);
}

void Misfits(const OtherView& other, PixelList& list, ListOf<double>& result) {
  if (list.count > 0) HWY_DYNAMIC_DISPATCH(MisfitsOf)(other, list, result);
}

void MisfitsInFreeSpace(const OtherView& other, PixelList& list, ListOf<double>& result) {
  if (list.count > 0) HWY_DYNAMIC_DISPATCH(MisfitsInFreeSpaceOf)(other, list, result);
}

}  // namespace depthfarm
#endif
