#ifndef DEPTHFARM_WORKER_REFINEMENT_PRIOR_FIELD_H_
#define DEPTHFARM_WORKER_REFINEMENT_PRIOR_FIELD_H_

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "worker/refinement/data_term.h"
#include "worker/refinement/other_view.h"
#include "worker/refinement/plane_field.h"
#include "worker/segmentation/segment_map.h"
#include "worker/segmentation/view_prior.h"

namespace depthfarm {

// A prior in the view's own u, and how far it can be believed.
struct PriorField {
  std::vector<SlantedPlane> planes;  // one a segment
  std::vector<std::uint8_t> known;   // one a segment: 0 where the prior has nothing
  // One a segment, 0 to 1: grows from 0 to 1 as the share of the segments around, of which pictures tell
  // the depth, that are within half a pixel of the prior grows from 50 to 90 %. Beside a depth jump, of the view or of
  // the prior, also as that share of all segments beside jumps does, 60 to 75 %: a prior may be right but for its
  // contours. Less the more adjacent planes of the prior fail to meet: a noisy one is of no use.
  std::vector<float> trust;
  double sigma = 0.1;  // of the agreeing ones, pixels of u, at least 0.1
  // Pixel by pixel: u = scale * value + shift; must outlive the field.
  const ViewPrior* pixels = nullptr;
  double scale = 1;
  double shift = 0;

  // nullopt: not known.
  [[nodiscard]] std::optional<double> At(int x, int y) const {
    const std::optional<double> value = pixels->At(x, y);
    return value ? std::optional<double>(scale * *value + shift) : std::nullopt;
  }

  [[nodiscard]] bool Says(SegmentIndex s) const { return known[s] != 0; }
};

inline constexpr float kTrusted = 0.5;  // from here on the prior decides where pictures do not tell

// How the values of a prior become u: u = scale * value; `fit`: up to a scale and shift of its own, fitted.
struct PriorScale {
  double scale = 1;
  bool fit = false;
};

// The prior of a view. Scale and shift are fitted, robustly, to the segments whose depth pictures tell (`told`, one a
// segment) where the values have none (PriorScale::fit), or where that makes clearly more of them agree: a scanner may
// be a little off. nullopt: too few segments to judge it by, or none of it fits.
[[nodiscard]] std::optional<PriorField> FitPrior(const ViewPrior& prior, const PriorScale& scale,
                                                 const SegmentMap& segments, std::span<const std::uint8_t> told,
                                                 const RefinedView& view);

// The share of the segments of which the prior knows the depth where it is trusted, 0 to 1; null: 0.
[[nodiscard]] double TrustedShare(const PriorField* prior);

// Gives segments the prior's plane where it is to be had and fits the other views better, or where it is trusted and
// fits about as well. Not to those of which `decided` is 1, nor to kept ones.
void TakePrior(const PictureColours& own, const SegmentMap& segments, const PriorField& prior,
               std::span<const std::uint8_t> decided, std::span<const OtherView> others, RefinedView& view);

// Draws each segment's plane, at its centre, to the prior, unless that is far off (more than about half a pixel).
void AddPrior(const PriorField& prior, const RefinedView& refined, std::span<const PixelPosition> centers,
              std::vector<NormalEquations>& equations);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PRIOR_FIELD_H_
