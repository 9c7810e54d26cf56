# cmake -D SOURCE=dir -D VERSION=0.1.0 -D OUTPUT=version.cpp -P WriteVersion.cmake
#
# Writes the version for logs and experiments, for example "0.1.0+359adcb.changed-5c1e0f2a". The
# text consists of the project's version and, in a checkout, of the last commit that changed the
# built files and a hash of uncommitted changes, if any. Runs at every build; writes the file only
# if it changes.
find_program(git_program git)
set(built . ":!docs" ":!test" ":!*.md")

function(ask_git answer)
  set(text "")
  if(git_program)
    execute_process(
      COMMAND ${git_program} -C ${SOURCE} ${ARGN}
      OUTPUT_VARIABLE text OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  endif()
  set(${answer} "${text}" PARENT_SCOPE)
endfunction()

set(version_text "${VERSION}")
ask_git(commit log -1 --format=%h -- ${built})
if(commit)
  string(APPEND version_text "+${commit}")
  ask_git(changed diff HEAD --no-ext-diff --binary -- ${built})
  ask_git(unknown ls-files --others --exclude-standard -- ${built})
  string(REPLACE "\n" ";" unknown "${unknown}")
  foreach(name IN LISTS unknown)
    if(EXISTS "${SOURCE}/${name}")
      file(SHA1 "${SOURCE}/${name}" hash)
      string(APPEND changed "${name} ${hash}\n")
    endif()
  endforeach()
  if(changed)
    string(SHA1 hash "${changed}")
    string(SUBSTRING ${hash} 0 8 hash)
    string(APPEND version_text ".changed-${hash}")
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT [[
#include "trial/observe/announcer.hpp"

std::string vantage::trial::version() { return "@version_text@"; }
]] @ONLY)
