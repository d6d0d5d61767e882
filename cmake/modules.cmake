# One function a kind of target. Sources are globbed: a new file needs no edit here.
if(BUILD_TESTING)
  find_package(doctest REQUIRED)
  find_package(rapidcheck REQUIRED)
  add_library(gust_doctest_main STATIC ${PROJECT_SOURCE_DIR}/tests/doctest_main.cpp)
  target_link_libraries(gust_doctest_main PUBLIC doctest::doctest rapidcheck PRIVATE gust_options)
  target_compile_definitions(gust_doctest_main PUBLIC GUST_TEST_DATA="${PROJECT_SOURCE_DIR}/tests")
  add_custom_target(unit_tests)
endif()

# gust_test(NAME LABEL label SOURCES files USES libraries): a doctest program whose cases are ctest tests, each named by its
# sentence. GUST_TEST_PROGRAMS collects the programs, for the checks that run them in other builds.
function(gust_test name)
  cmake_parse_arguments(arg "" "LABEL" "SOURCES;USES" ${ARGN})
  if(NOT BUILD_TESTING OR NOT arg_SOURCES)
    return()
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE gust_doctest_main ${arg_USES})
  add_dependencies(unit_tests ${name})
  set_property(GLOBAL APPEND PROPERTY GUST_TEST_PROGRAMS ${name})
  set(list ${CMAKE_CURRENT_BINARY_DIR}/${name}_cases.cmake)
  add_custom_command(TARGET ${name} POST_BUILD BYPRODUCTS ${list}
    COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:${name}> -D LABEL=${arg_LABEL} -D LIST=${list}
            -P ${PROJECT_SOURCE_DIR}/cmake/list_cases.cmake
    VERBATIM)
  file(WRITE ${list}.include "if(EXISTS \"${list}\")\n  include(\"${list}\")\nelse()\n  add_test(${name}_not_built ${name})\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${list}.include)
endfunction()

# gust_module(NAME [INTERNAL] [USES public...] [HIDES private...]): library gust_NAME and test program NAME_test from
# gust/NAME. An internal one is not installed. main.cpp belongs to the program, not to the library.
function(gust_module name)
  cmake_parse_arguments(arg "INTERNAL" "" "USES;HIDES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/gust/${name}/*.cpp)
  set(tests ${sources})
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
  list(FILTER sources EXCLUDE REGEX "(_test|/main)\\.cpp$")
  if(sources)
    add_library(gust_${name} STATIC ${sources})
    target_link_libraries(gust_${name} PUBLIC gust_options ${arg_USES} PRIVATE ${arg_HIDES})
  else()
    add_library(gust_${name} INTERFACE)
    target_link_libraries(gust_${name} INTERFACE gust_options ${arg_USES} ${arg_HIDES})
  endif()
  if(NOT arg_INTERNAL)
    set_target_properties(gust_${name} PROPERTIES EXPORT_NAME ${name})
    install(TARGETS gust_${name} EXPORT gust)
  endif()
  gust_test(${name}_test LABEL unit SOURCES ${tests} USES gust_${name} ${arg_HIDES})
endfunction()

# gust_program(NAME MAIN file USES libraries): a program, skipped while its main file does not exist.
function(gust_program name)
  cmake_parse_arguments(arg "" "MAIN" "USES" ${ARGN})
  if(EXISTS ${PROJECT_SOURCE_DIR}/${arg_MAIN})
    add_executable(${name} ${arg_MAIN})
    target_link_libraries(${name} PRIVATE ${arg_USES})
    install(TARGETS ${name})
  endif()
endfunction()

# gust_test_suite(NAME): tests/NAME/*.cpp, the tests that cross modules.
function(gust_test_suite name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${name}/*.cpp)
  gust_test(${name}_test LABEL ${name} SOURCES ${sources} USES gust_cli)
endfunction()

# gust_benchmarks(): one program for each bench/*.cpp, in BUILD/bench; built by the target `benchmarks` only.
function(gust_benchmarks)
  find_package(benchmark QUIET)
  if(NOT benchmark_FOUND)
    return()
  endif()
  add_custom_target(benchmarks)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/bench/*.cpp)
  foreach(source ${sources})
    get_filename_component(stem ${source} NAME_WE)
    add_executable(bench_${stem} EXCLUDE_FROM_ALL ${source})
    target_link_libraries(bench_${stem} PRIVATE gust_cli gust_xsmm benchmark::benchmark benchmark::benchmark_main)
    set_target_properties(bench_${stem} PROPERTIES OUTPUT_NAME ${stem} RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bench)
    add_dependencies(benchmarks bench_${stem})
  endforeach()
endfunction()
