/// Looking into what a program says.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mixbeam {

inline void expect_in(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << "missing: " << part << "\nin: " << text;
}

/// `text` with the first `from` after the place of `after` replaced; a test that changes nothing would prove nothing.
inline std::string changed(std::string text, const std::string& from, const std::string& to,
                           const std::string& after = "") {
  const std::size_t start = text.find(after);
  const std::size_t place = start == std::string::npos ? start : text.find(from, start);
  EXPECT_NE(place, std::string::npos) << "the scene does not contain: " << after << " ... " << from;
  return place == std::string::npos ? text : text.replace(place, from.size(), to);
}

}  // namespace mixbeam
