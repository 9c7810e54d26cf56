# The ways to make a target. Sources are always listed by hand, never globbed.
include_guard()

option(VANTAGE_PORTABLE "Do not assume x86-64-v3 (AVX2, FMA)" OFF)
option(VANTAGE_WARNINGS_AS_ERRORS "Treat warnings as errors" OFF)

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
find_program(CCACHE ccache)
if(CCACHE)
  # The sloppiness is what ccache asks for where headers are precompiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

# Warnings, standard and instruction set, linked PRIVATE by every target we write ourselves.
# EIGEN_MAX_ALIGN_BYTES=16 keeps the layout of Eigen members equal to the one that Debian's FCL was
# compiled with; without it FCL returns wrong contacts silently once AVX is on.
# EIGEN_DONT_VECTORIZE: Eigen's loops over matrices of run-time size peel by the address's alignment,
# so the last bits of a result depend on where the stack happens to be; then no replay is exact. The
# hot loops are our own and are vectorised by the compiler (docs/decisions/0004).
add_library(vantage_build_flags INTERFACE)
target_compile_features(vantage_build_flags INTERFACE cxx_std_20)
target_compile_definitions(vantage_build_flags INTERFACE
  EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MAX_STATIC_ALIGN_BYTES=16 EIGEN_DONT_VECTORIZE)
target_compile_options(vantage_build_flags INTERFACE
  -pthread  # everywhere, or the precompiled headers do not fit where some library asks for it
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
  -Wold-style-cast -Wnon-virtual-dtor -Woverloaded-virtual
  -Wdouble-promotion -Wimplicit-fallthrough
  $<$<BOOL:${VANTAGE_WARNINGS_AS_ERRORS}>:-Werror>)
if(NOT VANTAGE_PORTABLE AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(vantage_build_flags INTERFACE -march=x86-64-v3)
endif()

# vantage_precompiled(<name> <header>…): headers compiled once, for target_precompile_headers(…
# REUSE_FROM <name>).
# (CONFIGURE, not WRITE: a file that stays the same must not make everything be built again.)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp
  CONTENT "// carries the precompiled headers\n" @ONLY)
function(vantage_precompiled name)
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  target_link_libraries(${name} PRIVATE vantage_build_flags Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

# What nearly every file includes; what every test includes besides; what commands do.
set(vantage_common_headers
  <algorithm> <cmath> <cstdint> <functional> <map> <memory> <optional> <random> <string> <vector>
  <Eigen/Core> <Eigen/Geometry> <Eigen/LU>)
vantage_precompiled(vantage_precompiled ${vantage_common_headers})
vantage_precompiled(vantage_precompiled_command
  ${vantage_common_headers} <filesystem> <CLI/CLI.hpp> <nlohmann/json.hpp>)

# vantage_library(<name> HEADERS a.hpp SOURCES a.cpp DEPS vantage::core [PRIVATE_DEPS …])
#
# Makes static library `vantage_<name>` with alias `vantage::<name>`. Includes are root-relative:
# #include "models/sensor/sensor.hpp". Listing the headers lets `all_verify_interface_header_sets`
# prove that each one compiles on its own.
function(vantage_library name)
  cmake_parse_arguments(ARG "" "" "HEADERS;SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  if(ARG_SOURCES)
    add_library(vantage_${name} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(vantage_${name} PRIVATE ${ARG_PRIVATE_DEPS} vantage_build_flags)
    set_target_properties(vantage_${name} PROPERTIES CXX_EXTENSIONS OFF)
    target_precompile_headers(vantage_${name} REUSE_FROM vantage_precompiled)
  else()
    add_library(vantage_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(vantage::${name} ALIAS vantage_${name})
  target_sources(vantage_${name} ${scope}
    FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
  target_compile_features(vantage_${name} ${scope} cxx_std_20)
  target_compile_definitions(vantage_${name} ${scope}
    EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MAX_STATIC_ALIGN_BYTES=16 EIGEN_DONT_VECTORIZE)
  target_link_libraries(vantage_${name} ${scope} ${ARG_DEPS})
endfunction()

# vantage_app(<name> SOURCES main.cpp DEPS vantage::estimator) -> executable `<name>`
function(vantage_app name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  target_precompile_headers(${name} REUSE_FROM vantage_precompiled_command)
  target_link_libraries(${name} PRIVATE ${ARG_DEPS} vantage_build_flags)
  if(name MATCHES "^vantage(-|$)")
    add_dependencies(vantage_programs ${name})
  endif()
endfunction()
# Everything that a person types and that these start: what tools/demo builds.
add_custom_target(vantage_programs)

# vantage_test(<room> SOURCES x_test.cpp DEPS vantage::models [LABEL unit] [TIMEOUT 60])
#
# One executable per room; every TEST() is its own ctest entry, named <room>.<Suite>.<Case>.
function(vantage_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;DEPS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_executable(${name}_test ${ARG_SOURCES})
  set_target_properties(${name}_test PROPERTIES CXX_EXTENSIONS OFF)
  if(NOT TARGET vantage_precompiled_test)
    vantage_precompiled(vantage_precompiled_test ${vantage_common_headers} <gtest/gtest.h>)
    target_link_libraries(vantage_precompiled_test PRIVATE GTest::gtest)
  endif()
  target_precompile_headers(${name}_test REUSE_FROM vantage_precompiled_test)
  target_link_libraries(${name}_test
    PRIVATE ${ARG_DEPS} GTest::gtest_main vantage_build_flags)
  # Real measurements live beside the checkout, if at all; tests that want them skip without.
  target_compile_definitions(${name}_test PRIVATE
    VANTAGE_DATA_DIR="${PROJECT_SOURCE_DIR}/../shared/data"
    VANTAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  include(GoogleTest)
  gtest_discover_tests(${name}_test
    TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
