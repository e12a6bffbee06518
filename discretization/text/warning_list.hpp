/// Warnings while they are collected.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace mixbeam {

/// Warnings in the order in which they were found, those of a kind cut off after the first few.
class WarningList {
 public:
  /// `kind` names what many warnings have in common: "members that lie on each other".
  void add(const std::string& kind, const std::string& text) {
    if (++count_[kind] <= kMostOfAKind) texts_.push_back(text);
  }

  std::vector<std::string> finished() const {
    std::vector<std::string> all = texts_;
    for (const auto& [kind, count] : count_)
      if (count > kMostOfAKind) all.push_back("... and " + std::to_string(count - kMostOfAKind) + " more " + kind);
    return all;
  }

 private:
  static constexpr std::size_t kMostOfAKind = 5;  // the next ones tell the same story

  std::vector<std::string> texts_;
  std::map<std::string, std::size_t> count_;
};

}  // namespace mixbeam
