# onnx_run: lets the Python tests run a network the way the program does.
if(BUILD_TESTING)
  add_executable(onnx_run tests/python/onnx_run.cpp)
  target_link_libraries(onnx_run PRIVATE gust_nn gust_study)
endif()
