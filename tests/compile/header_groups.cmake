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

# The headers that the test compiles: a fifth of them, another one with every commit. All of them if the environment has
# EVERY_HEADER, as in the target check_all, or where git does not count commits.
function(headers_of_this_commit variable repository)
  execute_process(COMMAND git -C ${repository} rev-list --count HEAD OUTPUT_VARIABLE commits OUTPUT_STRIP_TRAILING_WHITESPACE
                  ERROR_QUIET)
  set(chosen ${ARGN})
  if(commits MATCHES "^[0-9]+$" AND NOT DEFINED ENV{EVERY_HEADER})
    set(chosen)
    math(EXPR turn "${commits} % 5")
    set(number 0)
    foreach(header ${ARGN})
      math(EXPR its_turn "${number} % 5")
      if(its_turn EQUAL turn)
        list(APPEND chosen ${header})
      endif()
      math(EXPR number "${number} + 1")
    endforeach()
  endif()
  set(${variable} "${chosen}" PARENT_SCOPE)
endfunction()
