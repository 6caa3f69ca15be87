# One function per kind of target. Sources are listed, never globbed: the link line of a folder is its design.
include(CMakeParseArguments)
include(GNUInstallDirs)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# The same objects serve programs, libdepthfarm and its Python module. What is hidden is reached as directly as in a
# program.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

add_library(depthfarm_options INTERFACE)
# Depth must be the same bytes on every machine: no contraction of a*b+c into one rounding.
target_compile_options(depthfarm_options INTERFACE -ffp-contract=off
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # g++ 12 sees overlaps in "x" + std::string at -O3 (GCC bug 105651)
  $<$<BOOL:${DEPTHFARM_WARNINGS_AS_ERRORS}>:-Werror>)
target_include_directories(depthfarm_options INTERFACE ${CMAKE_SOURCE_DIR})
if(DEPTHFARM_SANITIZE)
  target_compile_options(depthfarm_options INTERFACE -fsanitize=${DEPTHFARM_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(depthfarm_options INTERFACE -fsanitize=${DEPTHFARM_SANITIZE})
endif()
if(DEPTHFARM_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "DEPTHFARM_FUZZ needs clang: cmake --preset fuzz")
  endif()
  target_compile_options(depthfarm_options INTERFACE -fsanitize=fuzzer-no-link,address,undefined
    -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(depthfarm_options INTERFACE -fsanitize=address,undefined)
endif()

# depthfarm_library(NAME SOURCES a.cc ... PUBLIC targets... PRIVATE targets...) defines depthfarm::NAME.
# A library without sources is header-only.
function(depthfarm_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(ARG_SOURCES)
    add_library(depthfarm_${name} STATIC ${ARG_SOURCES})
    target_link_libraries(depthfarm_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} depthfarm_options)
    target_include_directories(depthfarm_${name} PUBLIC ${CMAKE_SOURCE_DIR})
  else()
    add_library(depthfarm_${name} INTERFACE)
    target_link_libraries(depthfarm_${name} INTERFACE ${ARG_PUBLIC})
    target_include_directories(depthfarm_${name} INTERFACE ${CMAKE_SOURCE_DIR})
  endif()
  add_library(depthfarm::${name} ALIAS depthfarm_${name})
endfunction()

# depthfarm_program(NAME COMPONENT c SOURCES main.cc ... PRIVATE targets...): an installed executable called NAME, of the
# package that DepthfarmInstall.cmake makes of the component.
function(depthfarm_program name)
  cmake_parse_arguments(ARG "" "COMPONENT" "SOURCES;PRIVATE" ${ARGN})
  if(NOT ARG_COMPONENT)
    message(FATAL_ERROR "depthfarm_program(${name}): which COMPONENT installs it?")
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_PRIVATE} depthfarm_options)
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${ARG_COMPONENT})
endfunction()

# depthfarm_test(NAME LABEL unit|golden|system SOURCES ... PRIVATE targets...): a GoogleTest binary, one ctest per claim.
function(depthfarm_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;PRIVATE" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_PRIVATE} GTest::gmock GTest::gtest_main depthfarm_options)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
    PROPERTIES LABELS "${ARG_LABEL}" TIMEOUT ${ARG_TIMEOUT})
endfunction()
