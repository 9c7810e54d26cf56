# Functions that create targets. Sources are always listed explicitly, never globbed.
include_guard()
include(VantageComponents)

option(VANTAGE_PORTABLE "Do not assume x86-64-v3 (AVX2)" OFF)
option(VANTAGE_OWN_LIBM "Compute sin, exp, log, … identically on every machine (needs musl-dev)"
  ${PROJECT_IS_TOP_LEVEL})
option(VANTAGE_HARDENED
  "For packages: harden stack and libraries, and keep build paths out of the binaries" OFF)
# tools/demo and tools/test set VANTAGE_UNITY in a new build folder. Do not use it for development: a
# changed file is compiled together with up to seven others, and missing includes are not detected.
option(VANTAGE_UNITY "Compile up to eight files of a library as one: a clean build takes half the time" OFF)
option(VANTAGE_WARNINGS_AS_ERRORS "Treat warnings as errors" OFF)

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
find_program(CCACHE ccache)
if(CCACHE)
  # With precompiled headers, ccache requires this value of CCACHE_SLOPPINESS.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

# Warnings, standard and instruction set, linked PRIVATE by every target of this project.
# EIGEN_MAX_ALIGN_BYTES=16 keeps the layout of Eigen members equal to that in Debian's FCL. Without
# this option FCL silently returns wrong contacts if AVX is enabled.
# EIGEN_DONT_VECTORIZE: without it, Eigen splits loops over matrices of run-time size by the
# alignment of their address. The last bits of a result then depend on stack addresses, and a replay
# is not exact. The compiler vectorises the project's own hot loops (docs/decisions/0004).
set(is_x86_64 OFF)
set(is_arm64 OFF)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(is_x86_64 ON)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  set(is_arm64 ON)
endif()
add_library(vantage_build_flags INTERFACE)
target_compile_features(vantage_build_flags INTERFACE cxx_std_20)
target_compile_definitions(vantage_build_flags INTERFACE
  EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MAX_STATIC_ALIGN_BYTES=16 EIGEN_DONT_VECTORIZE)
# Results are bit-identical for every compiler, flag, processor and C library (docs/decisions/0014).
# A product and a sum are not fused into one operation. sin, exp, log, … come from core/libm, and
# the compiler must not evaluate them at compile time.
target_compile_options(vantage_build_flags INTERFACE -ffp-contract=off)
if(VANTAGE_OWN_LIBM)
  foreach(function
      sin cos tan asin acos atan atan2 exp exp2 expm1 log log10 log1p pow hypot erf erfc)
    target_compile_options(vantage_build_flags INTERFACE -fno-builtin-${function})
  endforeach()
  target_include_directories(vantage_build_flags BEFORE INTERFACE
    ${PROJECT_SOURCE_DIR}/core/libm/first)
endif()
target_compile_options(vantage_build_flags INTERFACE
  -pthread  # for all targets: precompiled headers must match in libraries that require it
  # All targets use -fPIC, so that the Python module consists of the same object files as the
  # processes in flight. Without interposition the compiler inlines as it does without -fPIC.
  -fPIC -fno-semantic-interposition
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
  -Wold-style-cast -Wnon-virtual-dtor -Woverloaded-virtual
  -Wdouble-promotion -Wimplicit-fallthrough
  # With optimisation, as in every preset, GCC 12 reports these warnings falsely for strings,
  # Eigen's bounded matrices, vectors and recursions. The sanitizer tests detect real cases. Last
  # option: GCC treats the sources in a unity file as headers with anonymous namespaces.
  "$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-array-bounds;-Wno-stringop-overflow>"
  "$<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overread;-Wno-restrict>"
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${VANTAGE_UNITY}>>:-Wno-subobject-linkage>
  # Message tables are computed at compile time; Clang's step limit is lower than GCC's.
  $<$<CXX_COMPILER_ID:Clang>:-fconstexpr-steps=100000000>
  $<$<BOOL:${VANTAGE_WARNINGS_AS_ERRORS}>:-Werror>)
if(VANTAGE_HARDENED)
  # Equal sources give identical binaries, independent of the source and build folders
  # (test/tools/same_bytes.sh).
  target_compile_options(vantage_build_flags INTERFACE
    -ffile-prefix-map=${PROJECT_BINARY_DIR}=build -ffile-prefix-map=${PROJECT_SOURCE_DIR}=vantage
    -fstack-protector-strong -fstack-clash-protection
    # Protection of jumps and calls, where the processor supports it.
    $<$<BOOL:${is_x86_64}>:-fcf-protection> $<$<BOOL:${is_arm64}>:-mbranch-protection=standard>
    $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE> $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=2>)
  target_link_options(vantage_build_flags INTERFACE -Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)
endif()
if(is_x86_64 AND NOT VANTAGE_PORTABLE)
  # FMA is disabled, because GCC 12 fuses even with -ffp-contract=off if it combines additions and
  # subtractions in one vector.
  target_compile_options(vantage_build_flags INTERFACE -march=x86-64-v3 -mno-fma)
endif()
if(NOT PROJECT_IS_TOP_LEVEL)
  target_include_directories(vantage_build_flags INTERFACE ${PROJECT_SOURCE_DIR})
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    target_compile_options(vantage_build_flags INTERFACE -O3)  # searches are too slow without optimisation
  endif()
endif()

# vantage_precompiled(<name> <header>…): compiles headers once, for target_precompile_headers(…
# REUSE_FROM <name>). Uses CONFIGURE because WRITE would rewrite an unchanged file and so cause a
# complete rebuild.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp
  CONTENT "// carries the precompiled headers\n" @ONLY)
function(vantage_precompiled name)
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  target_link_libraries(${name} PRIVATE vantage_build_flags Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

# Headers that nearly every file includes, and those that tests and commands include in addition.
set(vantage_common_headers
  <algorithm> <cmath> <cstdint> <functional> <map> <memory> <optional> <random> <string> <vector>
  <Eigen/Core> <Eigen/Geometry> <Eigen/LU>)
vantage_precompiled(vantage_precompiled ${vantage_common_headers})
if(VANTAGE_EVERYTHING)
  vantage_precompiled(vantage_precompiled_command
    ${vantage_common_headers} <filesystem> <CLI/CLI.hpp> <nlohmann/json.hpp>)
endif()

# vantage_seal(<target>): allows programs built with any flags to link the target's archive.
set(vantage_seal_command ${CMAKE_COMMAND}
  -D LINKER=${CMAKE_LINKER} -D NM=${CMAKE_NM} -D OBJCOPY=${CMAKE_OBJCOPY} -D AR=${CMAKE_AR})
function(vantage_seal target)
  add_custom_command(TARGET ${target} POST_BUILD
    COMMAND ${vantage_seal_command} -D ARCHIVE=$<TARGET_FILE:${target}>
      -P ${PROJECT_SOURCE_DIR}/cmake/SealArchive.cmake
    VERBATIM)
endfunction()

# vantage_library(<name> UNITS a [HEADERS b.hpp] [SOURCES c.cpp] DEPS vantage::core
#   [PRIVATE_DEPS …])
#
# Creates static library `vantage_<name>` with alias `vantage::<name>`. A unit is a header and the
# source of the same name: a.hpp and a.cpp. Includes are relative to the root
# ("models/sensor/sensor.hpp"); in other projects they begin with vantage/ (VantageInstall). The
# headers are listed so that `all_verify_interface_header_sets` checks that each header compiles
# alone. If only some components are built (VANTAGE_COMPONENTS), a library with missing dependencies
# is not created.
function(vantage_library name)
  cmake_parse_arguments(ARG "" "" "UNITS;HEADERS;SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  foreach(unit IN LISTS ARG_UNITS)
    list(APPEND ARG_HEADERS ${unit}.hpp)
    list(APPEND ARG_SOURCES ${unit}.cpp)
  endforeach()
  if(NOT VANTAGE_EVERYTHING)
    foreach(dependency IN LISTS ARG_DEPS ARG_PRIVATE_DEPS)
      if(NOT TARGET ${dependency})
        return()
      endif()
    endforeach()
  endif()
  if(ARG_SOURCES)
    add_library(vantage_${name} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(vantage_${name}
      PRIVATE ${ARG_PRIVATE_DEPS} $<BUILD_INTERFACE:vantage_build_flags>)
    set_target_properties(vantage_${name}
      PROPERTIES CXX_EXTENSIONS OFF UNITY_BUILD ${VANTAGE_UNITY})
    target_precompile_headers(vantage_${name} REUSE_FROM vantage_precompiled)
    if(NOT PROJECT_IS_TOP_LEVEL)
      vantage_seal(vantage_${name})
    endif()
  else()
    add_library(vantage_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(vantage::${name} ALIAS vantage_${name})
  if(PROJECT_IS_TOP_LEVEL)
    set(includes ${PROJECT_SOURCE_DIR})
  else()
    set(includes ${PROJECT_BINARY_DIR}/include)
    add_dependencies(vantage_${name} vantage_headers)
  endif()
  target_include_directories(vantage_${name} ${scope}
    $<BUILD_INTERFACE:${includes}> $<INSTALL_INTERFACE:include>)
  list(TRANSFORM ARG_HEADERS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set_target_properties(vantage_${name} PROPERTIES VANTAGE_HEADERS "${ARG_HEADERS}")
  if(PROJECT_IS_TOP_LEVEL)
    # The headers have a separate target, because an exported target must not have headers that are
    # installed in a changed form.
    add_library(vantage_${name}_headers INTERFACE)
    target_sources(vantage_${name}_headers
      INTERFACE FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
    target_link_libraries(vantage_${name}_headers INTERFACE vantage_${name})
    set_target_properties(vantage_${name}_headers PROPERTIES CXX_EXTENSIONS OFF)
  endif()
  target_compile_features(vantage_${name} ${scope} cxx_std_20)
  target_link_libraries(vantage_${name} ${scope} ${ARG_DEPS})
endfunction()

# vantage_app(<name> [COMMAND] SOURCES main.cpp DEPS vantage::estimator) -> executable `<name>`
#
# COMMAND: most files of the program use the command-line parser and JSON directly, so the headers
# of both are precompiled. (The parser's header adds ten seconds to the compilation of each file.)
function(vantage_app name)
  cmake_parse_arguments(ARG "COMMAND" "" "SOURCES;DEPS" ${ARGN})
  if(NOT VANTAGE_EVERYTHING)
    return()
  endif()
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF UNITY_BUILD ${VANTAGE_UNITY})
  if(ARG_COMMAND)
    target_precompile_headers(${name} REUSE_FROM vantage_precompiled_command)
  else()
    target_precompile_headers(${name} REUSE_FROM vantage_precompiled)
  endif()
  target_link_libraries(${name} PRIVATE ${ARG_DEPS} vantage_build_flags)
  if(name MATCHES "^vantage(-|$)")
    add_dependencies(vantage_programs ${name})
  endif()
endfunction()
# All commands and the programs that they start; built by tools/demo.
add_custom_target(vantage_programs)

# vantage_process(<name> [UNITS app/node …] [HEADERS …] DEPS vantage::bus) -> library `<name>_node`
# (from app/node by default) and executable `vantage-<name>` (from app/main.cpp): one process of the
# stack.
function(vantage_process name)
  cmake_parse_arguments(ARG "" "" "UNITS;HEADERS;DEPS" ${ARGN})
  if(NOT ARG_UNITS)
    set(ARG_UNITS app/node)
  endif()
  vantage_library(${name}_node UNITS ${ARG_UNITS} HEADERS ${ARG_HEADERS} DEPS ${ARG_DEPS})
  vantage_app(vantage-${name}
    SOURCES app/main.cpp
    DEPS vantage::${name}_node vantage::node_main)
endfunction()

# vantage_test(<room> SOURCES x_test.cpp DEPS vantage::models [LABEL unit] [TIMEOUT 60])
#
# Creates one test executable for the folder <room>. Every TEST() is a ctest entry, named
# <room>.<Suite>.<Case>. The tested code is compiled as for flight. The tests use -O1, which halves
# their compilation time (results are bit-identical: decision 14).
set(vantage_test_options $<$<CONFIG:Release>:-O1>)
function(vantage_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;DEPS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize|--coverage")
    math(EXPR ARG_TIMEOUT "5 * ${ARG_TIMEOUT}")  # the instrumentation slows programs up to tenfold
  elseif(CMAKE_CROSSCOMPILING)
    math(EXPR ARG_TIMEOUT "10 * ${ARG_TIMEOUT}")  # qemu slows programs up to thirtyfold
  endif()
  add_executable(${name}_test ${ARG_SOURCES})
  set_target_properties(${name}_test PROPERTIES CXX_EXTENSIONS OFF)
  if(NOT TARGET vantage_precompiled_test)
    vantage_precompiled(vantage_precompiled_test ${vantage_common_headers} <gtest/gtest.h>)
    target_link_libraries(vantage_precompiled_test PRIVATE GTest::gtest)
    target_compile_options(vantage_precompiled_test PRIVATE ${vantage_test_options})
  endif()
  target_precompile_headers(${name}_test REUSE_FROM vantage_precompiled_test)
  target_compile_options(${name}_test PRIVATE ${vantage_test_options})
  target_link_libraries(${name}_test
    PRIVATE ${ARG_DEPS} GTest::gtest_main vantage_build_flags)
  # Folder next to the checkout with real measurements; tests that need them are skipped without it.
  target_compile_definitions(${name}_test PRIVATE
    VANTAGE_DATA_DIR="${PROJECT_SOURCE_DIR}/../shared/data"
    VANTAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  include(GoogleTest)
  gtest_discover_tests(${name}_test
    TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
