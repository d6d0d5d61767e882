#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gust {

/// The files in which an ONNX file keeps its weights, if not in itself: their bytes by the names that it gives them.
/// The reader opens no file; whoever does, looks in the folder of the ONNX file alone.
using OnnxData = std::map<std::string, std::string>;

inline constexpr std::size_t kOnnxBytes = std::size_t{64} << 20;       ///< largest ONNX file
inline constexpr std::size_t kOnnxDataBytes = std::size_t{128} << 20;  ///< most bytes of all data files of a policy

/// The data files that an ONNX file names, sorted and each once; none if the bytes are no ONNX file. An Error that
/// starts with `name` for one that is not the plain name of a file beside it: a path, "..", or a name with control
/// characters.
std::vector<std::string> onnx_data_files(std::string_view bytes, std::string_view name);

}  // namespace gust
