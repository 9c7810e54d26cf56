# cmake -D SOURCE=dir -D OUTPUT=dir/include -D LIST=file -D PUBLIC=file -P WriteHeaders.cmake
#
# Copies the headers named in LIST (one per line, relative to SOURCE) to OUTPUT/vantage and prefixes
# their includes with vantage/. In the sources, includes are relative to the root; its folder names
# could conflict with those of other projects. Headers that are not named in PUBLIC are marked as internal.
cmake_minimum_required(VERSION 3.25)
file(STRINGS "${LIST}" headers)
file(STRINGS "${PUBLIC}" public_headers)
set(mark "// Internal header of vantage: it may change in any version. docs/reference/headers.md lists the\n"
  "// public headers.\n")
string(CONCAT mark ${mark})
foreach(header IN LISTS headers)
  file(READ "${SOURCE}/${header}" text)
  string(REGEX REPLACE "#include \"([a-z_]+/)" "#include \"vantage/\\1" text "${text}")
  string(REPLACE "\"vantage/vantage_lcm/" "\"vantage_lcm/" text "${text}")  # installed in a separate folder
  if(NOT header IN_LIST public_headers)
    string(PREPEND text "${mark}")
  endif()
  set(old)
  if(EXISTS "${OUTPUT}/vantage/${header}")
    file(READ "${OUTPUT}/vantage/${header}" old)
  endif()
  if(NOT text STREQUAL old)
    file(WRITE "${OUTPUT}/vantage/${header}" "${text}")
  endif()
endforeach()
file(GLOB_RECURSE written RELATIVE "${OUTPUT}/vantage" "${OUTPUT}/vantage/*")
foreach(header IN LISTS written)
  if(NOT header IN_LIST headers)
    file(REMOVE "${OUTPUT}/vantage/${header}")
  endif()
endforeach()
