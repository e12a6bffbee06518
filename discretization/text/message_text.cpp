#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace mixbeam {
namespace {

constexpr std::size_t kLongestText = 100;
constexpr std::size_t kLongestComparedName = 200;  // the comparison takes time and memory in proportion to the length

/// Edit distance with exchanged neighbours (Damerau and Levenshtein, each letter edited at most once).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

/// `boolean` for `bool`, `disp` for `displacement`.
bool one_begins_with_the_other(const std::string& a, const std::string& b) {
  constexpr std::size_t kShortestBeginning = 3;
  const std::size_t common = std::min(a.size(), b.size());
  return common >= kShortestBeginning && a.compare(0, common, b, 0, common) == 0;
}

}  // namespace

std::string quoted_list(const std::vector<std::string>& names, std::size_t most) {
  if (names.empty()) return "(none)";
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) {
    text += (i == 0 ? "\"" : ", \"") + excerpt(names[i]) + "\"";
  }
  if (names.size() > most) text += " and " + std::to_string(names.size() - most) + " more";
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

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  if (name.size() > kLongestComparedName) return "";
  const std::string wanted = lower_case(name);
  // One slip in three letters is a typing error; more is another word.
  const std::size_t most_slips = std::max<std::size_t>(1, (name.size() + 1) / 3);
  std::string nearest;
  std::size_t fewest = most_slips + 1;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > name.size() + most_slips || name.size() > candidate.size() + most_slips) continue;
    const std::size_t slips = edit_distance(wanted, lower_case(candidate));
    if (slips < fewest && slips < std::max(name.size(), candidate.size())) {
      fewest = slips;
      nearest = candidate;
    }
  }
  if (!nearest.empty()) return nearest;
  for (const std::string& candidate : candidates) {
    if (one_begins_with_the_other(wanted, lower_case(candidate))) return candidate;
  }
  return "";
}

namespace {

/// Behind the bracket that closes the one at `i`, 0 if they hold nothing.
std::size_t end_of_choice(const std::string& pattern, std::size_t i) {
  const std::size_t close = pattern.find(']', i + 1);
  return close == std::string::npos || close == i + 1 ? 0 : close + 1;
}

/// Bytes of the pattern at `p` and of the name at `n` that stand for each other, without a `*`; zeros if none do.
std::pair<std::size_t, std::size_t> fitting(const std::string& pattern, std::size_t p, const std::string& name,
                                            std::size_t n) {
  if (p >= pattern.size()) return {0, 0};
  std::size_t bytes = 1;  // of one character in UTF-8
  while (n + bytes < name.size() && (static_cast<unsigned char>(name[n + bytes]) & 0xC0U) == 0x80U) ++bytes;
  if (pattern[p] == '?') return {1, bytes};
  const std::size_t end = pattern[p] == '[' ? end_of_choice(pattern, p) : 0;
  if (end == 0)
    return pattern[p] == name[n] ? std::make_pair<std::size_t, std::size_t>(1, 1) : std::make_pair(0UL, 0UL);
  const std::string choice = pattern.substr(p + 1, end - p - 2);
  bool is_one = choice.find(name.substr(n, bytes)) != std::string::npos;
  for (std::size_t i = 1; i + 1 < choice.size(); ++i)
    is_one = is_one || (choice[i] == '-' && choice[i - 1] <= name[n] && name[n] <= choice[i + 1]);
  return is_one ? std::make_pair(end - p, bytes) : std::make_pair(0UL, 0UL);
}

}  // namespace

std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?";
}

bool has_wildcard(const std::string& text) {
  if (text.find_first_of("*?") != std::string::npos) return true;
  for (std::size_t i = text.find('['); i != std::string::npos; i = text.find('[', i + 1))
    if (end_of_choice(text, i) > 0) return true;
  return false;
}

bool matches(const std::string& pattern, const std::string& name) {
  // After a mismatch only the last `*` has to give way: it takes one character more.
  std::size_t p = 0, n = 0, star = std::string::npos, taken_from = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken_from = n;
    } else if (const auto [in_pattern, in_name] = fitting(pattern, p, name, n); in_pattern > 0) {
      p += in_pattern;
      n += in_name;
    } else if (star != std::string::npos) {
      p = star + 1;
      n = ++taken_from;
    } else {
      return false;
    }
  }
  return std::all_of(pattern.begin() + static_cast<std::ptrdiff_t>(p), pattern.end(), [](char c) { return c == '*'; });
}

std::vector<std::string> names_meant(const std::string& text, const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), text) != names.end()) return {text};
  std::vector<std::string> meant;
  if (!has_wildcard(text)) return meant;
  std::copy_if(names.begin(), names.end(), std::back_inserter(meant),
               [&](const std::string& name) { return matches(text, name); });
  return meant;
}

}  // namespace mixbeam
