#ifndef DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_COMMAND_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_COMMAND_H_

#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// What `depthfarm evaluate` measures.
struct EvaluateCommandOptions {
  std::string sequence;           // sequence file the depth was estimated from
  std::string depth_dir;          // folder with depth.json
  std::string view;               // camera to synthesise; empty: every camera between two that have depth
  std::vector<std::string> from;  // cameras to synthesise it from; empty: its neighbours
  int first_frame = 0;            // positions in the sequence; by default all that have depth
  int end_frame = -1;             // one past the last, -1: to the end
  bool json = false;              // else a table for people
  std::string pictures_dir;       // empty: write no pictures
  bool bit_rate = false;          // HEVC bits of the virtual views and of their sources' depth
  std::string against;            // folder with depth.json to compare the bits with; empty: none
  // For scripts: a figure beyond its bound fails after the report. NaN: no bound.
  double min_psnr = kNoBound;       // mean PSNR-Y of the virtual views, dB
  double min_iv_psnr = kNoBound;    // mean IV-PSNR, dB
  double min_agreement = kNoBound;  // non-occluded pixels that agree, all sources, %
  double max_bad_px = kNoBound;     // pixels with exact depth off by more than 1 px, all views, %
  double max_flicker = kNoBound;    // still pixels whose depth changed by more than a level, %

  static constexpr double kNoBound = std::numeric_limits<double>::quiet_NaN();
};

// Measures depth maps as the paper does (section V) and against ground truth, and writes the figures to `out`:
//   virtual views   each target is synthesised from the pictures and depth of its neighbours (SynthesizeView) and
//                   compared with its real picture: PSNR-Y, IV-PSNR, SSIM, holes; where the sources' exact depth is
//                   known the same with that (the ceiling), and the best single plane (the floor, first frame);
//   agreement       of the two sources' depth (MeasureAgreement), both directions together;
//   depth error     of every view with exact depth, by zone (MeasureDepthError);
//   confidence      where the folder has it, how well it tells right depth from wrong (Sparsification);
//   stability       how much depth changes from frame to frame where the picture does not (MeasureStability);
//   bit rate        of virtual views and depth as HEVC (MeasureRates), and the Bjøntegaard delta against another
//                   folder: of the same views, from the same sources, in the same frames.
// Means over frames; depth errors over all pixels of all frames. Levels and their range come from the parameters that
// depth.json records ("levels", "zNear", "zFar", "reference"), else from the sequence.
// With `pictures_dir`: DIR/<view>/<frame>_{synthesised,real,difference,exact}.png (difference: |luma| x 4) and
// DIR/<source>/<frame>_depth.png.
// Errors  kInvalidArgument: bad options (--against with another downscaling or without the sources' depth), or files
// that can't be read or don't fit together; kInternal: a figure
//         is beyond its bound or not measured (after the figures were written), kUnavailable: pictures can't be
//         written.
[[nodiscard]] Status RunEvaluate(const EvaluateCommandOptions& options, std::ostream& out);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_COMMAND_H_
