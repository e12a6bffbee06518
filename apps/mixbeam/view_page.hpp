/// The page of `mixbeam view`: one HTML file that shows a structure in a browser and needs no network.
#pragma once

#include "apps/mixbeam/view_data.hpp"

#include <filesystem>

namespace mixbeam {

/// The text of a page of one result file, or of those of several load cases. `said`: of a scene that is not solved;
/// `parts`: folder of the page's own style, markup and scripts; `renew`: seconds after which it asks for itself anew,
/// 0: never. What comes from a scene is data in it, never markup. Throws InputError.
std::string view_page(const std::vector<std::filesystem::path>& files, const std::optional<SaidOfScene>& said,
                      const std::filesystem::path& parts, int renew = 0, const PageLimits& limits = {});

/// Only a whole page appears under the name, and replaces nothing but pages. Throws InputError, FileError.
void write_page(const std::filesystem::path& path, const std::string& text);

}  // namespace mixbeam
