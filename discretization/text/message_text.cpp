#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <sstream>

namespace mixbeam {
namespace {

constexpr std::size_t kLongestText = 100;
constexpr std::size_t kLongestComparedName = 200;  // the comparison takes time and memory in proportion to the length

/// Whether a byte begins a character of UTF-8, whose later bytes are 10xxxxxx.
bool is_first_byte(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }

std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  return text;
}

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

/// Synonyms of other programs: a name in scenes, then what others call it (- for a blank).
const char* const kOtherWords[] = {
    "start: begin from first node1 node-1 start-point start-node i points nodes",
    "end: to last node2 node-2 end-point end-node finish j",
    "point: node vertex at joint location",
    "points: nodes vertices coordinates",
    "member: beam bar rod strut element line edge",
    "members: beams bars rods struts frames lines edges",
    "section: profile cross-section property properties",
    "sections: profiles cross-sections properties materials",
    "supports: boundary-conditions boundaries bcs constraints restraints fixities bearings",
    "joints: releases hinges connections",
    "point loads: loads load nodal-loads node-loads forces",
    "distributed loads: line-loads member-loads beam-loads uniform-loads",
    "gravity: self-weight selfweight weight dead-load",
    "eigenstrains: temperature-loads temperatures thermal-loads",
    "force: load q p f value fx fy fz",
    "moment: m mx my mz",
    "hinge: pin pinned revolute",
    "displacement stiffness: k spring spring-stiffness",
    "fixed displacement: fixed fix dofs",
    "e: young youngs-modulus young's-modulus modulus elastic-modulus emod",
    "nu: poisson poissons-ratio poisson's-ratio poisson-ratio v mu",
    "g: shear-modulus",
    "density: rho mass-density",
    "strength: yield yield-strength yield-stress fy",
    "diameter: radius r d dia outer-diameter",
    "wall: thickness wall-thickness t",
    "width: b breadth",
    "height: h depth",
    "elements: divisions number-of-elements mesh n",
    "order: degree",
    "second axis: orientation roll up local-axis",
    "component: direction axis",
    "quantity: kind type",
    "kind: type",
    "shape: kind type",
    "displacement: deflection translation sag",
    "material force: section-force internal-force axial-force normal-force shear-force",
    "material moment: section-moment internal-moment bending-moment twisting-moment torque",
    "number: count",
    "name: nr no no. id label number",
    "double: float real number",
    "int: integer long",
    "string: text str",
    "bool: boolean logical",
    "array(double): vector array list"};

/// Converts to lower case, and Python's underscores to blanks.
std::string plain_words(const std::string& name) {
  std::string words = lower_case(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

/// The candidate that others call `name`; empty if there is none.
std::string translated(const std::string& name, const std::vector<std::string>& candidates) {
  static const std::multimap<std::string, std::string> names = [] {
    std::multimap<std::string, std::string> all;
    for (const std::string line : kOtherWords) {
      const std::size_t colon = line.find(':');
      std::istringstream words(line.substr(colon + 1));
      for (std::string word; words >> word;) {
        std::replace(word.begin(), word.end(), '-', ' ');
        all.emplace(word, line.substr(0, colon));
      }
    }
    return all;
  }();
  const auto [first, last] = names.equal_range(plain_words(name));
  for (auto meant = first; meant != last; ++meant)
    for (const std::string& candidate : candidates)
      if (plain_words(candidate) == meant->second) return candidate;
  return "";
}

/// Whether `candidate` contains `words` as whole words: `frequency` in `natural frequency`.
bool has_words(const std::string& candidate, const std::string& words) {
  return (" " + lower_case(candidate) + " ").find(" " + words + " ") != std::string::npos;
}

/// Whether one abbreviates the other: `boolean` for `bool`, `disp` for `displacement`.
bool one_begins_with_the_other(const std::string& a, const std::string& b) {
  constexpr std::size_t kShortestBeginning = 3;
  const std::size_t common = std::min(a.size(), b.size());
  return common >= kShortestBeginning && a.compare(0, common, b, 0, common) == 0;
}

/// Index behind the bracket that closes the one at `i`; 0 if none does or nothing stands between them.
std::size_t end_of_choice(const std::string& pattern, std::size_t i) {
  const std::size_t close = pattern.find(']', i + 1);
  return close == std::string::npos || close == i + 1 ? 0 : close + 1;
}

/// Bytes of the character in UTF-8 that begins at `i`.
std::size_t bytes_of_character(const std::string& text, std::size_t i) {
  std::size_t bytes = 1;
  while (i + bytes < text.size() && (static_cast<unsigned char>(text[i + bytes]) & 0xC0U) == 0x80U) ++bytes;
  return bytes;
}

/// Whether characters and ranges such as a-z list a character; bytes of UTF-8 have the order of the characters. A - at
/// an end of the list represents itself.
bool lists(const std::string& choice, const std::string& character) {
  for (std::size_t i = 0; i < choice.size();) {
    const std::string first = choice.substr(i, bytes_of_character(choice, i));
    i += first.size();
    const bool is_range = i + 1 < choice.size() && choice[i] == '-';
    const std::string last = is_range ? choice.substr(i + 1, bytes_of_character(choice, i + 1)) : first;
    if (is_range) i += 1 + last.size();
    if (first <= character && character <= last) return true;
  }
  return false;
}

/// Bytes of the pattern at `p` and of the name at `n` that match each other, `*` excluded; zeros: no match.
std::pair<std::size_t, std::size_t> fitting(const std::string& pattern, std::size_t p, const std::string& name,
                                            std::size_t n) {
  if (p >= pattern.size()) return {0, 0};
  const std::size_t bytes = bytes_of_character(name, n);
  if (pattern[p] == '?') return {1, bytes};
  const std::size_t end = pattern[p] == '[' ? end_of_choice(pattern, p) : 0;
  if (end == 0)
    return pattern[p] == name[n] ? std::make_pair<std::size_t, std::size_t>(1, 1) : std::make_pair(0UL, 0UL);
  const bool is_other = pattern[p + 1] == '!' && end - p > 3;
  const std::size_t begin = p + (is_other ? 2 : 1);
  const bool is_one = lists(pattern.substr(begin, end - begin - 1), name.substr(n, bytes));
  return is_one != is_other ? std::make_pair(end - p, bytes) : std::make_pair(0UL, 0UL);
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
  while (length < text.size() && length > 0 && !is_first_byte(text[length])) --length;
  const std::string beginning = printable(text.substr(0, length));
  return length < text.size() ? beginning + "..." : beginning;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  if (name.size() > kLongestComparedName) return "";
  if (const std::string meant = translated(name, candidates); !meant.empty()) return meant;
  const std::string wanted = lower_case(name);
  // One slip in three letters is a typing error; more is another word.
  const std::size_t most_slips = std::max<std::size_t>(1, (name.size() + 1) / 3);
  std::string nearest;
  std::size_t fewest = most_slips + 1;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > name.size() + most_slips || name.size() > candidate.size() + most_slips) continue;
    const std::size_t slips = edit_distance(wanted, lower_case(candidate));
    const bool goes_on = lower_case(candidate).rfind(wanted, 0) == 0 && lower_case(nearest).rfind(wanted, 0) != 0;
    if ((slips < fewest || (slips == fewest && goes_on)) && slips < std::max(name.size(), candidate.size())) {
      fewest = slips;
      nearest = candidate;
    }
  }
  if (!nearest.empty()) return nearest;
  std::vector<std::string> longer;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(longer),
               [&](const std::string& candidate) { return has_words(candidate, wanted); });
  if (!longer.empty()) return longer.size() == 1 ? longer.front() : "";  // a guess among several misleads
  for (const std::string& candidate : candidates) {
    if (one_begins_with_the_other(wanted, lower_case(candidate))) return candidate;
  }
  return "";
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(name, candidates);
  const bool is_halved = lower_case(name) == "radius" && lower_case(nearest) == "diameter";
  return nearest.empty() ? "" : "; did you mean \"" + nearest + "\"" + (is_halved ? ", twice the radius" : "") + "?";
}

std::size_t offset_of(const std::string& text, int line, int column) {
  std::size_t offset = 0;
  for (; line > 1 && offset < text.size(); ++offset) line -= text[offset] == '\n' ? 1 : 0;
  for (; column > 1 && offset < text.size() && text[offset] != '\n'; --column)
    while (++offset < text.size() && !is_first_byte(text[offset])) {
    }
  return offset;
}

std::string marked_line(const std::string& text, std::size_t offset) {
  constexpr std::size_t kWindow = 100, kBefore = 60;  // bytes shown of a long line, and those before the mark
  offset = std::min(offset, text.size());
  const std::size_t line = offset == 0 ? 0 : text.rfind('\n', offset - 1) + 1;
  const std::size_t end = std::min(text.find('\n', offset), text.size());
  std::size_t from = std::min(text.find_first_not_of(" \t", line), offset);
  if (offset > from + kWindow - kBefore / 2) from = offset - kBefore;
  while (from < offset && !is_first_byte(text[from])) ++from;
  std::size_t to = std::min(from + kWindow, end);
  while (to < end && !is_first_byte(text[to])) ++to;
  const auto columns = std::count_if(text.begin() + static_cast<std::ptrdiff_t>(from),
                                     text.begin() + static_cast<std::ptrdiff_t>(offset), is_first_byte);
  return "\n    " + printable(text.substr(from, to - from)) + "\n    " +
         std::string(static_cast<std::size_t>(columns), ' ') + "^";
}

bool has_wildcard(const std::string& text) {
  if (text.find_first_of("*?") != std::string::npos) return true;
  for (std::size_t i = text.find('['); i != std::string::npos; i = text.find('[', i + 1))
    if (end_of_choice(text, i) > 0) return true;
  return false;
}

bool matches(const std::string& pattern, const std::string& name) {
  // After a mismatch only the last `*` is extended, by one character.
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
