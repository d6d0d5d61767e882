#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gust {

/// A part of a page that its bar leads to.
struct Section {
  std::string id;      ///< HTML; fit for an address
  std::string link;    ///< in the bar; HTML
  std::string title;   ///< HTML
  std::string body;    ///< HTML
  std::string over{};  ///< HTML of a line above the title; may be empty
};

/// A page about to be written: one HTML file that needs nothing else, for scripts, styles, fonts and licences go
/// inside.
///
/// A dataset (data_html) stands in the element that holds the figures which are drawn from it.
struct Document {
  std::string name;               ///< text
  std::size_t places = 0;         ///< of policies: so many have a colour
  std::string style;              ///< CSS after that of all pages
  std::string hero;               ///< HTML: what stands first
  std::vector<Section> sections;  ///< the first is where a reader may skip to
  std::string data;               ///< HTML: the dataset of all sections, where they have none of their own
};

std::string document_html(const Document& document);

/// JSON as a dataset for the page's scripts.
std::string data_html(std::string_view json, std::string_view id = "");

/// Sentences that are HTML already.
std::string list_html(std::span<const std::string> sentences, std::string_view kind);

/// Texts that the reader must see first, a paragraph each.
std::string warnings_html(std::span<const std::string> warnings);

}  // namespace gust
