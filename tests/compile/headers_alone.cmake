# Compiles the chosen headers alone:
# cmake -DINCLUDE=<repository>/include -DBUILD=<build folder> -DGROUPS=<groups of the last configuration>
#       -P headers_alone.cmake
#
# Configures again if other headers are chosen, or one has moved to another group since.
cmake_minimum_required(VERSION 3.24)
include(${CMAKE_CURRENT_LIST_DIR}/header_groups.cmake)

file(GLOB_RECURSE headers RELATIVE ${INCLUDE} ${INCLUDE}/*.hpp)
headers_of_this_commit(headers ${INCLUDE} ${headers})
header_groups(groups ${INCLUDE} ${headers})
file(READ ${GROUPS} configured)
if(NOT groups STREQUAL configured)
  execute_process(COMMAND ${CMAKE_COMMAND} ${BUILD} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --target headers_alone --parallel 2
                COMMAND_ERROR_IS_FATAL ANY)
