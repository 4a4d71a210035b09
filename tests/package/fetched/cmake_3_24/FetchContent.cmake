# Stands in front of CMake's own module: FetchContent_Declare with the words that it knows in CMake 3.24. Others, SYSTEM among
# them, become a part of the option before them there, and must not be used.
include(${CMAKE_ROOT}/Modules/FetchContent.cmake)
function(FetchContent_Declare name)
  foreach(word ${ARGN})
    if(word MATCHES "^[A-Z][A-Z_]+$" AND NOT word MATCHES "^(URL|URL_HASH|SOURCE_DIR|SOURCE_SUBDIR|BINARY_DIR|OVERRIDE_FIND_PACKAGE|FIND_PACKAGE_ARGS)$")
      message(FATAL_ERROR "FetchContent_Declare(${name}): CMake 3.24 does not know ${word}")
    endif()
  endforeach()
  _FetchContent_Declare(${name} ${ARGN})
endfunction()
