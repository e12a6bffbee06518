#include "discretization/text/message_text.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

TEST(NamePattern, StarsStandForAnyCharacters) {
  for (const std::string name : {"strut 1", "strut 12", "strut "}) EXPECT_TRUE(matches("strut *", name)) << name;
  for (const std::string name : {"strut", "Strut 1", "a strut 1", ""}) EXPECT_FALSE(matches("strut *", name)) << name;
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("**", "x"));
  EXPECT_TRUE(matches("a*b*c", "a b b c"));
  EXPECT_FALSE(matches("a*b*c", "a b b c d"));
  EXPECT_TRUE(matches("*.*", "1.2"));
  EXPECT_TRUE(matches("*aab", "aaaab"));  // the star must give way more than once
  EXPECT_FALSE(matches("", "a"));
  EXPECT_TRUE(matches("a?", "ab"));
  EXPECT_TRUE(matches("?c",
                      "\xc3\xa4"
                      "c"));  // one letter of two bytes
  EXPECT_FALSE(matches("a?", "a"));
  EXPECT_FALSE(matches("a?", "abc"));
  for (const std::string name : {"leg 1", "leg 3", "leg 5", "leg 6"}) EXPECT_TRUE(matches("leg [135-7]", name)) << name;
  for (const std::string name : {"leg 2", "leg 8", "leg 13", "leg "})
    EXPECT_FALSE(matches("leg [135-7]", name)) << name;
  EXPECT_TRUE(matches("*[ab]?", "xxbay"));
  for (const std::string name : {"leg 2", "leg 8", "leg !"}) EXPECT_TRUE(matches("leg [!135-7]", name)) << name;
  for (const std::string name : {"leg 3", "leg 6", "leg 22"}) EXPECT_FALSE(matches("leg [!135-7]", name)) << name;
  EXPECT_FALSE(matches("leg [1-5]", "leg -"));  // the - of a range is no character of the list, others are
  for (const std::string name : {"leg -", "leg 1", "leg 5"}) EXPECT_TRUE(matches("leg [-15]", name)) << name;
  EXPECT_TRUE(matches("[\u00e0-\u00e4]", "\u00e2"));  // letters of two bytes
  EXPECT_FALSE(matches("[\u00e0-\u00e4]", "\u00e9"));
  EXPECT_TRUE(matches("a[!]", "a!"));
  EXPECT_TRUE(matches("a[", "a["));  // never closed, or empty: nothing special
  EXPECT_TRUE(matches("a[]", "a[]"));
  EXPECT_FALSE(has_wildcard("a[] ]"));
  EXPECT_TRUE(has_wildcard("a[b]"));
}

TEST(NamePattern, TakesNoExponentialTime) {
  std::string pattern;
  for (int i = 0; i < 50; ++i) pattern += "a*";
  EXPECT_FALSE(matches(pattern + "b", std::string(2000, 'a')));
}

TEST(NamePattern, AnExactNameMeansItself) {
  const std::vector<std::string> names = {"leg 1", "leg *", "leg 2"};
  EXPECT_EQ(names_meant("leg *", names), (std::vector<std::string>{"leg *"}));
  EXPECT_EQ(names_meant("leg*", names), names);
  EXPECT_TRUE(names_meant("leg", names).empty());
}

}  // namespace
}  // namespace mixbeam
