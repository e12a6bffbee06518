/// The page of `mixbeam view`: one HTML file that shows a structure in a browser and needs no network. Contains
/// samples, sections, fields, path and modes of a run as arrays (read by viewer/result.js). Positions are relative to
/// the centre of the structure. Samples and steps beyond the limits of a page are thinned out.
#pragma once

#include "discretization/results/sampled_file.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

/// Bits per number.
inline constexpr int kForReading = 15,  ///< displayed values: 16,000 units up to the largest of a column
    kForDrawing = 13,                   ///< directions and modes
    kForPlaces = 22;                    ///< undeformed positions and the path: six digits

/// Rows of numbers.
struct PageRows {
  std::vector<double> values{};
  std::size_t columns = 1;
  std::size_t count() const { return values.size() / columns; }
  const double* row(std::size_t i) const { return values.data() + columns * i; }
};

struct PackedNumbers {
  std::string bytes{};
  std::vector<double> units{};   ///< of each column
  std::vector<double> values{};  ///< as decoded by a reader
};

/// Packs numbers; NaN is kept. `later`, `behind`: the same quantity one and two steps later, from which this one is
/// extrapolated; null: none.
PackedNumbers packed(const PageRows& rows, int bits, const PackedNumbers* later = nullptr,
                     const PackedNumbers* behind = nullptr);

/// Compresses without the header of zlib.
std::string deflated(const std::string& bytes);

std::string base64(const std::string& bytes);

/// Messages about a scene that is not solved.
struct SaidOfScene {
  std::string refusal{};  ///< why a run would refuse it; empty: accepted
  std::vector<std::string> warnings{};
};

/// Limits on the contents of a page.
struct PageLimits {
  std::size_t samples = 100000;
  double bytes = 1.02e6;          ///< packed numbers; base64 adds a third: 1.5 MB in total
  std::size_t fewest_steps = 10;  ///< shown of larger results
};

/// The contents of a page, or of one of several load cases.
struct ViewData {
  std::string scene_name, load_case, title;
  std::vector<std::pair<std::string, std::string>> arrays;  ///< name and deflated bytes; "description" is one of them
  nlohmann::json description;                               ///< words and single numbers
};

/// `said`: of a scene that is not solved. Throws as SampledFile.
ViewData view_data(const SampledFile& run, const std::optional<SaidOfScene>& said = {}, const PageLimits& limits = {});

/// Text of the page of one result file, or of several load cases. `said`: of a scene that is not solved; `parts`:
/// folder of style, markup and scripts; `renew`: seconds between reloads, 0: never. Text from a scene is data, never
/// markup. Throws InputError.
std::string view_page(const std::vector<std::filesystem::path>& files, const std::optional<SaidOfScene>& said,
                      const std::filesystem::path& parts, int renew = 0, const PageLimits& limits = {});

/// Writes a page atomically; replaces only pages. Throws InputError, FileError.
void write_page(const std::filesystem::path& path, const std::string& text);

}  // namespace mixbeam
