/// Pieces of error messages that stay readable whatever the user wrote.
#pragma once

#include <string>
#include <vector>

namespace mixbeam {

/// `"Start", "End", "Section"`; a long list is cut and says how many names were left out.
std::string quoted_list(const std::vector<std::string>& names);

/// The text itself, or its beginning when it is longer than a line; control characters become spaces.
std::string excerpt(const std::string& text);

}  // namespace mixbeam
