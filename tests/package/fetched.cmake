# The packages fetched, as on a system that has none of them: every find_package is switched off, every archive comes from a
# folder. Once with this CMake, once with what FetchContent understands in CMake 3.24, the oldest that the project allows;
# then without archives, which must end in one line that says what is missing and how to get it.
#     cmake -DREPOSITORY=<sources> -DSCRATCH=<folder> -DOPTIONS=<list> "-DPACKAGES=<name|extension|header|folders>..." -P fetched.cmake
#
# The archives are made of the headers that this build has, in the layout that their projects publish: their own would have to
# be fetched over the network.
cmake_minimum_required(VERSION 3.24)

file(REMOVE_RECURSE ${SCRATCH})
set(archives ${SCRATCH}/archives)
file(MAKE_DIRECTORY ${archives} ${SCRATCH}/none)
foreach(package ${PACKAGES})
  string(REPLACE "|" ";" package ${package})
  list(POP_FRONT package name extension header)
  string(REGEX MATCH "^[^/]+" top ${header})
  set(layout ${SCRATCH}/${name}/${name}-1.0/include)
  if(name MATCHES "^(Eigen3|doctest)$")  # their headers are at the root
    set(layout ${SCRATCH}/${name}/${name}-1.0)
  endif()
  foreach(folder ${package})
    if(EXISTS ${folder}/${header})
      file(COPY ${folder}/${top} DESTINATION ${layout})
      break()
    endif()
  endforeach()
  if(NOT EXISTS ${layout}/${header})
    message(FATAL_ERROR "${name}: no ${header} in ${package}")
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -E tar cf ${archives}/${name}${extension} ${name}-1.0
                  WORKING_DIRECTORY ${SCRATCH}/${name} COMMAND_ERROR_IS_FATAL ANY)
  list(APPEND OPTIONS -DCMAKE_DISABLE_FIND_PACKAGE_${name}=ON)
endforeach()

function(configure build archives)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${REPOSITORY} -B ${SCRATCH}/${build} -DMOTIONLANG_ARCHIVES=${archives} ${OPTIONS} ${ARGN}
                  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(status ${status} PARENT_SCOPE)
  set(output "${output}" PARENT_SCOPE)
endfunction()
foreach(build this_cmake cmake_3_24)
  configure(${build} file://${archives} -DCMAKE_MODULE_PATH=${CMAKE_CURRENT_LIST_DIR}/fetched/${build})
  if(status OR output MATCHES "Warning")
    message(FATAL_ERROR "${build}: not configured, or with warnings:\n${output}")
  endif()
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} --build ${SCRATCH}/cmake_3_24 --target package_fetched COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${SCRATCH}/cmake_3_24/tests/package/package_fetched COMMAND_ERROR_IS_FATAL ANY)

configure(without ${SCRATCH}/none)
if(NOT status OR NOT output MATCHES "\n +motionlang: Eigen3 is missing: install it \\(Debian: libeigen3-dev\\), or [^\n]*none/Eigen3.tar.gz[^\n]*\n")
  message(FATAL_ERROR "no line that says which package is missing, and how to get it:\n${output}")
endif()
