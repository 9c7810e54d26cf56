# vantage_lcm_types(<target> PACKAGE vantage_lcm TYPES a_t b_t)
#
# Runs lcm-gen on <type>.lcm and provides the generated headers as a SYSTEM interface target, so
# that -Wconversion ignores generated code. (Debian's liblcm has no CMake package.)
include_guard()

function(vantage_lcm_types target)
  cmake_parse_arguments(ARG "" "PACKAGE" "TYPES" ${ARGN})
  find_program(LCM_GEN lcm-gen REQUIRED)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/gen)
  set(headers)
  set(sources)
  foreach(type IN LISTS ARG_TYPES)
    set(src ${CMAKE_CURRENT_SOURCE_DIR}/${type}.lcm)
    set(hdr ${out}/${ARG_PACKAGE}/${type}.hpp)
    add_custom_command(
      OUTPUT ${hdr}
      COMMAND ${LCM_GEN} --cpp --cpp-std=c++11 --cpp-hpath ${out} ${src}
      DEPENDS ${src}
      COMMENT "lcm-gen ${type}"
      VERBATIM)
    list(APPEND headers ${hdr})
    list(APPEND sources ${src})
  endforeach()
  add_custom_target(${target}_gen DEPENDS ${headers})
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}_gen)
  set_target_properties(${target} PROPERTIES
    VANTAGE_LCM_SOURCES "${sources}" VANTAGE_LCM_HEADERS ${out})
  target_include_directories(${target} SYSTEM INTERFACE
    $<BUILD_INTERFACE:${out}> $<INSTALL_INTERFACE:include>)
  target_link_libraries(${target} INTERFACE PkgConfig::LCM)
endfunction()
