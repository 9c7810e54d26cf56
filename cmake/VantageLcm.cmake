# vantage_lcm_types(<target> PACKAGE vantage_lcm TYPES a_t b_t)
#
# Runs lcm-gen on <type>.lcm and exposes the generated headers as a SYSTEM interface target, so
# -Wconversion does not read code nobody here wrote. (Debian's liblcm has no CMake package.)
include_guard()
find_program(LCM_GEN lcm-gen REQUIRED)

function(vantage_lcm_types target)
  cmake_parse_arguments(ARG "" "PACKAGE" "TYPES" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/gen)
  set(headers)
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
  endforeach()
  add_custom_target(${target}_gen DEPENDS ${headers})
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}_gen)
  target_include_directories(${target} SYSTEM INTERFACE ${out})
  target_link_libraries(${target} INTERFACE PkgConfig::LCM)
endfunction()
