# The program that makes the pages which tests/page/ opens in a browser.
if(BUILD_TESTING AND NOT GUST_FUZZ)
  add_executable(page_fixture tests/page/make_fixture.cpp tests/page/fixture.cpp
                              tests/page/reproduction_fixture.cpp)
  target_link_libraries(page_fixture PRIVATE gust_paper)
endif()
