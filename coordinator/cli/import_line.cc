#include "coordinator/cli/import_line.h"

#include <CLI/CLI.hpp>  // 10 s to compile

#include "coordinator/cli/option_parts.h"

namespace depthfarm {
namespace {

void AddPictureOptions(CLI::App& app, ImportOptions& options) {
  const char* group = "Pictures";
  app.add_option("--images", options.images,
                 "Where they are, from here. A path with {camera}, the camera's name, or {number}, the number that its "
                 "name ends "
                 "with, and of several frames {frame}; {number:02}, {frame:04} with so many digits. Or, of colmap, "
                 "llff and middlebury, the folder of the pictures that the format names (llff: all that are in it, by "
                 "name). Without it cameras are known, for views, and depth is estimated for none")
      ->type_name("PATTERN|DIR")
      ->group(group);
  app.add_option(
         "--videos", options.videos,
         "Instead of --images: a video of each camera, as a pattern without {frame}. With --pixel-format a file "
         "of raw pictures one after the other, else mp4, mov, mkv, webm, mxf, ts, avi or y4m")
      ->type_name("PATTERN")
      ->group(group);
  app.add_option("--frames", options.frames,
                 "Frames A to B - 1, where the pattern has {frame}; of videos 0:B, how many there are (of raw ones: by "
                 "default all)")
      ->type_name("A:B")
      ->group(group);
  app.add_option("--size", options.size,
                 "Size of the pictures, pixels: of ftv, msr and middlebury, which do not tell; of the others where the "
                 "pictures are larger or smaller than those that were calibrated")
      ->type_name("WxH")
      ->group(group);
  app.add_option("--pixel-format", options.pixel_format, "Raw pictures: yuv420p8, yuv420p10le, yuv422p10le, gray8, ...")
      ->type_name("NAME")
      ->group(group);
  app.add_option(
         "--range", options.range,
         "Of raw samples, default: limited, 16 to 235; of other videos, with --matrix, instead of what they say")
      ->type_name("limited|full")
      ->check(CLI::IsMember({"limited", "full"}).description(""))
      ->group(group);
  app.add_option("--matrix", options.matrix, "The same of colours; default: bt601")
      ->type_name("bt601|bt709")
      ->check(CLI::IsMember({"bt601", "bt709"}).description(""))
      ->group(group);
  app.add_flag("--allow-missing", options.allow_missing, "A camera none of whose pictures is there has none")
      ->group(group);
  app.add_flag("--allow-outside", options.allow_outside,
               "Pictures may be outside the folder of SEQUENCE.json; run and the others need the same option then")
      ->group(group);
}

void AddCameraOptions(CLI::App& app, ImportOptions& options) {
  const char* group = "Cameras and depth";
  app.add_option("--cameras", options.cameras, "Cameras to take, in this order; default: all")
      ->type_name("A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group(group);
  app.add_option("--z-near", options.z_near,
                 "Nearest depth along the axis of the reference, in the calibration's unit of length: of ftv, msr and "
                 "middlebury, which do not tell; of the others instead of what they tell")
      ->type_name("Z")
      ->group(group);
  app.add_option("--z-far", options.z_far, "Farthest depth")->type_name("Z")->group(group);
  app.add_option("--reference", options.reference, "Reference camera; default: the middle one of those with pictures")
      ->type_name("CAMERA")
      ->group(group);
  app.add_option("--pose", options.pose,
                 "ftv: what [R | T] is. centre, the default: x_cam = R (X - T); camera-to-world: X = R x_cam + T; "
                 "world-to-camera: x_cam = R X + T")
      ->type_name("centre|camera-to-world|world-to-camera")
      ->check(CLI::IsMember({"centre", "camera-to-world", "world-to-camera"}).description(""))
      ->group(group);
  app.add_option("--z-axis", options.z_axis,
                 "ftv: where the scene is. forward, the default: at z > 0; backward: at z < 0, where the settings of "
                 "VSRS have negative depth")
      ->type_name("forward|backward")
      ->check(CLI::IsMember({"forward", "backward"}).description(""))
      ->group(group);
}

}  // namespace

void DefineImport(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<ImportArguments>();
  ImportOptions& options = arguments.options;
  app.add_option("FORMAT", options.format, "ftv, msr, colmap, miv, llff or middlebury, see below")
      ->required()
      ->type_name("");
  app.add_option("CALIBRATION", options.calibration, "Its file; of colmap the folder of a sparse model")
      ->required()
      ->type_name("");
  app.add_option("-o,--output", options.output, "Sequence file to write; put it beside the pictures or above them")
      ->required()
      ->type_name("SEQUENCE.json");
  AddPictureOptions(app, options);
  AddCameraOptions(app, options);
  app.add_option("--name", options.name, "Name of the sequence; default: that of its folder")->type_name("S");
  AddJsonFlag(app, arguments.json);
  app.footer(
      "Formats:\n"
      "  ftv         camera parameter text of MPEG FTV, VSRS, DERS: name, K, two zeros, [R | T] of each camera\n"
      "  msr         calibParams of Microsoft's Ballet and Breakdancers; camera n is called camN\n"
      "  colmap      sparse model, text or binary; an image is a camera with one frame; depth range by its points\n"
      "  miv         camera JSON of MPEG immersive video, TMIV, RVS, IVDE; perspective cameras\n"
      "  llff        poses_bounds.npy, a picture for each row in the order of their names\n"
      "  middlebury  *_par.txt of the multi-view sets\n"
      "Lens distortion and cameras that move are refused. Look at the summary: a wrong reading of an ftv file cannot\n"
      "always be told from the numbers.\n"
      "Examples:\n"
      "  depthfarm import ftv cam_param.txt -o array/sequence.json --images 'array/{camera}/{frame:04}.yuv' \\\n"
      "    --frames 0:50 --size 1024x768 --pixel-format yuv420p8 --z-near 448 --z-far 11206\n"
      "  depthfarm import msr calibParams-ballet.txt -o ballet.json --size 1024x768 --z-near 42 --z-far 130 \\\n"
      "    --images '{camera}/color-{camera}-f{frame:03}.jpg' --frames 0:100\n"
      "  depthfarm import miv Fencing.json -o fencing/sequence.json --pixel-format yuv420p10le \\\n"
      "    --videos 'fencing/v{number}_texture_1920x1080_yuv420p10le.yuv'\n"
      "  depthfarm import colmap dense/sparse -o dense/sequence.json --images dense/images\n"
      "  depthfarm import llff fern/poses_bounds.npy -o fern/sequence.json --images fern/images_4 --size 1008x756");
}

}  // namespace depthfarm
