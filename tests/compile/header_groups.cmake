# Sorts headers into groups that share a precompiled header: header_groups(<variable> <include folder> <headers...>)
#
# A header is compiled behind another one only if it includes that one itself, directly or through others. So nothing is
# there that the header does not bring along, and what it forgets to include is still missing: "alone" stays true, but
# what most headers include is read once for all of them.
set(header_group_leaders  # a header belongs to the first one that it includes
    motionlang/nn/multihead_attention.hpp motionlang/file/json.hpp motionlang/tensor/fused.hpp
    motionlang/kinematics/forward.hpp motionlang/tensor/ops.hpp motionlang/core/shape.hpp)

# Property included_by_<header>: every header of the library that it includes, directly or through others.
function(motionlang_included_by include header)
  get_property(known GLOBAL PROPERTY included_by_${header} SET)
  if(known)
    return()
  endif()
  set_property(GLOBAL PROPERTY included_by_${header} "")
  set(all)
  file(STRINGS ${include}/${header} lines REGEX "^#include <motionlang/.*[.]hpp>")
  foreach(line ${lines})
    string(REGEX MATCH "motionlang/[^>]+" included ${line})
    motionlang_included_by(${include} ${included})
    get_property(further GLOBAL PROPERTY included_by_${included})
    list(APPEND all ${included} ${further})
  endforeach()
  list(REMOVE_DUPLICATES all)
  set_property(GLOBAL PROPERTY included_by_${header} "${all}")
endfunction()

# Returns "<number of the leader, or `alone`>:<header>" for every header.
function(header_groups variable include)
  set(groups)
  foreach(header ${ARGN})
    motionlang_included_by(${include} ${header})
    get_property(included GLOBAL PROPERTY included_by_${header})
    set(group alone)
    set(number 0)
    foreach(leader ${header_group_leaders})
      if(group STREQUAL "alone" AND leader IN_LIST included)
        set(group ${number})
      endif()
      math(EXPR number "${number} + 1")
    endforeach()
    list(APPEND groups ${group}:${header})
  endforeach()
  set(${variable} "${groups}" PARENT_SCOPE)
endfunction()

# The headers that the test compiles: what the last 30 commits changed, what is not committed, and a fifth of the
# others, another one with every commit. It is all of them if the environment has EVERY_HEADER, or where git does not
# know the commits before.
function(headers_of_this_commit variable repository)
  set(git git -C ${repository})
  set(quietly OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${git} rev-list --count HEAD OUTPUT_VARIABLE commits ${quietly})
  execute_process(COMMAND ${git} diff --name-only --diff-filter=d HEAD~30 OUTPUT_VARIABLE changed ${quietly}
                  RESULT_VARIABLE unknown)
  set(chosen ${ARGN})
  if(unknown EQUAL 0 AND NOT DEFINED ENV{EVERY_HEADER})
    set(chosen)
    string(REGEX REPLACE "[.]ipp" ".hpp" changed "${changed}")
    string(REPLACE "\n" ";" changed "${changed}")
    set(number ${commits})
    foreach(header ${ARGN})
      math(EXPR turn "${number} % 5")
      if(turn EQUAL 0 OR include/${header} IN_LIST changed)
        list(APPEND chosen ${header})
      endif()
      math(EXPR number "${number} + 1")
    endforeach()
  endif()
  set(${variable} "${chosen}" PARENT_SCOPE)
endfunction()
