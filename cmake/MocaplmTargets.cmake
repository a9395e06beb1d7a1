# Several files of a target are compiled as one, because most of the time goes into the headers that they share: a
# build from nothing takes a third of the time. So no two files of a target may define one name in their anonymous
# namespaces. Off, a change compiles one file: -DMOCAPLM_UNITY=OFF
option(MOCAPLM_UNITY "compile several files of a target at once" ON)
set(MOCAPLM_UNITY_BATCH 12 CACHE STRING "how many")

# What all targets have in common.
function(mocaplm_target name)
  target_compile_options(${name} PRIVATE -Wall -Wextra)
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${MOCAPLM_UNITY} UNITY_BUILD_BATCH_SIZE ${MOCAPLM_UNITY_BATCH})
endfunction()

# mocaplm_library(NAME SOURCES a.cpp ... USES other ...): one directory, one static library.
function(mocaplm_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;USES" ${ARGN})
  add_library(mocaplm_${name} STATIC ${ARG_SOURCES})
  add_library(mocaplm::${name} ALIAS mocaplm_${name})
  target_include_directories(mocaplm_${name} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/mocaplm>)
  target_link_libraries(mocaplm_${name} PUBLIC ${ARG_USES})
  mocaplm_target(mocaplm_${name})
endfunction()

# mocaplm_test(DIRECTORY [USES lib ...]): the files tests/DIRECTORY/*_test.cpp are one executable, tests_DIRECTORY.
# Each file is a ctest entry "DIRECTORY.name" and a process of its own; those ending in _slow_test.cpp carry the
# label "slow".
function(mocaplm_test directory)
  cmake_parse_arguments(ARG "" "" "USES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${directory}/*_test.cpp)
  string(REPLACE "/" "_" prefix ${directory})
  set(target tests_${prefix})
  add_executable(${target} ${sources})
  target_include_directories(${target} PRIVATE ${CMAKE_SOURCE_DIR} ${CMAKE_SOURCE_DIR}/tests)
  target_compile_definitions(${target} PRIVATE
    MOCAPLM_SOURCE_DIR="${CMAKE_SOURCE_DIR}" MOCAPLM_BINARY_DIR="${CMAKE_BINARY_DIR}")
  target_link_libraries(${target} PRIVATE ${ARG_USES} mocaplm_test_main)
  mocaplm_target(${target})
  # -O3 buys nothing where nothing is computed, and takes a fifth longer.
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O2>)
  foreach(source ${sources})
    get_filename_component(stem ${source} NAME_WE)
    string(REGEX REPLACE "_test$" "" short ${stem})
    add_test(NAME ${prefix}.${short} COMMAND ${target} --file=${stem}.cpp)
    set_tests_properties(${prefix}.${short} PROPERTIES TIMEOUT 300)
    if(stem MATCHES "_slow_test$")
      set_tests_properties(${prefix}.${short} PROPERTIES LABELS slow TIMEOUT 1800)
    endif()
  endforeach()
endfunction()
