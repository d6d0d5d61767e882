# What every target is compiled with. The floating-point flags are part of the interface: with others the headers' inline
# arithmetic would give other bits. The warnings are ours alone.
option(GUST_WERROR "Treat warnings as errors; for developers, a newer compiler has new ones" OFF)
set(GUST_SANITIZE "" CACHE STRING "Sanitizers for everything, e.g. address,undefined")

add_library(gust_options INTERFACE)
target_compile_features(gust_options INTERFACE cxx_std_20)
target_compile_options(gust_options INTERFACE
  -march=x86-64-v3 -ffp-contract=off -fno-math-errno -fno-trapping-math
  $<BUILD_INTERFACE:-Wall> $<BUILD_INTERFACE:-Wextra> $<BUILD_INTERFACE:-Wno-missing-field-initializers>)
target_include_directories(gust_options INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
if(GUST_WERROR)
  target_compile_options(gust_options INTERFACE $<BUILD_INTERFACE:-Werror>)
endif()
if(GUST_SANITIZE)
  set(flags -fsanitize=${GUST_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_options(gust_options INTERFACE ${flags})
  target_link_options(gust_options INTERFACE ${flags})
endif()
if(GUST_FUZZ)
  target_compile_options(gust_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

configure_file(gust/core/version.h.in generated/gust/core/version.h @ONLY)
