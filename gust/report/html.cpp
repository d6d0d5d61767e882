#include "gust/report/html.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "gust/core/error.h"

namespace gust {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

struct Symbol {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  // none: not well-formed
};

/// The symbol at the front of a text that is not empty, by table 3-7 of the Unicode standard.
Symbol front_symbol(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return {};
  std::uint32_t code = first & (0xFF >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3F);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (overlong || surrogate || code > 0x10FFFF) return {};
  return {code, length};
}

/// Whether a symbol may hide or reorder its neighbours.
bool misleads(std::uint32_t code) {
  if (code < 0x20) return code != '\t' && code != '\n';
  if (code >= 0x7F && code < 0xA0) return true;
  return (code >= 0x200E && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069) || code == 0xFEFF;
}

}  // namespace

std::string clean_text(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const auto [code, bytes] = front_symbol(text);
    const std::size_t taken = std::max<std::size_t>(bytes, 1);
    const bool line_end = text.substr(0, 2) == "\r\n";
    if (bytes > 0 && !misleads(code)) {
      out += text.substr(0, bytes);
    } else if (!line_end) {
      out += kReplacement;
    }
    text.remove_prefix(taken);
  }
  return out;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : clean_text(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string decimal(double value, double scale) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  const double size = std::abs(scale);
  if (std::isfinite(size) && size > 0 && (size >= 1e6 || size < 1e-4)) return format("{:.2e}", value);
  const double digits = std::isfinite(size) && size > 0 ? 2 - std::floor(std::log10(size)) : 2;
  std::string text = fmt::format("{:.{}f}", value, static_cast<int>(std::clamp(digits, 0.0, 6.0)));
  if (text.find_first_not_of("-0.") == std::string::npos && text.front() == '-') text.erase(0, 1);
  if (text.front() == '-') text.replace(0, 1, "−");
  return text;
}

std::string interval_text(const Page::Estimate& estimate, double scale) {
  if (!(estimate.low < estimate.high)) return "";
  return cat("[", decimal(estimate.low, scale), ", ", decimal(estimate.high, scale), "]");
}

std::string short_number(double value) {
  if (!std::isfinite(value)) return decimal(value, 1);
  std::string text = format("{:.3g}", value);
  if (text.front() == '-') text.replace(0, 1, "−");
  return text;
}

std::string unit_html(const std::string& unit) {
  if (unit.empty()) return "";
  return unit.find(',') == unit.npos ? cat("&nbsp;", escaped(unit)) : cat(" (", escaped(unit), ")");
}

std::string percent(double share) { return format("{:.0f} %", 100 * share); }

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return cat(count, " ", count == 1 ? one : many);
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t j = 0; j < 3; ++j) word = word << 8 | (j < count ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) out += j <= count ? kDigits[word >> (18 - 6 * j) & 63] : '=';
  }
  return out;
}

}  // namespace gust
