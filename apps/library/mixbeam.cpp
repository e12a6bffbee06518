#include "apps/library/mixbeam.hpp"

#include "apps/common/session/mpi_session.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/python/solved_run.hpp"
#include "discretization/parameters/parameter_file.hpp"

namespace mixbeam {

SolvedScene::SolvedScene(const std::string& scene, const std::string& results, const std::string& load_case) {
  start_as_guest();
  run_ = std::make_unique<SolvedRun>(read_parameters(scene, mixbeam_root_spec()), std::nullopt, false);
  const std::optional<std::string> wanted = load_case.empty() ? std::nullopt : std::optional(load_case);
  run_->solve(meant_case(run_->app().scene, wanted), results, {});
}

SolvedScene::SolvedScene(SolvedScene&&) noexcept = default;
SolvedScene::~SolvedScene() = default;

double SolvedScene::load_factor() const { return run_->steps().back().report.load_factor; }

std::array<double, 3> SolvedScene::displacement(const std::string& point) const {
  return run_->at(-1).displacement(point);
}

std::array<double, 3> SolvedScene::rotation(const std::string& point) const { return run_->at(-1).rotation(point); }

std::map<std::string, double> SolvedScene::quantities() const {
  std::map<std::string, double> values;
  for (const FollowedQuantity& quantity : run_->app().summary.quantities) values[quantity.name] = quantity.value;
  return values;
}

std::string SolvedScene::report() const { return run_->report(); }

}  // namespace mixbeam
