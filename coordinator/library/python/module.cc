// The Python module `depthfarm`: numpy arrays in and out.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/library/depthfarm.h"

namespace py = pybind11;

namespace depthfarm::library {
namespace {

// Numbers of an array of this shape, as doubles.
template <std::size_t N>
std::array<double, N> Numbers(const py::object& value, const std::vector<py::ssize_t>& shape, const std::string& what) {
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!array) {
    PyErr_Clear();
    throw py::value_error(what + " is no array of numbers");
  }
  // A column is as good as a vector.
  const bool column = array.ndim() == 2 && array.shape(1) == 1 && shape.size() == 1 && array.shape(0) == shape[0];
  const std::vector<py::ssize_t> given(array.shape(), array.shape() + array.ndim());
  if (given != shape && !column)
    throw py::value_error(what + " has another shape than " + (shape.size() == 2 ? "3x3" : "3"));
  std::array<double, N> numbers;
  std::copy_n(array.data(), N, numbers.begin());
  return numbers;
}

py::object Needed(const py::dict& camera, const char* key, const std::string& where) {
  if (!camera.contains(key)) throw py::value_error(where + " has no '" + std::string(key) + "'");
  return camera[key];
}

Camera ToCamera(const py::dict& dict, std::size_t position) {
  Camera camera;
  const std::string where = "camera " + std::to_string(position);
  camera.name = dict.contains("name") ? dict["name"].cast<std::string>() : "cam" + std::to_string(position);
  camera.K = Numbers<9>(Needed(dict, "K", where), {3, 3}, where + ": K");
  camera.R = Numbers<9>(Needed(dict, "R", where), {3, 3}, where + ": R");
  camera.t = Numbers<3>(Needed(dict, "t", where), {3}, where + ": t");
  for (const auto& [key, value] : dict) {
    const auto name = key.cast<std::string>();
    if (name != "name" && name != "K" && name != "R" && name != "t") {
      throw py::value_error(where + " has '" + name + "', expected name, K, R and t");
    }
  }
  return camera;
}

// Height x width (grey) or height x width x 3 (red, green, blue), uint8 or uint16. Kept by `alive` in a form whose rows
// are contiguous.
Picture ToPicture(const py::object& object, const std::string& where, Camera& camera, std::vector<py::array>& alive) {
  py::array array = py::array::ensure(object);
  if (!array) {
    PyErr_Clear();
    throw py::value_error(where + " is no array");
  }
  const bool bytes = py::isinstance<py::array_t<std::uint8_t>>(array);
  const bool words = py::isinstance<py::array_t<std::uint16_t>>(array);
  const bool grey = array.ndim() == 2;
  if ((!bytes && !words) || (!grey && (array.ndim() != 3 || array.shape(2) != 3))) {
    throw py::value_error(where + ": expected height x width or height x width x 3 of uint8 or uint16");
  }
  array = py::array::ensure(array, py::array::c_style);
  const auto height = static_cast<int>(array.shape(0));
  const auto width = static_cast<int>(array.shape(1));
  if (camera.width == 0) {
    camera.width = width;
    camera.height = height;
  } else if (camera.width != width || camera.height != height) {
    throw py::value_error(where + " is " + std::to_string(width) + "x" + std::to_string(height) + ", that of frame 0 " +
                          std::to_string(camera.width) + "x" + std::to_string(camera.height));
  }
  alive.push_back(array);
  return {array.data(), grey ? 1 : 3, bytes ? 1 : 2, 0};
}

// The numbers as numpy has them, without a copy: the array owns the vector.
py::array_t<float> ToArray(std::vector<float>&& values, int width, int height) {
  auto* owned = new std::vector<float>(std::move(values));
  const py::capsule owner(owned, [](void* vector) { delete static_cast<std::vector<float>*>(vector); });
  return py::array_t<float>({height, width}, owned->data(), owner);
}

std::string OptionText(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "on" : "off";
  return py::str(value).cast<std::string>();
}

py::list EstimateDepthOf(const py::list& cameras, const py::list& frames, double z_near, double z_far,
                         const std::optional<std::string>& reference, int threads,
                         const std::optional<py::function>& progress, const py::kwargs& options) {
  Scene scene;
  scene.z_near = z_near;
  scene.z_far = z_far;
  scene.reference = reference.value_or("");
  for (const py::handle& camera : cameras)
    scene.cameras.push_back(ToCamera(camera.cast<py::dict>(), scene.cameras.size()));
  std::vector<py::array> alive;
  for (const py::handle& frame : frames) {
    const auto pictures = frame.cast<py::list>();
    const std::string number = std::to_string(scene.frames.size());
    if (pictures.size() != scene.cameras.size()) {
      throw py::value_error("frame " + number + " has " + std::to_string(pictures.size()) + " pictures of " +
                            std::to_string(scene.cameras.size()) + " cameras");
    }
    std::vector<Picture> row;
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
      row.push_back(ToPicture(pictures[c], "frame " + number + ", camera '" + scene.cameras[c].name + "'",
                              scene.cameras[c], alive));
    }
    scene.frames.push_back(std::move(row));
  }

  Options native;
  native.threads = threads;
  for (const auto& [key, value] : options) {
    // level_blocks, as Python writes it, is --level-blocks.
    auto name = key.cast<std::string>();
    std::replace(name.begin(), name.end(), '_', '-');
    native.estimation[name] = OptionText(value);
  }
  // An exception of the callback, or Ctrl-C, passes through the call.
  native.progress = [&progress](const Progress& now) {
    const py::gil_scoped_acquire python;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress) return true;
    const py::object answer = (*progress)(now.done, now.frames_done, now.frames);
    return answer.is_none() || answer.cast<bool>();
  };
  Result result;
  {
    const py::gil_scoped_release others_may_run;
    result = EstimateDepth(scene, native);
  }
  switch (result.code) {
    case Code::kDone:
      break;
    case Code::kBadInput:
      throw py::value_error(result.message);
    case Code::kCancelled:
      return py::list();
    case Code::kFailed:
      throw std::runtime_error(result.message);
  }
  py::list depth;
  for (std::vector<DepthMap>& frame : result.depth) {
    py::list maps;
    for (DepthMap& map : frame) {
      py::dict of_camera;
      of_camera["z"] = map.width == 0 ? py::object(py::none()) : ToArray(std::move(map.z), map.width, map.height);
      if (!map.confidence.empty()) of_camera["confidence"] = ToArray(std::move(map.confidence), map.width, map.height);
      maps.append(of_camera);
    }
    depth.append(maps);
  }
  return depth;
}

}  // namespace
}  // namespace depthfarm::library

PYBIND11_MODULE(depthfarm, module) {
  module.doc() = "Depth maps of calibrated cameras, estimated for all of them together.";
  module.attr("__version__") = depthfarm::library::Version();
  module.def("estimate_depth", &depthfarm::library::EstimateDepthOf, py::arg("cameras"), py::arg("frames"),
             py::kw_only(), py::arg("z_near"), py::arg("z_far"), py::arg("reference") = py::none(),
             py::arg("threads") = 0, py::arg("progress") = py::none(),
             R"(Estimates the depth of all cameras together.

cameras    dicts of K (3x3), R (3x3), t (3) and optionally name: x_cam = R @ X_world + t, +z forward, +y down, pixel
           (0, 0) is the centre of the top-left pixel; no lens distortion
frames     of each frame a list with a picture of each camera: height x width (grey) or height x width x 3 (red,
           green, blue), uint8 or uint16
z_near, z_far   depth range along the axis of the reference camera
reference  name of a camera; default: the central one
threads    0: as many as the processor has; depth is the same for any number
progress   called first, several times a second and at the end with (done from 0 to 1, frames done, frames); False
           cancels
**options  estimation options of `depthfarm run --help`, with _ for -: preset="fast", levels=64, confidence=True

Returns, of each frame, a list with a dict of each camera: "z", height x width float32, depth along the camera's own
axis (0: none; None for cameras that options leave out), with confidence=True also "confidence", 0 to 1. An empty list
when it was cancelled. Raises ValueError for bad input, RuntimeError for a lack of disk or memory; Ctrl-C works.)");
}
