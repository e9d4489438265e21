# cmake -D ROOT=<repository> -P check_layering.cmake
#
# The arrows of docs/architecture.md as a test: fails when a room includes a header of a room it may not know.
cmake_minimum_required(VERSION 3.25)

set(allowed_datasets datasets)
set(allowed_models models)
set(allowed_acquisition acquisition datasets)
set(allowed_fitting fitting models datasets)
set(allowed_reports reports fitting models datasets)
set(allowed_app app reports fitting models acquisition datasets)
set(rooms datasets models acquisition fitting reports app)

set(strangers "")
foreach(room IN LISTS rooms)
  file(GLOB_RECURSE files ${ROOT}/${room}/*.hpp ${ROOT}/${room}/*.cpp)
  foreach(file IN LISTS files)
    file(STRINGS ${file} includes REGEX "^#include \"[a-z_]+/")
    foreach(line IN LISTS includes)
      string(REGEX MATCH "\"([a-z_]+)/" unused ${line})
      if(CMAKE_MATCH_1 IN_LIST rooms AND NOT CMAKE_MATCH_1 IN_LIST allowed_${room})
        string(APPEND strangers "  ${file}: ${line}\n")
      endif()
    endforeach()
  endforeach()
endforeach()

if(strangers)
  message(FATAL_ERROR "an include against the arrows of docs/architecture.md:\n${strangers}")
endif()
