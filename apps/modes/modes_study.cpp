// Natural frequencies of straight rods against closed forms: rates of convergence over orders and meshes.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/formatted.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/constants.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

constexpr double kRigid = std::numeric_limits<double>::infinity();
/// Stiffness of suppressed deformations.
constexpr double kStiff = 1e6;
/// A body at the end, and a beam with shear and rotary inertia.
constexpr double kBody = 1.0, kBodyInertia = 0.1, kShear = 100.0, kInertia = 0.005;
/// Rounding of omega^2, relative; rates are evaluated for errors above a hundred times this.
constexpr double kRounding = 2e-12;
/// Largest shortfall of the rate 2 k on coarse meshes.
constexpr double kMissingRate = 0.5;
/// Limit of omega^2 of rigid motions over the first elastic one.
constexpr double kRigidMotion = 1e-12;
/// Number of orders in the tables below.
constexpr int kTabulated = 4;

/// Errors with 8 elements of order 1 to 4, of which twice is allowed: from another program (all unknowns in one matrix,
/// dense eigenvalues); zero: not tabulated.
using Tabulated = std::array<double, kTabulated>;

struct Reference {
  std::string name;
  double squared = 0.0;  ///< omega^2
  Tabulated tabulated{};
};

/// A rod, the number of its modes to compute, and the references.
struct Case {
  std::string name;
  int modes = 0, rigid = 0;  ///< rigid: number of leading modes with omega zero
  bool in_plane = true;
  std::vector<Reference> references{};
  void (*change)(Scene& cantilever) = nullptr;
  Scene scene{};
};

/// Roots of f in ascending order, from sign changes on a fine grid.
std::vector<double> roots(const std::function<double(double)>& f, double from, int count) {
  constexpr double kStep = 1e-2;
  constexpr int kHalvings = 60;
  std::vector<double> found;
  for (double a = from; static_cast<int>(found.size()) < count; a += kStep) {
    double low = a, high = a + kStep;
    if (f(low) * f(high) > 0.0) continue;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      (f(low) * f(middle) <= 0.0 ? high : low) = middle;
    }
    found.push_back(0.5 * (low + high));
  }
  return found;
}

double fourth(double x) { return x * x * x * x; }

/// Both omega^2 of a hinged Timoshenko beam with n half waves, EI = m = L = 1: roots of a quadratic equation.
std::array<double, 2> timoshenko(int n, double shear, double inertia) {
  const double b = n * kPi, sum = shear * b * b + (b * b + shear) / inertia, product = shear * fourth(b) / inertia;
  const double larger = 0.5 * (sum + std::sqrt(sum * sum - 4.0 * product));
  return {product / larger, larger};
}

/// Determinant of the end conditions of a cantilever with a body at its end.
double with_body(double beta, double mass, double inertia) {
  const double c = std::cos(beta), s = std::sin(beta), ch = std::cosh(beta), sh = std::sinh(beta);
  // w = A (cos - cosh) + B (sin - sinh); w'' = J beta^4 w', w''' = -m beta^4 w at the end
  const auto row = [&](double w, double slope, double moment, double force) {
    const double b3 = beta * beta * beta;
    return std::array<double, 2>{moment - inertia * b3 * slope, force + mass * beta * w};
  };
  const auto of_a = row(c - ch, -s - sh, -c - ch, s - sh), of_b = row(s - sh, c - ch, -s - sh, -c - ch);
  return (of_a[0] * of_b[1] - of_a[1] * of_b[0]) / (ch * ch);
}

Support hinge(const std::string& point, bool slides) {
  return support_of(point, {!slides, true, true}, {true, true, false});
}

std::vector<Reference> bending(const std::vector<double>& beta, const std::vector<Tabulated>& tabulated) {
  std::vector<Reference> all;
  for (size_t i = 0; i < beta.size(); ++i)
    all.push_back(
        {"bending " + std::to_string(i + 1), fourth(beta[i]), i < tabulated.size() ? tabulated[i] : Tabulated{}});
  return all;
}

void clamp_end(Scene& s) { s.supports.push_back(support_of("end", {true, true, true}, {true, true, true})); }
void hinge_ends(Scene& s) { s.supports = {hinge("start", false), hinge("end", true)}; }
void free_ends(Scene& s) { s.supports.clear(); }
void stretch(Scene& s) {
  s.sections[0].axial_stiffness = 1.0;
  s.sections[0].bending_stiffness = {kStiff, kStiff};
}
void twist(Scene& s) {
  s.sections[0].rotary_inertia = {1.0, 0.5, 0.5};
  s.sections[0].bending_stiffness = {kStiff, kStiff};
}
void add_body(Scene& s) { s.point_masses.push_back({"end", kBody, {kBodyInertia, kBodyInertia, kBodyInertia}}); }
void shear(Scene& s) {
  hinge_ends(s);
  s.sections[0].shear_stiffness = {kShear, kShear};
  s.sections[0].rotary_inertia = {kInertia, 0.0, kInertia};
}

std::vector<Case> cases_of(const Scene& cantilever) {
  const auto cosines = [](double sign, double from, int count) {
    return roots([sign](double x) { return std::cos(x) + sign / std::cosh(x); }, from, count);
  };
  const auto body = [](double x) { return with_body(x, kBody, kBodyInertia); };
  const auto beams = [](int n) { return timoshenko(n, kShear, kInertia); };
  const double axial = 0.25 * kPi * kPi;
  std::vector<Case> cases{
      {"cantilever", 3, 0, true,
       bending(cosines(1.0, 1.0, 3), {{2e-3, 8e-6, 8e-10, 7e-13}, {}, {1e-1, 2e-3, 1e-5, 7e-8}})},
      {"clamped at both ends", 2, 0, true, bending(cosines(-1.0, 4.0, 2), {{}, {1e-1, 2e-3, 1e-5, 7e-8}}), clamp_end},
      {"hinged", 2, 0, true, bending({kPi, 2.0 * kPi}, {}), hinge_ends},
      {"free", 5, 3, true, bending(cosines(-1.0, 4.0, 2), {}), free_ends},
      {"axial", 1, 0, true, {{"axial 1", axial, {3e-3, 2e-6, 6e-10, 9e-14}}}, stretch},
      {"torsion", 1, 0, false, {{"torsion 1", axial, {3e-3, 2e-6, 6e-10, 9e-14}}}, twist},
      {"body at the end", 2, 0, true,
       bending(roots(body, 0.2, 2), {{6e-4, 1e-6, 4e-11, 2e-14}, {5e-3, 7e-6, 6e-9, 2e-12}}), add_body},
      {"hinged, Timoshenko",
       14,
       0,
       true,
       {{"n = 1", beams(1)[0]},
        {"n = 3", beams(3)[0]},
        {"second spectrum, n = 1", beams(1)[1]},
        {"omega^2 = GA/J", kShear / kInertia}},
       shear}};
  for (Case& one : cases) {
    one.scene = cantilever;
    if (one.change != nullptr) one.change(one.scene);
  }
  return cases;
}

std::vector<RecordedVibrationMode> modes_of(Application& app, const Case& one, int order, int elements) {
  SolverParameters parameters = app.solver;
  parameters.threads = 1;
  return Simulation(with_mesh(one.scene, order, elements), parameters, app.communicator)
      .vibration_modes(one.modes, one.in_plane, 2);
}

/// omega^2 nearest to a reference.
double nearest(const std::vector<RecordedVibrationMode>& modes, double squared) {
  double best = 0.0;
  for (const RecordedVibrationMode& mode : modes)
    if (std::abs(mode.eigenvalue - squared) < std::abs(best - squared)) best = mode.eigenvalue;
  return best;
}

void check_rigid(Application& app, const Case& one, const std::string& label,
                 const std::vector<RecordedVibrationMode>& modes) {
  for (int i = 0; i < one.rigid; ++i)
    app.summary.check_upper_bound(
        label + ": rigid motion " + std::to_string(i + 1) + ", omega^2 over the first elastic",
        std::abs(modes[i].eigenvalue) / modes[one.rigid].eigenvalue, kRigidMotion,
        "requirement: motions without strain have no frequency");
}

void run_modes_study(Application& app) {
  const std::vector<int> orders = study_list<int>(app, "Orders"), meshes = study_list<int>(app, "Elements");
  if (orders.back() > kTabulated) throw InputError("Study / Orders: allowed: 1 to 4");
  StudyTable csv(app, "convergence.csv", words("case,mode,order,elements,omega squared,reference,error,rate"));
  for (const Case& one : cases_of(app.scene)) {
    app.out() << one.name << ": relative error of omega^2 (rate)\n";
    for (const int order : orders) {
      std::vector<double> before(one.references.size(), 0.0);
      for (size_t m = 0; m < meshes.size(); ++m) {
        const std::string label = formatted("%s, k=%d, %d elements", one.name.c_str(), order, meshes[m]);
        const std::vector<RecordedVibrationMode> modes = modes_of(app, one, order, meshes[m]);
        app.summary.check_upper_bound(
            label + ": modes that are not confirmed",
            static_cast<double>(
                std::count_if(modes.begin(), modes.end(), [](const auto& mode) { return !mode.confirmed; })),
            0.0, "requirement: the inertia counts them");
        check_rigid(app, one, label, modes);
        app.out() << formatted("  k=%d %4d elements", order, meshes[m]);
        for (size_t r = 0; r < one.references.size(); ++r) {
          const Reference& reference = one.references[r];
          const double found = nearest(modes, reference.squared), error = std::abs(found / reference.squared - 1.0);
          const double rate = m == 0 ? 0.0 : std::log(before[r] / error) / std::log(double(meshes[m]) / meshes[m - 1]);
          app.out() << formatted("  %s %.1e", reference.name.c_str(), error)
                    << (m > 0 ? formatted(" (%.1f)", rate) : "");
          csv.add_row({one.name, reference.name, order, meshes[m], found, reference.squared, error, rate});
          const double tabulated = reference.tabulated[order - 1];
          if (meshes[m] == 8 && tabulated > 0.0)
            app.summary.check_upper_bound(label + ", " + reference.name, error, std::max(2.0 * tabulated, kRounding),
                                          "twice the error of a prototype with dense eigenvalues");
          if (m + 1 == meshes.size())
            app.summary.check_upper_bound(label + ", " + reference.name + ": missing of the rate 2 k",
                                          error > kRounding && before[r] > 1e2 * kRounding ? 2.0 * order - rate : 0.0,
                                          kMissingRate, "theory: the error of omega^2 falls with h^(2k)");
          before[r] = error;
        }
        app.out() << "\n";
      }
    }
  }
}

/// A column under follower loads, exact flutter load and frequency, EI = m = L = 1, and errors of the load with 16
/// elements of order 2 to 4 from the same program as above (zero: not tabulated).
struct FollowerColumn {
  std::string name;
  double largest = 0.0;  ///< load at the end of the only step
  std::string along{};   ///< distribution of the load; empty: at the end only
  double body = 0.0;     ///< mass at the end
  double load = 0.0, omega = 0.0;
  std::array<double, 3> tabulated{};
  double alpha = 0.0, beta = 0.0;
  double digits = 0.0;  ///< relative accuracy of the reference, with damping
};

/// Beck 1952, Leipholz 1962, Hauger 1966, Pflueger 1955 by their determinants to 15 digits; with damping, the zero of
/// the largest real part (Herrmann, Jong 1965 for the limit).
std::vector<FollowerColumn> follower_columns() {
  constexpr double kEight = 1e-9;  // the reference has ten digits
  return {{"Beck", 30, "", 0, 20.0509536189737, 11.01555764, {2e-5, 9e-9, 6e-12}},
          {"Leipholz", 60, "1", 0, 40.0537365149395, 11.03021699538, {3e-5, 2e-8, 2e-11}},
          {"Hauger", 200, "1-x", 0, 150.641595404493, 11.48571361113, {6e-5, 3e-8, 2e-10}},
          {"Pflueger, mass 0.1", 30, "", 0.1, 17.5952822347322, 9.432781694, {0, 0, 3e-12}},
          {"Pflueger, mass 10", 30, "", 10, 18.1634355278225, 3.739525488, {0, 0, 1e-12}},
          {"Beck, beta 1e-2", 30, "", 0, 10.96611166, 5.3997091, {}, 0, 1e-2, kEight},
          {"Beck, beta 1e-4", 30, "", 0, 10.93885207, 5.3986139, {}, 0, 1e-4, kEight}};
}

Scene scene_of(const Scene& cantilever, const FollowerColumn& column) {
  Scene scene = cantilever;
  scene.sections[0].mass_damping = column.alpha;
  scene.sections[0].stiffness_damping = column.beta;
  if (column.body > 0.0) scene.point_masses.push_back({"end", column.body});
  if (column.along.empty()) {
    PointLoad load;
    load.point = "end";
    load.member = scene.members[0].name;
    load.force = {-column.largest, 0.0, 0.0};
    load.frame = LoadFrame::follower;
    scene.point_loads.push_back(load);
  } else {
    DistributedLoad load;
    load.member = scene.members[0].name;
    load.force_formula = {formatted("-%.17g*(%s)", column.largest, column.along.c_str()), "0", "0"};
    load.frame = LoadFrame::follower;
    scene.distributed_loads.push_back(load);
  }
  return scene;
}

/// The first flutter point of a path of one step.
CriticalPoint flutter_of(Application& app, const Scene& scene) {
  SolverParameters parameters = app.solver;
  parameters.threads = 1;
  std::vector<CriticalPoint> found;
  app.try_to_solve(scene, parameters, [&](const Simulation&, const StepReport& report) {
    found.insert(found.end(), report.critical_points.begin(), report.critical_points.end());
  });
  if (found.empty() || found[0].kind != CriticalKind::flutter) throw ConvergenceError("no flutter was found");
  return found[0];
}

void run_flutter(Application& app) {
  constexpr int kElements = 16, kLeastOrder = 2;
  /// Frequencies have the rounding of the tangent and of loads at Gauss points, flutter loads a few times that.
  constexpr double kRoundedLoad = 1e-10, kFrequencyDigits = 1e-8;
  StudyTable csv(app, "flutter.csv", words("case,order,load,reference,error,omega,reference omega"));
  app.out() << "flutter: relative error of the load\n";
  for (const FollowerColumn& column : follower_columns())
    for (const int order : study_list<int>(app, "Flutter Orders")) {
      if (column.digits > 0.0 && order < kTabulated) continue;
      const CriticalPoint point = flutter_of(app, with_mesh(scene_of(app.scene, column), order, kElements));
      const double load = point.load_factor * column.largest, error = std::abs(load / column.load - 1.0);
      const std::string label = formatted("%s, k=%d, %d elements", column.name.c_str(), order, kElements);
      app.out() << formatted("  %-20s k=%d %.1e  omega %.9g\n", column.name.c_str(), order, error, point.omega);
      csv.add_row({column.name, order, load, column.load, error, point.omega, column.omega});
      const double tabulated = order < kLeastOrder ? 0.0 : column.tabulated[order - kLeastOrder];
      if (tabulated > 0.0)
        app.summary.check_upper_bound(label + ": load of flutter", error, 2.0 * tabulated + kRoundedLoad,
                                      "twice the error of a prototype with dense eigenvalues");
      if (order < kTabulated) continue;
      if (column.digits > 0.0)
        app.summary.check_upper_bound(label + ": load of flutter", error, column.digits,
                                      "zero of the largest real part, of a prototype with dense eigenvalues; reference "
                                      "error: 5e-10, half of the tenth digit");
      app.summary.check_upper_bound(label + ": frequency", std::abs(point.omega / column.omega - 1.0), kFrequencyDigits,
                                    "exact value");
    }
}

void run_studies_of_modes(Application& app) {
  run_modes_study(app);
  run_flutter(app);
}

ListSpec modes_study_spec() {
  ListSpec spec(
      "Straight rods of the scene's section: clamped, hinged, free, with a body, in bending, tension, torsion and "
      "shear; columns that flutter.");
  spec.add(counts("Orders", {1, 2, 3, 4}, kTabulated, "Element orders."));
  spec.add(counts("Elements", {4, 8, 16}, 1000, "Meshes."));
  spec.add(counts("Flutter Orders", {2, 3, 4}, kTabulated, "Element orders of columns under follower loads.", 2));
  return spec;
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(argc, argv, "modes",
                            "natural frequencies and flutter of straight rods against closed forms.",
                            mixbeam::modes_study_spec(), mixbeam::run_studies_of_modes);
}
