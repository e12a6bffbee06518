/// Starting a program of the build as a user does.
#pragma once

#include "tests/support/files.hpp"
#include "tests/support/text.hpp"

#include <cstdlib>
#include <string>

namespace mixbeam {

/// Output of a command that ends well.
inline std::string output_of(const std::string& command) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  EXPECT_EQ(std::system((command + " > " + out.string()).c_str()), 0) << command;
  return text_of(out);
}

const std::string kMixbeam = std::string(MIXBEAM_BIN_DIR) + "/mixbeam ";

}  // namespace mixbeam
