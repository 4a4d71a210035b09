# Reads the #include lines of the headers: cmake -DINCLUDE=<repository>/include -P include_lines.cmake
#
#   - a folder includes only itself and folders of a lower level
#   - no header needs itself: with its bodies (.ipp), it comes after all that it includes
#   - a third-party package is named only by the header that wraps it; core/ is spared <iostream> and std::function
#   - motionlang.hpp includes every public header that needs no package
#   - core/error.hpp alone throws and catches
#   - what fwd.hpp declares is defined somewhere
cmake_minimum_required(VERSION 3.24)

set(levels "core" "file tensor geometry" "backend kinematics nn optim" "features text" "loss" "vae diffusion" "compose formats"
           "datasets metrics" "systems" "weights" "search" "view" "train" "generate")
set(level 0)
foreach(folders ${levels})
  string(REPLACE " " ";" folders ${folders})
  foreach(folder ${folders})
    set(level_of_${folder} ${level})
  endforeach()
  math(EXPR level "${level} + 1")
endforeach()

# Pairs: what is included, and the headers that may.
set(rules "^xtensor/"                       "^backend/xtensor.ipp$"
          "^(Eigen|unsupported)/"           "^backend/eigen.ipp$"
          "^nlohmann/json.hpp$"             "^file/json.(hpp|ipp)$"
          "^hnswlib/"                       "^search/vector_graph.ipp$"
          "^mpi.h$"                         "^train/mpi.hpp$"
          "^(xtl|xtensor-blas|doctest)/"    "^$"
          "^motionlang/(motionlang|stmc)\\.hpp$" "^$")

set(problems 0)
macro(problem text)
  message("${text}")
  math(EXPR problems "${problems} + 1")
endmacro()

function(check_motionlang_include header folder included target)
  if(NOT DEFINED level_of_${target})
    problem("${header} includes ${included}: folder ${target} has no level")
  elseif(NOT target STREQUAL folder AND NOT level_of_${target} LESS level_of_${folder})
    problem("${header} (level ${level_of_${folder}}) includes ${included} (level ${level_of_${target}})")
  endif()
  set(problems ${problems} PARENT_SCOPE)
endfunction()

function(check_other_include header folder included)
  if(folder STREQUAL "core" AND included MATCHES "^(iostream|functional)$")
    problem("${header} includes ${included}")
  endif()
  while(rules)
    list(POP_FRONT rules package allowed)
    if(included MATCHES ${package} AND NOT header MATCHES ${allowed})
      problem("${header} includes ${included}")
    endif()
  endwhile()
  set(problems ${problems} PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE headers RELATIVE ${INCLUDE}/motionlang ${INCLUDE}/motionlang/*.hpp ${INCLUDE}/motionlang/*.ipp ${INCLUDE}/motionlang/*.inc)
foreach(header ${headers})
  string(REGEX REPLACE "/.*" "" folder ${header})
  string(REGEX REPLACE "[.][a-z]+$" "" node ${header})
  list(APPEND nodes ${node})
  file(STRINGS ${INCLUDE}/motionlang/${header} lines REGEX "^ *#? *(include|struct|class) ")
  foreach(line ${lines})
    if(line MATCHES "^(struct|class) ([A-Za-z0-9_]+)[^;]* {")
      list(APPEND definitions ${CMAKE_MATCH_2})
    elseif(line MATCHES "# *include *[<\"]motionlang/(([^/>\"]*)/[^>\"]*)" AND header MATCHES "/")
      string(REGEX MATCH "motionlang/(([^/>\"]*)/[^>\"]*)" unused ${line})
      set(included ${CMAKE_MATCH_1})
      check_motionlang_include(${header} ${folder} ${included} ${CMAKE_MATCH_2})
      string(REGEX REPLACE "[.][a-z]+$" "" included ${included})
      list(APPEND included_by_${node} ${included})
    elseif(line MATCHES "# *include *[<\"]([^>\"]*)")
      check_other_include(${header} ${folder} ${CMAKE_MATCH_1})
    endif()
  endforeach()
endforeach()

# Takes away what includes nothing that is left, until nothing changes: circles are left.
list(REMOVE_DUPLICATES nodes)
set(before "none yet")
while(NOT "${nodes}" STREQUAL "${before}")
  set(before "${nodes}")
  foreach(node ${before})
    list(REMOVE_ITEM included_by_${node} ${node})
    set(waits FALSE)
    foreach(included ${included_by_${node}})
      if(included IN_LIST nodes)
        set(waits TRUE)
        break()
      endif()
    endforeach()
    if(NOT waits)
      list(REMOVE_ITEM nodes ${node})
    endif()
  endforeach()
endwhile()
foreach(node ${nodes})
  problem("${node} is in a circle of includes, or includes one: ${included_by_${node}}")
endforeach()

foreach(header ${headers})
  file(STRINGS ${INCLUDE}/motionlang/${header} lines REGEX "^[^/\"]*(throw;|throw [a-z_:]+\\(|catch \\([a-z.])")
  if(lines AND NOT header MATCHES "^core/error.hpp$|^view/detail/(viewer|studio)_page")  # the latter have JavaScript
    problem("${header}: ${lines}")
  endif()
endforeach()

file(STRINGS ${INCLUDE}/motionlang/motionlang.hpp umbrella REGEX "^#include <motionlang/")
foreach(header ${headers})
  if(header MATCHES "^[a-z]+/[a-z0-9_]+\\.hpp$" AND NOT header MATCHES "^(backend|file|formats|datasets|weights|view|train|generate)/|^search/(index_folder|index_shards|kept_index|motion_index_file|search|tmr_search_encoder|vector_graph)"
     AND NOT "#include <motionlang/${header}>" IN_LIST umbrella)
    problem("motionlang.hpp lacks ${header}")
  endif()
endforeach()

file(STRINGS ${INCLUDE}/motionlang/fwd.hpp declarations REGEX "^(struct|class) [A-Za-z0-9_]+;")
foreach(declaration ${declarations})
  string(REGEX REPLACE "^(struct|class) ([A-Za-z0-9_]+).*" "\\2" name ${declaration})
  if(NOT name IN_LIST definitions)
    problem("fwd.hpp declares ${name}, which no header defines")
  endif()
endforeach()

list(LENGTH headers count)
if(problems OR count EQUAL 0)
  message(FATAL_ERROR "${problems} problems in ${count} headers")
endif()
message("${count} headers in order")
