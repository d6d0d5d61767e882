# Everything comes from Debian's packages, linked statically where Debian ships an archive, so that the program runs on a
# machine that has none of them.
find_package(Threads REQUIRED)
find_package(Eigen3 REQUIRED)
find_package(Protobuf REQUIRED)
find_package(CLI11 REQUIRED)

# gust_dependency(NAME [HEADER file] [LIBRARIES lib.a...]): an interface target for a package without a usable one.
function(gust_dependency name)
  cmake_parse_arguments(arg "" "HEADER" "LIBRARIES" ${ARGN})
  add_library(${name} INTERFACE)
  if(arg_HEADER)
    find_path(${name}_INCLUDE ${arg_HEADER} REQUIRED)
  endif()
  foreach(library ${arg_LIBRARIES})
    find_library(${name}_${library} ${library} REQUIRED)
    target_link_libraries(${name} INTERFACE ${${name}_${library}})
  endforeach()
  install(TARGETS ${name} EXPORT gust)
endfunction()

find_path(GUST_FMT fmt/format-inl.h REQUIRED)
add_library(gust_fmt STATIC ${PROJECT_SOURCE_DIR}/cmake/fmt.cpp)
install(TARGETS gust_fmt EXPORT gust)
gust_dependency(gust_xxhash HEADER xxhash.h LIBRARIES libxxhash.a)
gust_dependency(gust_json HEADER nlohmann/json.hpp)
gust_dependency(gust_toml HEADER toml++/toml.h)
gust_dependency(gust_sqlite HEADER sqlite3.h LIBRARIES libsqlite3.a)
gust_dependency(gust_zstd HEADER zstd.h LIBRARIES libzstd.a)

# libxsmm ships static and non-PIC-clean symbols under common names: they stay inside whatever links it.
gust_dependency(gust_xsmm HEADER libxsmm.h LIBRARIES libxsmm.a libxsmmnoblas.a)
target_link_libraries(gust_xsmm INTERFACE Threads::Threads ${CMAKE_DL_LIBS} m)
target_link_options(gust_xsmm INTERFACE LINKER:--exclude-libs,libxsmm.a:libxsmmnoblas.a)

# The ONNX schema, compiled from Debian's onnx.proto (it asks for protobuf's lite runtime): #include "onnx/onnx.pb.h".
find_path(GUST_ONNX_SCHEMA onnx/onnx.proto REQUIRED)
set(onnx_pb ${PROJECT_BINARY_DIR}/generated/onnx/onnx.pb)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/generated/onnx)
add_custom_command(
  OUTPUT ${onnx_pb}.cc ${onnx_pb}.h
  COMMAND ${Protobuf_PROTOC_EXECUTABLE} -I ${GUST_ONNX_SCHEMA} --cpp_out=${PROJECT_BINARY_DIR}/generated onnx/onnx.proto
  DEPENDS ${GUST_ONNX_SCHEMA}/onnx/onnx.proto
  VERBATIM)
add_library(gust_onnx_proto STATIC ${onnx_pb}.cc ${onnx_pb}.h)
target_include_directories(gust_onnx_proto SYSTEM PUBLIC $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>)
find_library(GUST_PROTOBUF_LITE libprotobuf-lite.a REQUIRED)
target_link_libraries(gust_onnx_proto PUBLIC ${GUST_PROTOBUF_LITE} Threads::Threads)
if(GUST_SANITIZE)
  target_compile_options(gust_onnx_proto PRIVATE -fsanitize=${GUST_SANITIZE})
endif()
install(TARGETS gust_onnx_proto EXPORT gust)
