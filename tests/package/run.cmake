# One way of using the library, from nothing: the project in the folder WAY is configured, built and run.
#     cmake -DWAY=find_package -DREPOSITORY=<sources> -DBUILD=<build folder> -DSCRATCH=<folder> -DOPTIONS=<list> -P run.cmake
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
if(WAY MATCHES "find_package|components")
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/prefix)
endif()
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/${WAY} -B ${SCRATCH}/build -DMOTIONLANG=${REPOSITORY}
    -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix ${OPTIONS})
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)
run(${SCRATCH}/build/user)
