# Debian 12 packages; why each one: docs/dependencies.md.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(cppzmq REQUIRED CONFIG)
find_package(Protobuf 3.21 REQUIRED)  # Debian ships no protobuf-config.cmake: module mode only
find_package(OpenSSL 3.0 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(SQLite3 3.40 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(spdlog 1.10 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(deflate REQUIRED IMPORTED_TARGET libdeflate)
pkg_check_modules(openexr REQUIRED IMPORTED_TARGET OpenEXR)
pkg_check_modules(highway REQUIRED IMPORTED_TARGET libhwy)
pkg_check_modules(httplib REQUIRED IMPORTED_TARGET cpp-httplib)  # Debian builds it as a library
find_package(prometheus-cpp REQUIRED CONFIG)  # tells no version
# For x86-64 alone; elsewhere what it does is done by libcrypto (worker/artifacts/CMakeLists.txt).
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  find_path(DEPTHFARM_IPSEC_MB_INCLUDE intel-ipsec-mb.h REQUIRED)
  find_library(DEPTHFARM_IPSEC_MB IPSec_MB REQUIRED)
  add_library(IPSec_MB UNKNOWN IMPORTED)
  set_target_properties(IPSec_MB PROPERTIES IMPORTED_LOCATION ${DEPTHFARM_IPSEC_MB}
    INTERFACE_INCLUDE_DIRECTORIES ${DEPTHFARM_IPSEC_MB_INCLUDE})
endif()
pkg_check_modules(libav REQUIRED IMPORTED_TARGET libavcodec libavformat libavutil)

# OpenCVConfig.cmake comes only with libopencv-dev (455 packages); the component packages have none.
find_path(DEPTHFARM_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(component core imgproc imgcodecs)
  find_library(DEPTHFARM_OPENCV_${component} opencv_${component} REQUIRED)
  add_library(opencv_${component} UNKNOWN IMPORTED)
  set_target_properties(opencv_${component} PROPERTIES IMPORTED_LOCATION ${DEPTHFARM_OPENCV_${component}}
    INTERFACE_INCLUDE_DIRECTORIES ${DEPTHFARM_OPENCV_INCLUDE})
endforeach()

if(DEPTHFARM_BUILD_PYTHON)
  # Debian's, which has Debian's numpy, rather than another one that comes first in PATH.
  if(NOT DEFINED Python_ROOT_DIR)
    set(Python_ROOT_DIR /usr)
  endif()
  set(Python_FIND_STRATEGY LOCATION)
  find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module)
  find_package(pybind11 2.10 REQUIRED CONFIG)
endif()

if(DEPTHFARM_BUILD_TESTS)
  find_package(GTest REQUIRED)
  find_package(Boost 1.74 REQUIRED)  # Boost.Graph, header-only: the max-flow oracle
  include(GoogleTest)
endif()
