# gust with a loop that is no plant: the tests run its commands.
if(BUILD_TESTING AND NOT GUST_FUZZ)
  add_executable(gust_with_thermostat gust/cli/main.cpp tests/loop/thermostat.cpp tests/loop/drift.cpp
                                      tests/loop/loop_sources.cpp)
  target_link_libraries(gust_with_thermostat PRIVATE gust_cli)
endif()
