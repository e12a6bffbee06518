#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <cstddef>

namespace mixbeam {
namespace {

constexpr std::size_t kLongestList = 24;  // more names than this do not help a reader
constexpr std::size_t kLongestText = 100;

}  // namespace

std::string quoted_list(const std::vector<std::string>& names) {
  if (names.empty()) return "(none)";
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kLongestList); ++i) {
    text += (i == 0 ? "\"" : ", \"") + excerpt(names[i]) + "\"";
  }
  if (names.size() > kLongestList) text += " and " + std::to_string(names.size() - kLongestList) + " more";
  return text;
}

std::string excerpt(const std::string& text) {
  std::size_t length = std::min(text.size(), kLongestText);
  // Not in the middle of a UTF-8 character: its later bytes are 10xxxxxx.
  while (length < text.size() && length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U) --length;
  std::string beginning = text.substr(0, length);
  std::replace_if(
      beginning.begin(), beginning.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  return length < text.size() ? beginning + "..." : beginning;
}

}  // namespace mixbeam
