# For 64-bit ARM, on a Debian 12 machine of another kind: Debian's cross compiler, its arm64 packages in a folder of their
# own, and qemu for the tests. All three come from deploy/install-deps.sh arm64. Tools that the build runs (protoc) are the
# host's.
set(DEPTHFARM_SYSROOT "" CACHE PATH "Folder of the arm64 packages, made by deploy/install-deps.sh arm64")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES DEPTHFARM_SYSROOT)
if(NOT EXISTS ${DEPTHFARM_SYSROOT}/usr/lib/aarch64-linux-gnu/libc.so)
  message(FATAL_ERROR "DEPTHFARM_SYSROOT: '${DEPTHFARM_SYSROOT}' holds no arm64 packages: run deploy/install-deps.sh arm64 FOLDER")
endif()

set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_SYSROOT ${DEPTHFARM_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${DEPTHFARM_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${DEPTHFARM_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${DEPTHFARM_SYSROOT}/usr/share/pkgconfig)

# Where Debian's scripts of installation, which do not run here, would have told the linker to look.
set(depthfarm_libraries ${DEPTHFARM_SYSROOT}/usr/lib/aarch64-linux-gnu)
foreach(folder blas lapack pulseaudio)
  string(APPEND CMAKE_EXE_LINKER_FLAGS_INIT " -Wl,-rpath-link,${depthfarm_libraries}/${folder}")
endforeach()
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L ${DEPTHFARM_SYSROOT}
  -E LD_LIBRARY_PATH=/usr/lib/aarch64-linux-gnu/blas:/usr/lib/aarch64-linux-gnu/lapack:/usr/lib/aarch64-linux-gnu/pulseaudio)
