#pragma once

#include <string>
#include <string_view>

namespace gust {

/// The 128-bit XXH3 hash of some bytes as 32 hexadecimal digits. It finds damage and names trials; it is not a seal
/// against malice.
std::string hash_hex(std::string_view bytes);

}  // namespace gust
