# Files compiled into a library, so that the program needs nothing beside it.

# gust_embed(TARGET HEADER gust/x/y.h FUNCTION name FILES name=path...): generates the header, which declares
# `std::string_view gust::FUNCTION(std::string_view name)`, and its source. An unknown name is a Bug.
function(gust_embed target)
  cmake_parse_arguments(arg "" "HEADER;FUNCTION" "FILES" ${ARGN})
  set(header ${PROJECT_BINARY_DIR}/generated/${arg_HEADER})
  string(REGEX REPLACE "\\.h$" ".cpp" source ${header})
  set(blocks "")
  set(lines "")
  set(paths "")
  set(index 0)
  foreach(file ${arg_FILES})
    string(REGEX MATCH "^([^=]+)=(.+)$" _ ${file})
    set(name ${CMAKE_MATCH_1})
    set(path ${CMAKE_MATCH_2})
    set(symbol gust_${arg_FUNCTION}_${index})
    string(APPEND blocks "asm(\".section .rodata\\n${symbol}: .incbin \\\"${path}\\\"\\n${symbol}_end: .byte 0\\n.text\\n\");\n"
      "extern const char ${symbol}[] asm(\"${symbol}\");\nextern const char ${symbol}_end[] asm(\"${symbol}_end\");\n")
    string(APPEND lines "  if (name == \"${name}\") return {${symbol}, ${symbol}_end};\n")
    list(APPEND paths ${path})
    math(EXPR index "${index} + 1")
  endforeach()
  file(CONFIGURE OUTPUT ${header} CONTENT [[
#pragma once

#include <string_view>

namespace gust {

/// The content of a file that was compiled into the program, by its name; an unknown name is a Bug.
std::string_view @arg_FUNCTION@(std::string_view name);

}  // namespace gust
]] @ONLY)
  file(CONFIGURE OUTPUT ${source} CONTENT [[
#include "@arg_HEADER@"

#include "gust/core/error.h"

@blocks@
namespace gust {

std::string_view @arg_FUNCTION@(std::string_view name) {
@lines@  throw Bug(cat("no embedded file '", name, "'"));
}

}  // namespace gust
]] @ONLY)
  target_sources(${target} PRIVATE ${source})
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS "${paths}")
endfunction()

# gust_embed_assets(TARGET): what a page is made of, as gust::asset(name): the chart libraries ("vega.js", ...), the fonts
# ("inter-latin.woff2", ...), the licences of both ("licences.txt") and our own files in web/ under their names ("replay.js").
function(gust_embed_assets target)
  set(web ${PROJECT_SOURCE_DIR}/web)
  gust_install_node_modules(${web})
  set(files "")
  foreach(library vega vega-lite vega-embed)
    list(APPEND files ${library}.js=${web}/node_modules/${library}/build/${library}.min.js)
  endforeach()
  set(fonts ${web}/node_modules/@fontsource-variable)
  list(APPEND files inter-latin.woff2=${fonts}/inter/files/inter-latin-wght-normal.woff2
                    inter-greek.woff2=${fonts}/inter/files/inter-greek-wght-normal.woff2
                    serif-latin.woff2=${fonts}/source-serif-4/files/source-serif-4-latin-wght-normal.woff2)
  include(${PROJECT_SOURCE_DIR}/gust/report/licences.cmake)
  set(licences ${PROJECT_BINARY_DIR}/generated/gust/report/licences.txt)
  gust_write_licences(${licences} ${web}/node_modules)
  list(APPEND files licences.txt=${licences})
  file(GLOB ours CONFIGURE_DEPENDS RELATIVE ${web} ${web}/*.js ${web}/*.css ${web}/*.html ${web}/*.svg)
  foreach(name ${ours})
    list(APPEND files ${name}=${web}/${name})
  endforeach()
  gust_embed(${target} HEADER gust/report/assets.h FUNCTION asset FILES ${files})
endfunction()

# gust_embed_presets(TARGET): studies/presets/NAME.toml as gust::preset_file("NAME").
function(gust_embed_presets target)
  set(folder ${PROJECT_SOURCE_DIR}/studies/presets)
  file(GLOB names CONFIGURE_DEPENDS RELATIVE ${folder} ${folder}/*.toml)
  list(TRANSFORM names REPLACE "(.+)\\.toml" "\\1=${folder}/\\1.toml" OUTPUT_VARIABLE files)
  gust_embed(${target} HEADER gust/setup/preset_files.h FUNCTION preset_file FILES ${files})
endfunction()

# gust_embed_paper(TARGET): what studies/paper holds, as gust::paper_file("paper.toml").
function(gust_embed_paper target)
  set(folder ${PROJECT_SOURCE_DIR}/studies/paper)
  file(GLOB names CONFIGURE_DEPENDS RELATIVE ${folder} ${folder}/*.toml ${folder}/*.csv ${folder}/*.md)
  list(TRANSFORM names REPLACE "(.+)" "\\1=${folder}/\\1" OUTPUT_VARIABLE files)
  gust_embed(${target} HEADER gust/paper/paper_files.h FUNCTION paper_file FILES ${files})
endfunction()

# Runs npm when the lock file is newer than what is installed.
function(gust_install_node_modules folder)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folder}/package-lock.json)
  set(installed ${folder}/node_modules/.package-lock.json)
  if(NOT ${folder}/package-lock.json IS_NEWER_THAN ${installed})
    return()
  endif()
  find_program(GUST_NPM npm)
  if(NOT GUST_NPM)
    message(FATAL_ERROR "npm is missing: scripts/install-deps")
  endif()
  execute_process(COMMAND ${GUST_NPM} ci --ignore-scripts --no-audit --no-fund WORKING_DIRECTORY ${folder}
                  COMMAND_ERROR_IS_FATAL ANY)
  file(TOUCH ${installed})
endfunction()
