# SPDX-License-Identifier: Apache-2.0
# Sources that are compiled together. Most of the time of a small source goes into its includes and into templates that its
# neighbours instantiate, too; one compilation of several of them takes about half (docs/decisions/0123-source-batches.md). An edit compiles
# its whole batch again: who works on the code may turn batches off. Names in unnamed namespaces must then differ among the sources
# of a room of the library; functions of one name and different parameters become overloads of each other.
option(AUREOLE_BATCHES "Compile several sources of a room at once" ON)

# Sets `result` to what is to be compiled for the sources that follow, which lie below `root`, a folder for #include: one file for up to
# `most` of each room (the folders below src/aureole), or just the sources where batches are off.
function(aureole_batches result name root most)
  if(NOT AUREOLE_BATCHES)
    set(${result} ${ARGN} PARENT_SCOPE)
    return()
  endif()
  aureole_group_sources(groups "^[^/]*/[^/]*/" ${root} ${most} ${ARGN})
  set(batches)
  foreach(group ${groups})
    set(text "// Made by tools/batches.cmake.\n")
    foreach(source ${sources_of_${group}})
      string(APPEND text "#include \"${source}\"\n")
    endforeach()
    set(batch ${CMAKE_BINARY_DIR}/batches/${name}/${group}.cpp)
    file(CONFIGURE OUTPUT ${batch} CONTENT "${text}" @ONLY)
    list(APPEND batches ${batch})
  endforeach()
  set(${result} ${batches} PARENT_SCOPE)
endfunction()

# Batches of commands, tests and bindings, of any folders, whose unnamed namespaces are put into a namespace of each file, since their functions have
# the same names everywhere (tools/batch_sources.py).
function(aureole_separated_batches result name root most)
  if(NOT AUREOLE_BATCHES)
    set(${result} ${ARGN} PARENT_SCOPE)
    return()
  endif()
  find_package(Python3 3.9 REQUIRED COMPONENTS Interpreter)
  aureole_group_sources(groups "" ${root} ${most} ${ARGN})
  set(batches)
  foreach(group ${groups})
    set(batch ${CMAKE_BINARY_DIR}/batches/${name}/${group}.cpp)
    set(sources ${sources_of_${group}})
    list(TRANSFORM sources PREPEND ${root}/ OUTPUT_VARIABLE paths)
    add_custom_command(OUTPUT ${batch} COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/batch_sources.py ${batch} ${root} ${sources}
      DEPENDS ${PROJECT_SOURCE_DIR}/tools/batch_sources.py ${paths} WORKING_DIRECTORY ${CMAKE_BINARY_DIR} VERBATIM)
    list(APPEND batches ${batch})
  endforeach()
  set(${result} ${batches} PARENT_SCOPE)
endfunction()

# Sets `result` to names of groups, and sources_of_NAME to the sources of each, relative to `root`. Sources of one group have the same
# beginning that matches `room`; where that is empty, any.
function(aureole_group_sources result room root most)
  set(groups)
  foreach(source ${ARGN})
    file(RELATIVE_PATH source ${root} ${source})
    set(name)
    if(room)
      string(REGEX MATCH "${room}" name "${source}")
    endif()
    string(MAKE_C_IDENTIFIER "batch_${name}" name)
    math(EXPR part "${count_${name}} + 0")
    math(EXPR count_${name} "${part} + 1")
    math(EXPR part "${part} / ${most}")
    set(group ${name}_${part})
    list(APPEND groups ${group})
    list(APPEND sources_of_${group} ${source})
    set(sources_of_${group} ${sources_of_${group}} PARENT_SCOPE)
  endforeach()
  list(REMOVE_DUPLICATES groups)
  set(${result} ${groups} PARENT_SCOPE)
endfunction()
