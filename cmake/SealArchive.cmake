# cmake -D ARCHIVE=libvantage_x.a -D LINKER=ld -D NM=nm -D OBJCOPY=objcopy -D AR=ar -P SealArchive.cmake
#
# Makes one object of an archive and hides in it what the compiler made of templates and inline
# functions, Eigen's above all. Such functions have the same names whatever flags they were compiled
# with, and a linker keeps one of each: without this a program built with -mavx2 would share them
# with libraries built with EIGEN_DONT_VECTORIZE, and either side would call code that was made for
# the other's alignment (docs/decisions/0010). Sealing twice changes nothing.
cmake_minimum_required(VERSION 3.25)
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code ERROR_VARIABLE said OUTPUT_QUIET)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "sealing ${ARCHIVE}: ${ARGN}: ${said}")
  endif()
endfunction()

set(object "${ARCHIVE}.o")
set(shared_names "${ARCHIVE}.names")
# Groups are what a linker keeps one of; with the option they become plain sections.
run(${LINKER} -r --force-group-allocation -o "${object}" --whole-archive "${ARCHIVE}")
execute_process(
  COMMAND ${NM} --defined-only --format=posix "${object}"
  OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
# V, W: defined and weak; u: one in the whole process.
string(REGEX MATCHALL "[^\n ]+ [VWu] " shared "${symbols}")
list(TRANSFORM shared REPLACE " . $" "")
# Tables of our own classes are weak even where one file alone has them; they hold no code.
list(FILTER shared EXCLUDE REGEX "^_ZT[VTIS]N7vantage")
list(JOIN shared "\n" shared)
file(WRITE "${shared_names}" "${shared}\n")
run(${OBJCOPY} "--weaken-symbols=${shared_names}" "${object}")  # or unique ones stay so
run(${OBJCOPY} "--localize-symbols=${shared_names}" "${object}")
file(REMOVE "${ARCHIVE}")
run(${AR} qcs "${ARCHIVE}" "${object}")
file(REMOVE "${object}" "${shared_names}")
