#include "gust/report/json_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "gust/report/html.h"

namespace gust {
namespace {

void write_number(std::string& out, double value) {
  if (std::isnan(value)) {
    out += "null";
  } else if (std::isinf(value)) {
    out += value > 0 ? "1e999" : "-1e999";
  } else if (value == 0) {
    out += '0';
  } else {
    fmt::format_to(std::back_inserter(out), "{:.5g}", value);
  }
}

void write_text(std::string& out, std::string_view text) {
  out += '"';
  for (const char c : clean_text(text)) {
    switch (c) {
      case '"':
        out += "\\\"";
        break;
      case '\\':
        out += "\\\\";
        break;
      case '\n':
        out += "\\n";
        break;
      case '\t':
        out += "\\t";
        break;
      case '<':
        out += "\\u003c";
        break;  // no "</script" and no "<!--" can arise
      default:
        out += c;
    }
  }
  out += '"';
}

}  // namespace

void JsonWriter::separate() {
  if (!out_.empty() && out_.back() != '{' && out_.back() != '[' && out_.back() != ':') out_ += ',';
}

JsonWriter& JsonWriter::open(char bracket) {
  separate();
  out_ += bracket;
  return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
  out_ += bracket;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  separate();
  write_text(out_, name);
  out_ += ':';
  return *this;
}

JsonWriter& JsonWriter::text(std::string_view value) {
  separate();
  write_text(out_, value);
  return *this;
}

JsonWriter& JsonWriter::number(double value) {
  separate();
  write_number(out_, value);
  return *this;
}

JsonWriter& JsonWriter::index(std::size_t value) {
  separate();
  fmt::format_to(std::back_inserter(out_), "{}", value);
  return *this;
}

JsonWriter& JsonWriter::flag(bool value) {
  separate();
  out_ += value ? "true" : "false";
  return *this;
}

JsonWriter& JsonWriter::numbers(std::span<const double> values) {
  open('[');
  for (const double value : values) number(value);
  return close(']');
}

JsonWriter& JsonWriter::raw(std::string_view json) {
  separate();
  out_ += json;
  return *this;
}

}  // namespace gust
