# The tests that are not C++: rules of the tree, Python programs, sanitizer builds, fuzzing. Each is a ctest test with a label.
if(NOT BUILD_TESTING OR NOT GUST_FULL_CHECK)
  return()
endif()
get_property(programs GLOBAL PROPERTY GUST_TEST_PROGRAMS)
get_property(unit_programs GLOBAL PROPERTY GUST_UNIT_TEST_PROGRAMS)

# gust_check(NAME LABEL label SECONDS limit COMMAND ...)
function(gust_check name)
  cmake_parse_arguments(arg "" "LABEL;SECONDS" "COMMAND" ${ARGN})
  add_test(NAME ${name} COMMAND ${arg_COMMAND} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS ${arg_LABEL} TIMEOUT ${arg_SECONDS} COST ${arg_SECONDS})
endfunction()

gust_check("every file is formatted" LABEL style SECONDS 60 COMMAND scripts/check-format)
gust_check("every include follows the layers" LABEL style SECONDS 60 COMMAND scripts/check-layers)
gust_check("files, functions and subjects of commits are short" LABEL style SECONDS 60 COMMAND scripts/check-sizes)
gust_check("every citation points to a section" LABEL style SECONDS 60 COMMAND scripts/check-citations)
gust_check("documents and messages are in plain words" LABEL style SECONDS 60 COMMAND scripts/check-words)
list(TRANSFORM programs REPLACE "(.+)" "$<TARGET_FILE:\\1>" OUTPUT_VARIABLE program_files)
gust_check("every oracle has a test" LABEL style SECONDS 60 COMMAND scripts/check-oracles ${program_files})
if(TARGET gust)
  gust_check("the catalogue page is what the program says" LABEL style SECONDS 60
             COMMAND scripts/make-docs --check $<TARGET_FILE:gust>)
endif()

# Under the sanitizers without those tests that learn or simulate for minutes: shorter ones run the same code.
set(learning "8.3.7*,8.5.5*,8.6.2*,8.6.3*,8.6.6*,8.7.2*,8.7.3*,8.7.4*,8.7.5*,8.7.6*,*learns to hold*")
set(simulating "with as many episodes*,a paired difference covers*,the interval of a margin covers*,what is computed from shares*")
foreach(program ${unit_programs})
  gust_check("${program} is clean under the sanitizers" LABEL sanitizers SECONDS 1200
             COMMAND ${PROJECT_SOURCE_DIR}/build/asan/${program} --no-intro --test-case-exclude=${learning},${simulating})
endforeach()

file(GLOB fuzzers RELATIVE ${PROJECT_SOURCE_DIR}/fuzz CONFIGURE_DEPENDS fuzz/fuzz_*.cpp)
foreach(source ${fuzzers})
  get_filename_component(target ${source} NAME_WE)
  gust_check("${target} survives a minute" LABEL fuzz SECONDS 180 COMMAND scripts/fuzz-one 60 ${target})
endforeach()

# GUST_BENCH_ONCE makes the loads of those that take minutes small; 0 s are one iteration.
file(GLOB benchmarks RELATIVE ${PROJECT_SOURCE_DIR}/bench CONFIGURE_DEPENDS bench/*.cpp)
foreach(source ${benchmarks})
  get_filename_component(stem ${source} NAME_WE)
  if(TARGET bench_${stem})
    gust_check("bench/${stem} runs for one iteration" LABEL bench SECONDS 120
               COMMAND ${CMAKE_COMMAND} -E env GUST_BENCH_ONCE=1 $<TARGET_FILE:bench_${stem}> --benchmark_min_time=0)
  endif()
endforeach()

file(GLOB scripts RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS tests/*/test_*.py)
foreach(script ${scripts})
  string(REGEX REPLACE "^tests/([^/]+)/.*" "\\1" label ${script})
  gust_check(${script} LABEL ${label} SECONDS 600 COMMAND build/venv/bin/python -m pytest -q -p no:cacheprovider ${script})
  set_tests_properties(${script} PROPERTIES
    ENVIRONMENT "GUST=${PROJECT_BINARY_DIR}/gust;GUST_BUILD=${PROJECT_BINARY_DIR};PYTHONDONTWRITEBYTECODE=1")
endforeach()
