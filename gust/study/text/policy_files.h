#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "gust/onnx/data.h"

namespace gust {

/// The content of a policy's file; see read_file. One that ends in .onnx has at most kOnnxBytes.
std::string read_policy_file(const std::filesystem::path& path);

/// The data files that an ONNX file names (`bytes` is its content), from the folder in which it lies; none if it names
/// none, or the path does not end in .onnx. Where the path is a link and that folder lacks them, from the folder that
/// the link leads to.
///
/// An Error that names the ONNX file for data files that are not there, that are no regular files, that a link leads
/// out of the folder, or that have more than kOnnxDataBytes together.
OnnxData read_onnx_data(const std::filesystem::path& path, std::string_view bytes);

}  // namespace gust
