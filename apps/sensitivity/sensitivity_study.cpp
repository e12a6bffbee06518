// Gradients of the elastica against derivatives of elliptic integrals, over orders and meshes, and their cost.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/formatted.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Largest shortfall of the rate 2 k on coarse meshes, and the least error for rates.
constexpr double kMissingRate = 0.5, kSeenRate = 1e-12;
constexpr int kTabulated = 4, kTabulatedElements = 16;
/// Largest errors of derivatives by alpha with 16 elements of order 1 to 4, from a prototype with all unknowns in one
/// matrix.
constexpr double kOfPrototype[kTabulated] = {1e-4, 2e-7, 2e-10, 2e-13};
/// Relative step of the force for differences of the equations.
constexpr double kStep = 0.0005;

/// Derivatives of deflection, shortening and rotation of the end by alpha = P L^2 / EI, from elliptic integrals.
struct Elastica {
  double alpha;
  std::array<double, 3> derivative;
};
constexpr Elastica kElasticas[] = {{1.0, {0.248876443127961, 0.0962778480847484, 0.395682566689845}},
                                   {2.0, {0.142546214828556, 0.102876897296855, 0.253014804550978}},
                                   {10.0, {0.0105359712168047, 0.0215494661654688, 0.0222664098396707}}};
const std::array<const char*, 3> kMotions = {"deflection", "shortening", "rotation"};

QuantitySet motions_of_end(const Scene& scene) {
  std::vector<Quantity> asked(3);
  const std::array<std::array<const char*, 2>, 3> kinds = {
      {{"displacement", "y"}, {"displacement", "x"}, {"rotation", "z"}}};
  for (size_t i = 0; i < asked.size(); ++i) {
    asked[i].name = kMotions[i];
    asked[i].kind = kinds[i][0];
    asked[i].component = kinds[i][1];
    asked[i].point = "end";
  }
  const ParameterSource source;
  return QuantitySet(asked, scene, {source, {"Study"}});
}

/// The force at the end as a number of the scene.
SceneNumber force(const Scene& scene) {
  SceneNumber number{"force", kStep * std::abs(scene.point_loads[0].force[1])};
  number.scene_with = [&scene](double more) {
    Scene moved = scene;
    moved.point_loads[0].force[1] -= more;
    return std::make_shared<const Scene>(std::move(moved));
  };
  return number;
}

Simulation solved(Application& app, const Scene& scene) {
  Simulation simulation = app.solve(scene);
  simulation.polish();
  return simulation;
}

/// Largest errors of the derivatives by alpha, computed by the force and by the compliances of all elements together.
std::array<double, 2> errors_of(Application& app, const Scene& scene, const Elastica& exact) {
  const QuantitySet quantities = motions_of_end(scene);
  const Simulation simulation = solved(app, scene);
  std::array<double, 2> errors{};
  const auto found = simulation.gradients({quantities, {0, 1, 2}, {force(scene)}, true});
  for (size_t i = 0; i < found.size(); ++i) {
    double by_compliance = 0.0;  // S = 1 / EI = 1: alpha dq / d alpha
    for (const std::array<double, 6>& compliance : found[i].compliance) by_compliance += compliance[5];
    const double own[] = {-found[i].derivative[0], -by_compliance / exact.alpha};  // down, back, clockwise
    for (size_t k = 0; k < 2; ++k) errors[k] = std::max(errors[k], std::abs(own[k] - exact.derivative[i]));
  }
  return errors;
}

void run_convergence(Application& app) {
  const std::vector<int> orders = study_list<int>(app, "Orders"), meshes = study_list<int>(app, "Elements");
  StudyTable csv(app, "convergence.csv", words("alpha,by,order,elements,error"));
  ConvergenceTable table("Error of derivatives of the end by P L^2 / EI", meshes, kSeenRate);
  for (const Elastica& exact : kElasticas)
    for (size_t by = 0; by < 2; ++by) {
      const char* number = by == 0 ? "force" : "compliance";
      table.add_group(formatted("P L^2 / EI = %g, by %s", exact.alpha, number));
      for (const int order : orders) {
        std::vector<double> errors;
        for (const int elements : meshes) {
          errors.push_back(errors_of(app, with_loads(with_mesh(app.scene, order, elements), exact.alpha), exact)[by]);
          csv.add_row({exact.alpha, number, order, elements, errors.back()});
          if (elements == kTabulatedElements && order <= kTabulated)
            app.summary.check_upper_bound(
                formatted("alpha %g by %s, k=%d, %d elements", exact.alpha, number, order, elements), errors.back(),
                2.0 * kOfPrototype[order - 1],
                "twice the error of a prototype against derivatives of elliptic integrals");
        }
        if (const std::optional<double> rate = table.add_row(order, errors))
          app.summary.check_upper_bound(
              formatted("alpha %g by %s, k=%d: missing of the rate 2 k", exact.alpha, number, order),
              2.0 * order - *rate, kMissingRate, "theory: quantities at vertices and their gradients fall with h^(2k)");
      }
    }
  table.print(app.out());
}

/// Measures the processor time of gradients of one quantity beside that of the run.
void run_costs(Application& app) {
  app.out() << "\nProcessor time of the gradient of one quantity, order 2\n";
  StudyTable csv(app, "costs.csv", words("elements,numbers by path,numbers by element,run seconds,gradient seconds"),
                 5);
  for (const int elements : study_list<int>(app, "Cost Elements")) {
    const Scene scene = with_mesh(app.scene, 2, elements);
    const QuantitySet quantities = motions_of_end(scene);
    const RunWatch of_run;
    const Simulation simulation = app.solve(scene);
    const double run = of_run.processor_seconds();
    for (const int numbers : study_list<int>(app, "Cost Numbers")) {
      const bool by_element = numbers == 0;
      const RunWatch watch;
      simulation.gradients(
          {quantities, {0}, std::vector<SceneNumber>(static_cast<size_t>(numbers), force(scene)), by_element});
      csv.add_row({elements, numbers, by_element ? 18 * elements : 0, run, watch.processor_seconds()});
    }
  }
}

void run_sensitivity(Application& app) {
  app.solver.threads = 1;
  run_convergence(app);
  run_costs(app);
}

ListSpec sensitivity_spec() {
  ListSpec spec("Gradients of the elastica over orders and meshes, and their costs.");
  spec.add(counts("Orders", {1, 2, 3, 4}, kTabulated, "Element orders."));
  spec.add(counts("Elements", {2, 4, 8, 16}, 1000, "Meshes."));
  spec.add(counts("Cost Elements", {100, 1000}, 1e6, "Meshes of which gradients are timed."));
  spec.add(counts("Cost Numbers", {0, 1, 10, 100}, 1e4, "Numbers of a gradient; 0: those of all elements.", 0));
  return spec;
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(argc, argv, "sensitivity", "gradients of the elastica against elliptic integrals.",
                            mixbeam::sensitivity_spec(), mixbeam::run_sensitivity);
}
