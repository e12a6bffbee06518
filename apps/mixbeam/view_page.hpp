/// The page of `mixbeam view`: one HTML file that shows a structure in a browser and needs no network. What it draws:
/// samples, sections, fields, path and modes of a run, as arrays for a browser (viewer/result.js). Positions are
/// relative to the middle of the structure. A structure of more samples than a page has room for is thinned, and so are
/// steps.
#pragma once

#include "discretization/results/sampled_file.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

/// Bits of a number.
inline constexpr int kForReading = 15,  ///< those that the page shows: 16,000 units up to the largest of a column
    kForDrawing = 13,                   ///< directions and modes
    kForPlaces = 22;                    ///< undeformed positions and the path: six digits

/// PageRows of numbers.
struct PageRows {
  std::vector<double> values{};
  std::size_t columns = 1;
  std::size_t count() const { return values.size() / columns; }
  const double* row(std::size_t i) const { return values.data() + columns * i; }
};

struct PackedNumbers {
  std::string bytes{};
  std::vector<double> units{};   ///< of each column
  std::vector<double> values{};  ///< as a reader gets them
};

/// NaN stays NaN for a reader. `later`: the same quantity in the step behind, from which this one is extrapolated, and
/// in the one behind that; null: there is none.
PackedNumbers packed(const PageRows& rows, int bits, const PackedNumbers* later = nullptr,
                     const PackedNumbers* behind = nullptr);

/// Without the header of zlib.
std::string deflated(const std::string& bytes);

std::string base64(const std::string& bytes);

/// What the program says of a scene that is not solved.
struct SaidOfScene {
  std::string refusal{};  ///< why a run would refuse it; empty: it would not
  std::vector<std::string> warnings{};
};

/// How much a page holds.
struct PageLimits {
  std::size_t samples = 100000;
  double bytes = 1.02e6;          ///< of packed numbers, which base64 makes a third larger: 1.5 MB with all else
  std::size_t fewest_steps = 10;  ///< of larger results
};

/// The contents of a page, or of one of several load cases.
struct ViewData {
  std::string scene_name, load_case, title;
  std::vector<std::pair<std::string, std::string>> arrays;  ///< name and deflated bytes; "description" is one of them
  nlohmann::json description;                               ///< what is said in words and single numbers
};

/// `said`: of a scene that is not solved. Throws as SampledFile.
ViewData view_data(const SampledFile& run, const std::optional<SaidOfScene>& said = {}, const PageLimits& limits = {});

/// The text of a page of one result file, or of those of several load cases. `said`: of a scene that is not solved;
/// `parts`: folder of the page's own style, markup and scripts; `renew`: seconds after which it asks for itself anew,
/// 0: never. What comes from a scene is data in it, never markup. Throws InputError.
std::string view_page(const std::vector<std::filesystem::path>& files, const std::optional<SaidOfScene>& said,
                      const std::filesystem::path& parts, int renew = 0, const PageLimits& limits = {});

/// Only a whole page appears under the name, and replaces nothing but pages. Throws InputError, FileError.
void write_page(const std::filesystem::path& path, const std::string& text);

}  // namespace mixbeam
