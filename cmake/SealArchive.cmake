# cmake -D ARCHIVE=libvantage_x.a -D LINKER=ld -D NM=nm -D OBJCOPY=objcopy -D AR=ar -P
# SealArchive.cmake
#
# Merges an archive into one object and makes its template instances and inline functions (mostly
# Eigen's) local. These functions have the same names for all compiler flags, and a linker keeps only
# one copy of each. Without sealing, a program built with -mavx2 would share them with libraries built
# with EIGEN_DONT_VECTORIZE, and one of the two would call code that was compiled for another
# alignment (docs/decisions/0010). Sealing an archive again has no effect.
cmake_minimum_required(VERSION 3.25)
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code ERROR_VARIABLE error_text OUTPUT_QUIET)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "sealing ${ARCHIVE}: ${ARGN}: ${error_text}")
  endif()
endfunction()

set(object "${ARCHIVE}.o")
set(shared_names "${ARCHIVE}.names")
# A linker keeps one copy of each section group; --force-group-allocation makes groups plain sections.
run(${LINKER} -r --force-group-allocation -o "${object}" --whole-archive "${ARCHIVE}")
execute_process(
  COMMAND ${NM} --defined-only --format=posix "${object}"
  OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
# Symbol types of nm. V, W: defined and weak; u: unique in the process.
string(REGEX MATCHALL "[^\n ]+ [VWu] " shared "${symbols}")
list(TRANSFORM shared REPLACE " . $" "")
# Virtual tables and type information of vantage's classes are weak even if only one file has them;
# they contain no code, so they are excluded.
list(FILTER shared EXCLUDE REGEX "^_ZT[VTIS]N7vantage")
list(JOIN shared "\n" shared)
file(WRITE "${shared_names}" "${shared}\n")
run(${OBJCOPY} "--weaken-symbols=${shared_names}" "${object}")  # unique symbols cannot be made local
run(${OBJCOPY} "--localize-symbols=${shared_names}" "${object}")
file(REMOVE "${ARCHIVE}")
run(${AR} qcs "${ARCHIVE}" "${object}")
file(REMOVE "${object}" "${shared_names}")
