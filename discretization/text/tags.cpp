#include "discretization/text/tags.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <utility>

namespace mixbeam {
namespace {

class TagScanner {
 public:
  explicit TagScanner(const std::string& text) : text_(text) {}

  int line_of_tag_with_more(int most) {
    for (at_ = 0; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') ++line_;
      if (c == '<') {  // even if a quote is not closed
        begin_tag();
      } else if (in_tag_ && quote_ != '\0') {
        if (c == quote_) quote_ = '\0';
      } else if (in_tag_ && c == '>') {
        in_tag_ = false;
      } else if (in_tag_ && (c == '"' || c == '\'')) {
        quote_ = c;
        if (++attributes_ > most) return line_;
      }
    }
    return 0;
  }

 private:
  void begin_tag() {
    in_tag_ = true;
    quote_ = '\0';
    attributes_ = 0;
    for (const auto& [begin, end] : {std::pair{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}})
      if (text_.compare(at_, std::strlen(begin), begin) == 0) return skip_to(end);
  }
  void skip_to(const char* end) {
    const std::size_t found = std::min(text_.find(end, at_), text_.size());
    line_ += static_cast<int>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                         text_.begin() + static_cast<std::ptrdiff_t>(found), '\n'));
    at_ = found;
    in_tag_ = false;
  }

  const std::string& text_;
  std::size_t at_ = 0;
  int line_ = 1, attributes_ = 0;
  bool in_tag_ = false;
  char quote_ = '\0';
};

}  // namespace

std::string xml_escaped(const std::string& text) {
  static const std::map<char, std::string> kEscapes = {{'&', "&amp;"},  {'<', "&lt;"},   {'>', "&gt;"}, {'"', "&quot;"},
                                                       {'\n', "&#10;"}, {'\r', "&#13;"}, {'\t', "&#9;"}};
  std::string result;
  for (const char c : text) {
    const auto escape = kEscapes.find(c);
    result += escape == kEscapes.end() ? std::string(1, c) : escape->second;
  }
  return result;
}

int line_of_tag_with_more(int attributes, const std::string& text) {
  return TagScanner(text).line_of_tag_with_more(attributes);
}

}  // namespace mixbeam
