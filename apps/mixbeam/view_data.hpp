/// What the page of `mixbeam view` draws: samples, sections, fields, path and modes of a run, as arrays for a browser
/// (viewer/result.js). Positions are relative to the middle of the structure. A structure of more samples than a page
/// has room for is thinned, and so are steps.
#pragma once

#include "apps/mixbeam/packed_numbers.hpp"
#include "discretization/results/sampled_file.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

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

}  // namespace mixbeam
