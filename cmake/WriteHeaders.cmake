# cmake -D SOURCE=dir -D OUTPUT=dir/include -D LIST=file -P WriteHeaders.cmake
#
# The headers named in LIST (one a line, relative to SOURCE), as others include them: below
# OUTPUT/vantage, and including each other from there. Inside, includes are relative to the root,
# whose folders have names that anybody's project may have, too.
cmake_minimum_required(VERSION 3.25)
file(STRINGS "${LIST}" headers)
foreach(header IN LISTS headers)
  file(READ "${SOURCE}/${header}" text)
  string(REGEX REPLACE "#include \"([a-z_]+/)" "#include \"vantage/\\1" text "${text}")
  string(REPLACE "\"vantage/vantage_lcm/" "\"vantage_lcm/" text "${text}")  # has its own folder
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
