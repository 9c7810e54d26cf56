# vantage_libm.o: musl's sin, exp, log10, … as part of vantage_core. They come from Debian's package
# musl-dev, which is compiled for any processor of the architecture. Results are bit-identical,
# independent of compiler, flags, processor, architecture and C library (docs/decisions/0014). For
# log and pow, only musl's tables are used; log_pow.cpp computes these functions.
find_file(MUSL_LIBRARY libc.a
  PATHS /usr/lib/${CMAKE_SYSTEM_PROCESSOR}-linux-musl /usr/lib/musl/lib NO_DEFAULT_PATH)
if(NOT MUSL_LIBRARY)
  message(FATAL_ERROR "core/ needs musl's libc.a (Debian: musl-dev; or tools/setup), so that sin, exp, log "
    "give identical results everywhere; -DVANTAGE_OWN_LIBM=OFF uses the system's functions")
endif()
set(functions
  sin cos tan asin acos atan atan2 exp exp2 expm1 log10 log1p hypot erf)
set(parts
  __cos __math_divzero __math_invalid __math_oflow __math_uflow __math_xflow __rem_pio2
  __rem_pio2_large __sin __tan exp_data log_data pow_data)
set(members ${functions} ${parts})
list(TRANSFORM members APPEND .lo)
set(renamed)
set(kept)
foreach(function IN LISTS functions ITEMS erfc)
  list(APPEND renamed --redefine-sym ${function}=vantage_${function})
  list(APPEND kept --keep-global-symbol=vantage_${function})
endforeach()
foreach(table log=log pow_log=pow exp=exp)
  string(REGEX MATCH "(.*)=(.*)" whole ${table})
  list(APPEND renamed --redefine-sym __${CMAKE_MATCH_1}_data=vantage_${CMAKE_MATCH_2}_tables)
  list(APPEND kept --keep-global-symbol=vantage_${CMAKE_MATCH_2}_tables)
endforeach()
set(libm_object ${CMAKE_CURRENT_BINARY_DIR}/vantage_libm.o)
set(work ${CMAKE_CURRENT_BINARY_DIR}/libm_members)
file(MAKE_DIRECTORY ${work})
add_custom_command(
  OUTPUT ${libm_object}
  COMMAND ${CMAKE_AR} x ${MUSL_LIBRARY} ${members}
  COMMAND ${CMAKE_LINKER} -r -o all.o ${members}
  COMMAND ${CMAKE_OBJCOPY} ${renamed} all.o
  COMMAND ${CMAKE_OBJCOPY} ${kept} all.o ${libm_object}
  DEPENDS ${MUSL_LIBRARY}
  WORKING_DIRECTORY ${work}
  COMMENT "Extracting sin, exp, log, … from musl"
  VERBATIM)
set_source_files_properties(${libm_object}
  PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
target_sources(vantage_core PRIVATE ${libm_object} libm/log_pow.cpp)
# Separate, because names.h declares the functions with attributes for callers.
set_source_files_properties(libm/log_pow.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
