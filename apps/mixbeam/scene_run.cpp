#include "apps/mixbeam/scene_run.hpp"

#include "apps/common/run/quantity_values.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/guarded_run.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/common/session/progress.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/result_names.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <tuple>

namespace mixbeam {

namespace {

constexpr double kBalanceTolerance = 1e-10;
constexpr double kResidualOfRow = 1e-11;
/// Factor for three components, and for forces with the lever of half a structure beside moments.
constexpr double kRowsAndLevers = 2.0;

/// Lines of a table on the terminal; files are complete.
constexpr std::size_t kMostLines = 12;
/// Columns of frequencies per line.
constexpr int kMostTracks = 5;
/// Lines of quantities on the terminal.
constexpr std::size_t kMostQuantities = 100;

bool ends_with(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() && text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

/// Whether a displacement is zero; fixed points would hide those that move.
bool stays(const MonitoredQuantity& displacement) {
  return displacement.components == std::vector<double>(displacement.components.size(), 0.0);
}

/// `scale`: magnitude of the quantity if the structure is bent by an angle of one.
struct NamedError {
  const char* name;
  const RecordedError& error;
  double scale;
};

/// Whether the energy is all error: without loads every error is rounding, however soft the structure.
bool is_without_strain(const RecordedErrorEstimate& estimate) { return estimate.energy.size == estimate.energy.error; }

std::vector<NamedError> named(const RecordedErrorEstimate& estimate, double length, double bending) {
  if (is_without_strain(estimate)) length = bending = HUGE_VAL;
  return {{"displacement, any vertex", estimate.largest_displacement, length},
          {"displacement, root mean square", estimate.displacement, length},
          {"section moments, root mean square", estimate.moment, bending / length},
          {"strain energy", estimate.energy, bending / length}};
}

/// Quantities below this share of their scale are rounding and count as zero.
constexpr double kRoundingOfSize = 1e-12;

/// The energy, or zero if it is below the square of rounding strains. `scale`: EI / L.
double without_rounding(double energy, double scale) {
  constexpr double kRounding = std::numeric_limits<double>::epsilon();
  return std::abs(energy) > kRounding * kRounding * scale ? energy : 0.0;
}

/// Rounding of the participation of a mode whose largest motion is one.
constexpr double kRoundingOfMode = 1e-10;

/// Relative error, at most one; NaN if the quantity is rounding only.
double relative(const RecordedError& error, double scale) {
  const double size = std::max(error.size, std::abs(error.error));
  return size > kRoundingOfSize * scale ? std::abs(error.error) / size : std::numeric_limits<double>::quiet_NaN();
}

/// Relative error of displacements that causes a warning.
constexpr double kLargeError = 0.01;

/// Relative error up to which an error is scaled with its value.
constexpr double kKnown = 0.1;

/// Likewise for values beside unresolved end layers; displacements may have ten times this error.
constexpr double kErrorBesideLayers = 0.1 * kLargeError;

double length_of(const MonitoredQuantity& vector) {
  return std::hypot(vector.components[0], vector.components[1], vector.components[2]);
}

void print_left_out(std::ostream& out, std::size_t count) {
  if (count > kMostLines) out << "  ... and " << count - kMostLines << " more in the files\n";
}

/// "0.25 in member left at s = 2": the longest `vector_at(member, i)` over all samples i, the first of equal ones;
/// empty if other ranks hold samples.
template <class VectorAt>
std::string longest_vector(const SampledMembers& members, const VectorAt& vector_at) {
  const MemberSamples* where = nullptr;
  double largest = 0.0, at = 0.0;
  std::size_t held = 0;
  for (const MemberSamples& member : members)
    for (std::size_t i = 0; i < member.size(); ++i, ++held) {
      const double size = vector_algebra::norm(vector_at(member, i));
      if (size <= largest * (1.0 + kRoundingOfSize)) continue;
      largest = size;
      where = &member;
      at = member.arc_length[i];
    }
  if (where == nullptr || held != members.samples()) return "";
  return formatted("%.6g in member ", largest) + where->name + formatted(" at s = %.4g", at);
}

/// ", its mode moves member left at s = 2 most".
std::string moves_most(const SampledMembers& members, const std::vector<Vector3>& mode) {
  std::size_t next = 0;
  const std::string place = longest_vector(members, [&](const MemberSamples&, std::size_t) { return mode[next++]; });
  return place.empty() ? "" : ", its mode moves" + place.substr(place.find(" in ") + 3) + " most";
}

/// "false (2 negative eigenvalues)".
std::string verdict_text(const EndOfRun& end) {
  if (end.stable == "neutral") return "neutral (an eigenvalue is zero: some motion has no stiffness)";
  if (end.stable == "unknown" && end.negative < 0) return "unknown (\"Stability\" was not determined)";
  if (end.stable == "unknown" && !end.has_potential)
    return "unknown (loads without a potential: it may flutter; \"Modes\" of a structure with masses tell)";
  if (end.stable == "unknown")
    return formatted("unknown (%d negative eigenvalues: Coriolis forces may hold it; \"Modes\" tell)", end.negative);
  if (end.negative <= 0) return end.stable;
  return end.stable + formatted(" (%d negative eigenvalue%s)", end.negative, end.negative == 1 ? "" : "s");
}

/// Share of torsion in the von Mises stress of an open section above which a note on warping is printed.
constexpr double kTorsionNote = 0.1;

/// Strains below this are rounding: only eigenstrains deform the structure, and it has no stresses.
constexpr double kNoStrain = 1e-12;

/// Arc length over the length of the member.
std::string share_text(const StressedMember& m) {
  return formatted("%.4g", m.length > 0.0 ? m.arc_length / m.length : 0.0);
}

/// "0.05, -0.1"; a coordinate that is rounding relative to the other is zero.
std::string point_text(const SectionPoint& p) {
  constexpr double kRounding = 1e-9;
  const double size = kRounding * std::max(std::abs(p[0]), std::abs(p[1]));
  return formatted("%.4g, %.4g", std::abs(p[0]) < size ? 0.0 : p[0], std::abs(p[1]) < size ? 0.0 : p[1]);
}

bool any_utilisation(const StressSummary& stresses) {
  return std::any_of(stresses.members.begin(), stresses.members.end(),
                     [](const StressedMember& m) { return m.utilisation.has_value(); });
}

std::string percent(double value) { return formatted("%.3g %%", 100.0 * value); }

/// Growth rates below this share of the largest frequency are rounding of motions without stiffness.
constexpr double kRoundedGrowth = 1e-6;

/// Prints the last lines of a run, one per end (two under displacement control): "column: stable: true".
void print_ends(std::ostream& out, const Summary& summary, bool controlled) {
  for (const EndOfRun& end : summary.ends) {
    if (!end.collapse.empty()) out << end.run << ": collapse: " << end.collapse << "\n";
    out << end.run << ": stable: " << verdict_text(end) << (controlled ? " under the dead load" : "");
    if (end.stable == "false")
      out << ": " << kDoesNotStay << (end.held == "true" ? " unless the displacement is prescribed" : "");
    out << "\n";
    if (!end.held.empty())
      out << end.run << ": stable: " << end.held << " with the displacement prescribed"
          << (end.held == "false" ? std::string(": ") + kDoesNotStay : "") << "\n";
  }
}

/// "1.2e-03"; "unknown" if not estimated; "-" if not requested (also for null).
std::string error_text(const EstimatedValue* value) {
  if (value != nullptr && value->is_estimated()) return formatted("%.1e", value->error);
  return value == nullptr || value->not_estimated.empty() ? "-" : "unknown";
}

/// Prints the most stressed members with place, section point and utilisation, and a note on warping.
void print_stresses(std::ostream& out, const StressSummary& stresses) {
  if (stresses.members.empty() || (stresses.strain.value > 0.0 && stresses.strain.value < kNoStrain)) return;
  out << formatted("  %-24s %14s %9s %14s %9s   %-24s%s\n", "largest stress in", "von Mises", "error", "at s", "s / L",
                   "point of section x2, x3", any_utilisation(stresses) ? " utilisation" : "");
  for (const StressedMember& m : stresses.members) {
    const LargestStress& s = m.stresses.von_mises;
    out << formatted("  %-24.60s %14.6g %9s %14.6g %9s   %-24s", m.member.c_str(), s.value,
                     error_text(&m.estimated).c_str(), m.arc_length, share_text(m).c_str(),
                     point_text(s.point).c_str());
    out << (m.utilisation ? formatted(" %11.3g", *m.utilisation) : "") << "\n";
  }
  for (const StressedMember& m : stresses.members)
    if (m.torsion_share > kTorsionNote) {
      out << "  note: of the stress in \"" << m.member << "\" torsion makes " << percent(m.torsion_share)
          << "; with restrained warping an open section has other stresses than these (Saint-Venant's)\n";
      break;
    }
}

/// Warnings about utilisation, strains beyond the linear law, members too curved for linear bending stresses.
std::vector<std::string> stress_warnings(const StressSummary& stresses) {
  std::vector<std::string> warnings;
  const LargestAlong &strain = stresses.strain, &curved = stresses.curvature, &used = stresses.utilisation;
  if (used.value + used.error > used.limit)
    warnings.push_back("member \"" + used.member +
                       "\" is stressed beyond the \"Strength\" of its material: utilisation " +
                       formatted("%.3g at s = %.6g", used.value, used.arc_length) +
                       (used.value > used.limit ? "" : formatted(", and an estimated error of %.2g", used.error)));
  if (!strain.member.empty() && strain.value > strain.limit)
    warnings.push_back(
        "member \"" + strain.member + "\" is strained by " + percent(strain.value) +
        " at s = " + formatted("%.6g", strain.arc_length) + ", more than " + percent(strain.limit) +
        ": hardly any material is linear up to there (\"Largest Strain\" of its section changes the limit)");
  if (!curved.member.empty() && curved.value > curved.limit)
    warnings.push_back("member \"" + curved.member +
                       "\" is curved so much that the bending stress at its inner fibre is too low by about " +
                       percent(curved.value) + " (Winkler and Bach), for its section is thick against its radius");
  return warnings;
}

/// Collects the results of a run for its report: last step, extremes over the steps, balance of loads and reactions.
class RunReport {
 public:
  /// `quantities`: of the scene; must outlive this.
  RunReport(const QuantitySet* quantities, const Scene& scene) : quantities_(quantities) {
    levers_ = rounding_of_levers(scene);
    vector_algebra::Box box;
    for (const Point& point : scene.points) box.enclose(point.position);
    if (scene.points.size() > 1) length_ = box.diagonal();
    for (const Section& section : scene.sections)
      for (const double bending : section.bending_stiffness)
        bending_ = bending_ > 0.0 ? std::min(bending_, bending) : bending;
    if (quantities == nullptr || quantities->empty()) return;
    followed_.resize(quantities->columns().size());
    for (const Member& member : scene.members) member_names_.push_back(member.name);
  }

  void add(const StepRecord& record) {
    for (const MonitoredQuantity& quantity : record.monitored)
      if (!followed_.empty() && quantity.name == kQuantitySeries)
        follow(record.step, record.load_factor, quantity.components.data());
    const auto larger = [](double a, double b) { return b <= a ? a : b; };  // keeps NaN
    int longest = 0;
    record.members.for_each_known([&](const SampledMember& member) { longest = std::max(longest, member.elements); });
    balance_tolerance_ = std::max(balance_tolerance_, balance_tolerance(static_cast<double>(record.members.elements()),
                                                                        longest, record.residual, levers_));
    force_error_ = larger(force_error_, record.balance.force_error);
    moment_error_ = larger(moment_error_, record.balance.moment_error);
    farthest_ = longest_vector(record.members,
                               [](const MemberSamples& member, std::size_t i) { return member.displacement[i]; });
    last_ = without_rows(record);
    for (const RecordedBucklingMode& mode : record.buckling)
      buckling_.push_back({{mode.load_factor, {}, mode.residual, mode.confirmed, mode.error},
                           record.load_factor,
                           moves_most(record.members, mode.mode)});
    for (const RecordedCriticalPoint& point : record.critical_points)
      add(point, moves_most(record.members, point.mode));
    if (record.jump) jumps_.push_back(*record.jump);
    follow(Searched{record.step, record.load_factor, last_.vibration});
  }

  /// Adds the critical points, jumps, modes and quantities of a run that is resumed.
  void add(const StoredRun& run) {
    for (const MonitoredSeries& series : run.monitor())
      for (std::size_t i = 0; i < run.steps().size() && series.name == kQuantitySeries; ++i)
        follow(run.steps()[i].step, run.steps()[i].load_factor, series.values.data() + i * series.columns);
    for (std::size_t i = 0; i < run.steps().size(); ++i) {
      for (const RecordedCriticalPoint& point : run.critical_points(i)) add(point, "");  // their modes are not read
      if (const std::optional<RecordedJump> jump = run.jump(i)) jumps_.push_back(*jump);
      follow(Searched{run.steps()[i].step, run.steps()[i].load_factor, run.vibration()[i]});
    }
  }

  /// Adds the checks of the balance to the summary of the run.
  void check_balance(Application& app, const std::string& run) const {
    const std::string source = "equilibrium of the whole structure, every step";
    app.summary.check_upper_bound(run + ": loads and reactions, sum of forces / largest force", force_error_,
                                  balance_tolerance_, source);
    app.summary.check_upper_bound(run + ": loads and reactions, sum of moments / largest moment", moment_error_,
                                  balance_tolerance_, source);
  }

  /// Adds the stability of the last step to the summary of the run; an unstable end is a warning.
  void add_end(Application& app, const std::string& run) const {
    const EndOfRun end{last_.stability, run, last_.point.load_factor, jumps_, collapse_text()};
    app.summary.ends.push_back(end);
    // under displacement control, the structure leaves a state only if it is unstable with the displacement prescribed
    if (end.stable == "false" && end.held != "true")
      app.summary.warnings.push_back(run + ": the last state is unstable: " + kDoesNotStay);
    std::vector<std::string> infinite;
    for (std::size_t i = 0; i < followed_.size(); ++i) {
      const Quantity& asked = quantities_->asked(quantities_->columns()[i]);
      if (!std::isfinite(followed_[i].last) && (!asked.formula.empty() || asked.kind == "angle"))
        infinite.push_back(quantities_->columns()[i].name);
    }
    if (!infinite.empty())
      app.warn(run + ": formulas without a finite value at the end, or angles with a side of no length: " +
               quoted_list(infinite));
  }

  /// Adds the estimated errors of the last step to the summary of the run.
  void add_errors(Application& app, const std::string& run) const {
    if (!last_.error_estimate) return;
    const RecordedErrorEstimate& estimate = *last_.error_estimate;
    EstimatedErrors errors{run, estimate.not_estimated, {}};
    const auto warn = [&](const std::string& warning) { app.warn(run + ": " + warning); };
    if (!estimate.not_estimated.empty()) warn("the discretization error is not estimated: " + estimate.not_estimated);
    if (estimate.not_estimated.empty()) {
      for (const NamedError& quantity : named(estimate, length_, bending_))
        errors.quantities.push_back({quantity.name, quantity.error.error, relative(quantity.error, quantity.scale)});
      const double large = errors.quantities.front().relative;
      if (large > (app.mesh_note.empty() ? kLargeError : kAccuracyWithoutMesh)) {
        warn(formatted("the estimated error of displacements is %.2g %% of the largest: ", 100.0 * large) +
             "more \"Elements\", a higher \"Order\", or \"Accuracy\" in the scene");
      }
      for (const MonitoredQuantity& point : estimate.points) {
        const RecordedError error{length_of(point), estimate.largest_displacement.size};
        const double scale = is_without_strain(estimate) ? HUGE_VAL : length_;
        errors.quantities.push_back({"displacement of " + point.name, error.error, relative(error, scale)});
      }
      for (const EstimatedValue& value : estimate.sections)
        errors.quantities.push_back({value.name, value.error, value.relative()});
      const auto is_uncertain = [](const EstimatedValue& value) { return !(value.relative() <= kErrorBesideLayers); };
      const auto& [asked, sections] = std::tie(estimate.quantities, estimate.sections);
      if (!estimate.layers.empty() && (std::any_of(asked.begin(), asked.end(), is_uncertain) ||
                                       std::any_of(sections.begin(), sections.end(), is_uncertain)))
        warn(estimate.layers);
    }
    app.summary.estimated_errors.push_back(errors);
  }

  /// Sets the places of extremes at the end, see QuantitySet::places().
  void add_places(std::vector<std::string> places) { places_ = std::move(places); }
  /// Quantities that are extremes, with their places at the end.
  std::vector<std::pair<std::string, std::string>> places() const {
    std::vector<std::pair<std::string, std::string>> places;
    for (std::size_t i = 0; i < followed_.size(); ++i)
      if (const std::string place = place_of(i); quantities_->columns()[i].is_value && !place.empty())
        places.emplace_back(quantities_->columns()[i].name, place);
    return places;
  }

  /// Adds the quantities to the summary, and a check for each limit.
  void add_quantities(Application& app, const std::string& run) const {
    for (std::size_t i = 0; i < followed_.size(); ++i) {
      const QuantitySet::Column& column = quantities_->columns()[i];
      if (!column.is_value) continue;
      const Followed& one = followed_[i];
      FollowedQuantity quantity{run, column.name, one.last, one.at_size, one.load_factor_of_size, one.step_of_size};
      if (i < places_.size() && !places_[i].empty()) {
        quantity.place = places_[i];
      } else if (!place_of(i).empty()) {
        quantity.member = member_names_[static_cast<std::size_t>(followed_[i + 1].last)];
        quantity.arc_length = followed_[i + 2].last;
        quantity.side = static_cast<int>(followed_[i + 3].last);
      }
      const EstimatedValue* const estimated = estimate_of(i);
      quantity.error = estimated == nullptr ? std::nan("") : estimated->error;
      if (estimated != nullptr) quantity.not_estimated = estimated->not_estimated;
      app.summary.quantities.push_back(quantity);
      const Quantity& asked = quantities_->asked(column);
      if (!column.is_limited || !asked.is_limited_in(app.load_case) || one.limited_size < 0.0) continue;
      const std::string steps = asked.stage ? ", every step of stage " + std::to_string(*asked.stage) : ", every step";
      app.summary.check_limit(run + ": size of " + column.name + asked.since(), steps, one.limited_size,
                              error_of_largest(one, estimated), quantity.not_estimated, *asked.allowed());
    }
  }

  /// Adds the gradients at the end to the summary of the run.
  void add_gradients(Application& app, const std::string& run) const {
    if (!last_.gradients) return;
    if (!last_.gradients->not_found.empty())
      return app.summary.fail(run + ": gradients", "found", "list \"Gradient\"", last_.gradients->not_found);
    const std::vector<std::string> quantities = app.quantities.names();
    for (const RecordedGradient& one : last_.gradients->quantities) {
      if (std::isnan(one.value) && std::count(quantities.begin(), quantities.end(), one.quantity) == 0)
        app.summary.fail(run + ": gradient of " + one.quantity, "found", "list \"Gradient\"", one.note);
      for (std::size_t i = 0; i < one.derivative.size() && !std::isnan(one.value); ++i)
        app.summary.gradients.push_back({run, one.quantity, one.value, last_.gradients->numbers[i], one.derivative[i]});
    }
  }

  /// Rows of a table: quantity, value, path of the number, derivative.
  std::vector<std::vector<CsvCell>> gradients() const {
    std::vector<std::vector<CsvCell>> rows;
    if (!last_.gradients) return rows;
    for (const RecordedGradient& one : last_.gradients->quantities)
      for (std::size_t i = 0; i < one.derivative.size(); ++i)
        rows.push_back({one.quantity, one.value, last_.gradients->numbers[i], one.derivative[i]});
    return rows;
  }

  /// Table of natural frequencies over the path, a column per motion and unit; without rows after a single search.
  std::vector<std::vector<CsvCell>> frequencies() const {
    std::vector<std::vector<CsvCell>> rows;
    if (searched_.size() < 2 || tracks_ == 0) return rows;
    for (const Searched& searched : searched_) {
      std::vector<CsvCell>& row = rows.emplace_back(std::vector<CsvCell>{searched.step, searched.load_factor});
      for (const auto number : {&RecordedVibrationMode::omega, &RecordedVibrationMode::frequency})
        for (int track = 1; track <= tracks_; ++track) {
          const RecordedVibrationMode* mode = searched.of(track);
          row.push_back(mode == nullptr ? CsvCell("") : CsvCell(mode->*number));
        }
    }
    return rows;
  }

  std::vector<std::string> frequency_columns() const {
    std::vector<std::string> columns{"step", "load_factor"};
    for (const char* unit : {"omega_", "frequency_"})
      for (int track = 1; track <= tracks_; ++track) columns.push_back(unit + std::to_string(track));
    return columns;
  }

  /// Adds warnings about stresses and strains of the last step to the summary.
  void add_stresses(Application& app, const std::string& run) const {
    if (!last_.stresses) return;
    for (const std::string& warning : stress_warnings(*last_.stresses)) {
      app.summary.warnings.push_back(run + ": " + warning);
      app.out() << "warning: " << warning << "\n";
    }
  }

  /// Prints displacements and reactions of some points in the last step, energies, quantities, stresses, estimated
  /// errors, balance.
  void print(std::ostream& out) const {
    print_buckling(out);
    print_critical_points(out);
    print_jumps(out);
    const std::string displacement = ".displacement";
    std::size_t points = 0;
    for (const MonitoredQuantity& quantity : last_.monitored) {
      if (!ends_with(quantity.name, displacement) || stays(quantity) || ++points > kMostLines) continue;
      if (points == 1) out << formatted("  %-24s %18s %18s %18s\n", "displacement of", "x", "y", "z");
      const std::string point = quantity.name.substr(0, quantity.name.size() - displacement.size());
      const std::vector<double>& u = quantity.components;
      out << formatted("  %-24.60s %18.10g %18.10g %18.10g\n", point.c_str(), u[0], u[1], u[2]);
    }
    print_left_out(out, points);
    print_reactions(out);
    print_modes(out);
    print_frequencies(out);
    const double scale = bending_ / length_;
    out << formatted("  strain energy %.10g (forces %.10g, moments %.10g)\n",
                     without_rounding(last_.strain_energy, scale), without_rounding(last_.force_energy, scale),
                     without_rounding(last_.moment_energy, scale));
    print_quantities(out);
    print_gradients(out);
    if (last_.stresses) print_stresses(out, *last_.stresses);
    print_errors(out);
    const bool balanced = force_error_ <= balance_tolerance_ && moment_error_ <= balance_tolerance_;
    out << formatted("  loads and reactions %s: forces %.1e, moments %.1e of the largest at work, allowed %.0e\n",
                     balanced ? "balance" : "DO NOT BALANCE", force_error_, moment_error_, balance_tolerance_);
  }

  /// Prints a few lines for one run among several.
  void print_short(std::ostream& out, const std::string& run) const {
    out << run;
    const char* separator = ": ";
    const auto add = [&](const std::string& text) {
      out << separator << text;
      separator = ", ";
    };
    if (!farthest_.empty()) add("largest displacement " + farthest_);
    if (last_.error_estimate && last_.error_estimate->not_estimated.empty()) {
      const NamedError largest = named(*last_.error_estimate, length_, bending_).front();
      add(formatted("estimated error %.1e of it", relative(largest.error, largest.scale)));
    }
    add(formatted("strain energy %.6g", without_rounding(last_.strain_energy, bending_ / length_)));
    out << "\n";
    if (last_.stresses && !last_.stresses->members.empty()) {
      const StressedMember& most = last_.stresses->members.front();
      out << formatted("  largest von Mises stress %.6g in %s at s = %.4g", most.stresses.von_mises.value,
                       most.member.c_str(), most.arc_length)
          << (most.utilisation ? formatted(", utilisation %.3g", *most.utilisation) : "") << "\n";
    }
  }

 private:
  /// Adds a critical point. `place`: where its mode moves most, empty if unknown.
  void add(const RecordedCriticalPoint& point, const std::string& place) {
    if (collapse_.empty() && point.negative_before == 0 && point.negative_after > 0)
      collapse_ = point.kind + " at load factor " + in_known_digits(point.load_factor, point.load_factor_error) + place;
    critical_.push_back(without_rows(point));
  }

  void print_buckling(std::ostream& out) const {
    double base = -1.0;
    bool is_negative = false;
    const auto finish = [&] {
      if (base >= 0.0) out << (is_negative ? "; negative: under the reversed loads\n" : "\n");
      is_negative = false;
    };
    for (const Buckling& one : buckling_) {
      const RecordedBucklingMode& mode = one.mode;
      if (one.base != base) {
        finish();
        base = one.base;
        out << (base == 0.0
                    ? "  linear buckling of the undeformed structure at load factors"
                    : formatted("  linear buckling about the end of stage %.0f, at factors of the loads of stage %.0f",
                                base, base + 1.0));
      }
      out << formatted(" %.8g (%sresidual %.0e%s)", mode.load_factor,
                       std::isnan(mode.error) ? "" : formatted("error %.0e, ", mode.error).c_str(), mode.residual,
                       mode.confirmed ? "" : ", not confirmed");
      is_negative = is_negative || mode.load_factor < 0.0;
    }
    finish();
  }

  void print_modes(std::ostream& out) const {
    if (last_.vibration.empty()) return;
    out << "  natural modes\n"
        << formatted("  %6s %18s %16s %12s %38s\n", "mode", "omega", "frequency", "modal mass",
                     "participation x, y, z");
    double largest = 0.0;
    for (const RecordedVibrationMode& mode : last_.vibration) largest = std::max(largest, mode.omega);
    for (std::size_t i = 0; i < last_.vibration.size(); ++i) {
      const RecordedVibrationMode& mode = last_.vibration[i];
      const auto part = [](double value) { return std::abs(value) < kRoundingOfMode ? 0.0 : value; };
      out << formatted("  %6zu %18.10g %16.10g %12.5g %12.5g %12.5g %12.5g", i + 1, mode.omega, mode.frequency,
                       mode.modal_mass, part(mode.participation_x), part(mode.participation_y),
                       part(mode.participation_z))
          << (std::abs(mode.growth) > kRoundedGrowth * largest
                  ? formatted("  %s as exp(%.6g t)", mode.growth > 0.0 ? "grows" : "decays", mode.growth)
                  : "")
          << (mode.confirmed ? "\n" : "  not confirmed\n");
    }
  }

  /// Prints lines evenly spread over the path, including the first and the last.
  void print_frequencies(std::ostream& out) const {
    if (searched_.size() < 2 || tracks_ == 0) return;
    const int columns = std::min(tracks_, kMostTracks);
    out << "  frequencies over the path, omega (omega / 2 pi) of each motion\n  load factor";
    for (int track = 1; track <= columns; ++track)
      out << formatted(" %24s", ("motion " + std::to_string(track)).c_str());
    out << (columns < tracks_ ? formatted("  ... and %d more in the files\n", tracks_ - columns) : "\n");
    const std::size_t lines = std::min(searched_.size(), kMostLines), last = searched_.size() - 1;
    for (std::size_t line = 0; line < lines; ++line) {
      const Searched& searched = searched_[line * last / (lines - 1)];
      out << formatted("  %11.6g", searched.load_factor);
      for (int track = 1; track <= columns; ++track) {
        const RecordedVibrationMode* mode = searched.of(track);
        out << formatted(" %24s",
                         mode == nullptr ? "-" : formatted("%.7g (%.6g)", mode->omega, mode->frequency).c_str());
      }
      out << "\n";
    }
    print_left_out(out, searched_.size());
  }

  /// Collapse load of the path, otherwise of linear buckling about the last prestressed state.
  std::string collapse_text() const {
    if (!collapse_.empty()) return collapse_;
    const Buckling* first = nullptr;
    for (const Buckling& one : buckling_)
      if (one.mode.load_factor > 0.0 && (first == nullptr || one.base > first->base)) first = &one;
    if (first == nullptr) return "";
    const std::string state =
        first->base == 0.0 ? "" : formatted(" about the end of stage %.0f, times the loads of the next", first->base);
    return formatted("none up to load factor %.6g; linear buckling%s: %.6g", last_.load_factor, state.c_str(),
                     first->mode.load_factor) +
           first->place;
  }

  void print_critical_points(std::ostream& out) const {
    for (std::size_t i = 0; i < std::min(critical_.size(), kMostLines); ++i) {
      const RecordedCriticalPoint& point = critical_[i];
      out << formatted("  critical point %zu: ", i + 1)
          << critical_text(point.kind, point.load_factor, point.load_factor_error, point.negative_before,
                           point.negative_after, point.omega)
          << "\n";
    }
    print_left_out(out, critical_.size());
  }

  void print_jumps(std::ostream& out) const {
    for (std::size_t i = 0; i < std::min(jumps_.size(), kMostLines); ++i) out << "  " << jump_text(jumps_[i]) << "\n";
    print_left_out(out, jumps_.size());
  }

  void print_errors(std::ostream& out) const {
    if (!last_.error_estimate) return;
    if (!last_.error_estimate->not_estimated.empty()) {
      out << "  discretization error not estimated: " << last_.error_estimate->not_estimated << "\n";
      return;
    }
    out << formatted("  %-36s %9s %9s\n", "estimated discretization error", "absolute", "relative");
    for (const NamedError& quantity : named(*last_.error_estimate, length_, bending_)) {
      const double share = relative(quantity.error, quantity.scale);
      out << formatted("    %-34s %9.1e %9s\n", quantity.name, std::abs(quantity.error.error),
                       std::isnan(share) ? "-" : formatted("%.1e", share).c_str());
    }
    for (const EstimatedValue& value : last_.error_estimate->sections)
      out << formatted("    %-34s ", value.name.c_str())
          << (value.is_estimated() ? formatted("%9.1e %9.1e", value.error, value.relative())
                                   : "not estimated: " + value.not_estimated)
          << "\n";
  }

  void print_quantities(std::ostream& out) const {
    std::size_t lines = 0;
    for (std::size_t i = 0; i < followed_.size(); ++i) {
      const QuantitySet::Column& column = quantities_->columns()[i];
      if (!column.is_value || ++lines > kMostQuantities) continue;
      if (lines == 1) out << formatted("  %-30s %18s %9s %18s\n", "quantity", "at the end", "error", "largest size");
      out << formatted("  %-30.60s %18.10g %9s %18.10g at load factor %.6g", column.name.c_str(), followed_[i].last,
                       error_text(estimate_of(i)).c_str(), followed_[i].at_size, followed_[i].load_factor_of_size);
      const std::string place = place_of(i);
      out << (place.empty() ? "" : "; at the end: " + place) << "\n";
    }
    if (lines > kMostQuantities) out << "  ... and " << lines - kMostQuantities << " more in the files\n";
  }

  void print_gradients(std::ostream& out) const {
    if (!last_.gradients) return;
    const RecordedGradients& all = *last_.gradients;
    for (const RecordedGradient& one : all.quantities) {
      out << "  gradient of " << one.quantity << formatted(" = %.10g\n", one.value);
      for (std::size_t i = 0; i < std::min(all.numbers.size(), kMostLines); ++i)
        out << (std::isnan(one.derivative[i]) ? "       no derivative" : formatted("  %18.10g", one.derivative[i]))
            << "  by " << all.numbers[i] << "\n";
      print_left_out(out, all.numbers.size());
      if (!one.note.empty()) out << "  no derivative: " << one.note << "\n";
    }
  }

  /// Prints the reactions; of many supports those with the largest forces, and the sum of all.
  void print_reactions(std::ostream& out) const {
    std::vector<RecordedReaction> shown = last_.reactions;
    const auto size = [](const RecordedReaction& r) { return vector_algebra::norm(r.force); };
    if (shown.empty()) return;
    if (shown.size() > kMostLines) {
      RecordedReaction sum{"all " + std::to_string(shown.size()) + " together"};
      for (const RecordedReaction& reaction : shown) sum.force = vector_algebra::sum(sum.force, reaction.force);
      std::stable_sort(shown.begin(), shown.end(), [&](const auto& a, const auto& b) { return size(a) > size(b); });
      shown.resize(kMostLines - 1);
      shown.push_back(sum);
    }
    out << formatted("  %-24s %18s %18s %18s   moment x, y, z\n", "reaction at", "force x", "y", "z");
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const RecordedReaction& reaction = shown[i];
      out << formatted("  %-24.60s %18.10g %18.10g %18.10g", reaction.point.c_str(), reaction.force[0],
                       reaction.force[1], reaction.force[2]);
      const bool is_sum = shown.size() < last_.reactions.size() && i + 1 == shown.size();
      if (!is_sum)
        out << formatted("   %.10g, %.10g, %.10g", reaction.moment[0], reaction.moment[1], reaction.moment[2]);
      out << "\n";
    }
    if (last_.reactions.size() > kMostLines)
      out << "  ... and " << last_.reactions.size() - shown.size() + 1 << " smaller ones in the files\n";
  }

  void follow(int step, double load_factor, const double* values) {
    for (std::size_t i = 0; i < followed_.size(); ++i) {
      Followed& one = followed_[i];
      one.last = std::isnan(values[i]) ? std::numeric_limits<double>::quiet_NaN() : values[i];  // NaN without its sign
      if (step == 0 && !std::isfinite(values[i])) continue;  // such as a ratio of zeros without loads
      const QuantitySet::Column& column = quantities_->columns()[i];
      if (column.is_limited) follow_limit(load_factor, values[i], quantities_->asked(column), one);
      if (std::abs(values[i]) <= one.size) continue;  // keeps NaN
      if (std::isnan(one.size)) continue;
      one.size = std::abs(values[i]);
      one.at_size = values[i];
      one.step_of_size = step;
      one.load_factor_of_size = load_factor;
    }
  }

  /// "beam at s = 1.25, after a vertex" of an extreme along members; empty for others.
  std::string place_of(std::size_t column) const {
    if (column < places_.size() && !places_[column].empty()) return places_[column];
    const std::vector<QuantitySet::Column>& columns = quantities_->columns();
    if (column + 1 >= columns.size() || !columns[column + 1].is_member || std::isnan(followed_[column].last)) return "";
    const auto member = static_cast<std::size_t>(followed_[column + 1].last);
    const int side = static_cast<int>(followed_[column + 3].last);
    return member_names_[member] + formatted(" at s = %.6g", followed_[column + 2].last) +
           (side == 0  ? ""
            : side < 0 ? ", before a vertex"
                       : ", after a vertex");
  }

  /// A value of the list "Quantities" over the steps.
  struct Followed {
    double last = 0.0, size = -1.0;  ///< largest absolute value so far, of `at_size`
    double at_size = 0.0, load_factor_of_size = 0.0;
    int step_of_size = 0;
    double reference = 0.0, limited_size = -1.0;  ///< for a limit: reference value, largest change since
  };

  /// Updates reference and largest change of a limited quantity; there are steps at all ends of stages.
  void follow_limit(double load_factor, double value, const Quantity& asked, Followed& one) const {
    constexpr double kRounding = 1e-9;
    if (asked.relative_to && load_factor <= *asked.relative_to + kRounding) {
      one.reference = value;
      return;
    }
    if (asked.stage && !(load_factor > *asked.stage - 1 + kRounding && load_factor <= *asked.stage + kRounding)) return;
    const double size = std::abs(value - one.reference);
    if (!(size <= one.limited_size) && !std::isnan(one.limited_size)) one.limited_size = size;
  }

  /// Estimate of a column at the end; null: not requested.
  const EstimatedValue* estimate_of(std::size_t column) const {
    if (!last_.error_estimate) return nullptr;
    const std::string& name = quantities_->columns()[column].name;
    for (const EstimatedValue& one : last_.error_estimate->quantities)
      if (one.name == name) return &one;
    return nullptr;
  }

  /// Error of the largest value, scaled from the estimated error of the last step in proportion to the values, unless
  /// the last value is itself uncertain.
  static double error_of_largest(const Followed& one, const EstimatedValue* estimated) {
    if (estimated == nullptr) return 0.0;
    const double last = std::abs(one.last);
    return estimated->error * (one.size > last && estimated->error < kKnown * last ? one.size / last : 1.0);
  }

  double length_ = 1.0, bending_ = 0.0;  ///< length of the structure, smallest EI: scales of zero
  double levers_ = 0.0;                  ///< rounding_of_levers()
  const QuantitySet* quantities_ = nullptr;
  std::vector<std::string> member_names_{}, places_{};
  std::vector<Followed> followed_{};             ///< (column of the set)
  StepRecord last_;                              ///< without its members and rows
  std::vector<RecordedCriticalPoint> critical_;  ///< of all steps, without rows
  std::vector<RecordedJump> jumps_;              ///< likewise
  struct Buckling {
    RecordedBucklingMode mode;  ///< without rows
    double base = 0.0;          ///< load factor of its base state
    std::string place;          ///< where the mode moves most
  };
  std::vector<Buckling> buckling_;
  std::string farthest_;  ///< largest displacement of the last step and its place
  std::string collapse_;  ///< first critical point at which the path becomes unstable
  /// Natural modes of a step, without rows.
  struct Searched {
    int step = 0;
    double load_factor = 0.0;
    std::vector<RecordedVibrationMode> modes;
    const RecordedVibrationMode* of(int track) const {
      const auto found = std::find_if(modes.begin(), modes.end(),
                                      [&](const RecordedVibrationMode& mode) { return mode.track == track; });
      return found == modes.end() ? nullptr : &*found;
    }
  };

  void follow(Searched searched) {
    const bool is_known = !searched_.empty() && searched.step <= searched_.back().step;  // resumed at the end
    if (searched.modes.empty() || is_known) return;
    for (const RecordedVibrationMode& mode : searched.modes) tracks_ = std::max(tracks_, mode.track);
    searched_.push_back(std::move(searched));
  }

  std::vector<Searched> searched_;
  int tracks_ = 0;
  double force_error_ = 0.0, moment_error_ = 0.0;
  double balance_tolerance_ = 0.0;
};

/// "1 step", "2 steps".
std::string counted(int number, const std::string& noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

void warn_of_uncertain_forces(Application& app, const std::string& run, Simulation& simulation) {
  const std::optional<UncertainForce> force = simulation.uncertain_force();
  if (!force) return;
  app.summary.warnings.push_back(run + ": " + text_of(*force));
  app.out() << "warning: " << text_of(*force) << "\n";
}

void say_how_to_resume(Application& app, const Simulation& simulation, const std::filesystem::path& file) {
  const LoadPathResult& path = simulation.result();
  app.out() << "Stopped after step " << path.steps << ", load factor "
            << formatted("%.6g of %d. ", path.load_factor, simulation.scene().stages);
  const std::string obstacle = obstacle_to_resuming(app);
  if (obstacle.empty() && file.empty())
    app.out() << "This run cannot be resumed: it has no file.\n";
  else if (obstacle.empty())
    app.out() << "To continue:\n  mixbeam resume " << file.string() << "\n";
  else
    app.out() << "This run cannot be resumed: " << obstacle << ".\n";
}

/// "1.35 dead + 1.5 wind"; empty unless `name` is a combination.
std::string combination_text(const Scene& scene, const std::string& name) {
  for (const Combination& one : scene.combinations) {
    if (one.name != name) continue;
    std::string text;
    for (const auto& [load_case, factor] : one.cases)
      text += formatted(text.empty()   ? "%.6g "
                        : factor < 0.0 ? " - %.6g "
                                       : " + %.6g ",
                        text.empty() ? factor : std::abs(factor)) +
              load_case;
    return text;
  }
  return "";
}

/// Writes a table beside the result file; without rows removes that of an earlier run.
void write_beside(const std::filesystem::path& file, const std::string& name, const std::vector<std::string>& columns,
                  const std::vector<std::vector<CsvCell>>& rows) {
  const std::filesystem::path csv = file.parent_path() / (file.stem().string() + "-" + name + ".csv");
  std::error_code ignored;
  if (rows.empty()) return static_cast<void>(std::filesystem::remove(csv, ignored));
  CsvTable table(csv, columns, Appears::when_closed);
  for (const std::vector<CsvCell>& row : rows) table.add_row(row);
  table.close();
}

/// Writes the limits checked since `first`, gradients, frequencies and places of extremes.
void write_limits_and_places(const Application& app, const RunReport& report, std::size_t first,
                             const std::filesystem::path& file) {
  if (file.empty() || !app.writes_files()) return;
  std::vector<std::vector<CsvCell>> limits, places;
  for (std::size_t i = first; i < app.summary.checks().size(); ++i)
    if (const CheckedQuantity& check = app.summary.checks()[i]; check.source == kLimitOfScene)
      limits.push_back({check.name, check.value, check.reference, check.pass ? "yes" : "NO"});
  for (const auto& [quantity, place] : report.places()) places.push_back({quantity, place});
  write_beside(file, "limits", {"limit", "value", "allowed", "passed"}, limits);
  write_beside(file, "gradients", {"quantity", "value", "number", "derivative"}, report.gradients());
  write_beside(file, "frequencies", report.frequency_columns(), report.frequencies());
  write_beside(file, "places", {"quantity", "place at the end"}, places);
}

}  // namespace

double rounding_of_levers(const Scene& scene) {
  vector_algebra::Box box;
  double farthest = 0.0;
  for (const Point& point : scene.points) {
    box.enclose(point.position);
    farthest = std::max(farthest, vector_algebra::norm(point.position));
  }
  const double size = scene.points.size() > 1 ? box.diagonal() : 0.0;
  return size > 0.0 ? std::numeric_limits<double>::epsilon() * farthest / size : 0.0;
}

double balance_tolerance(double elements, double of_longest_member, double residual, double levers) {
  const double along_members =
      kRowsAndLevers * std::min(kResidualOfRow, residual) * std::sqrt(elements * of_longest_member);
  return std::max({kBalanceTolerance, kResidualOfRow * std::sqrt(elements), along_members}) +
         std::numeric_limits<double>::epsilon() * elements + levers;
}

std::string obstacle_to_resuming(const Application& app) {
  if (app.scene.accuracy) return "its scene asks for an accuracy, and the mesh is chosen by the whole run";
  return obstacle_to_resuming(app.solver);
}

std::map<std::string, std::string> properties_of_case(const std::string& load_case) {
  return {{"load_case", load_case}};
}

std::vector<std::string> chosen_cases(const Scene& scene, const std::optional<std::string>& wanted) {
  const std::vector<std::string> known = alternatives(scene);
  if (!wanted) return known.empty() ? std::vector<std::string>{""} : known;
  if (std::find(known.begin(), known.end(), *wanted) != known.end()) return {*wanted};
  throw InputError("option --case: \"" + excerpt(*wanted) +
                   "\" is not a load case or combination of the scene; allowed: " +
                   (known.empty() ? "nothing, the scene has none" : quoted_list(known)) + did_you_mean(*wanted, known));
}

std::filesystem::path result_file_of(const std::filesystem::path& folder, const std::string& name,
                                     const std::string& load_case) {
  return folder / (name + (load_case.empty() ? "" : "-" + load_case) + ".h5");
}

void warn_without_lock(Application& app, const SharedResultLock& lock) {
  if (lock && !lock->warning().empty()) app.warn(lock->warning());
}

SharedResultLock lock_or_warn(Application& app, const std::filesystem::path& file) {
  SharedResultLock lock = lock_result(file, *app.communicator);
  warn_without_lock(app, lock);
  return lock;
}

RunEnd run_case(Application& app, const std::string& load_case, const std::filesystem::path& file,
                const WritingOptions& writing, const StoredRun* resume) {
  // no copy of a large scene: the application's is not changed and outlives its runs
  const std::shared_ptr<const Scene> kept =
      load_case.empty() && alternatives(app.scene).empty()
          ? std::shared_ptr<const Scene>(std::shared_ptr<const Scene>(), &app.scene)
          : std::make_shared<const Scene>(scene_of_case(app.scene, load_case));
  const Scene& scene = *kept;
  app.load_case = load_case;
  RunReport report(&app.quantities, scene);
  if (resume != nullptr) report.add(*resume);
  const std::string name = file.empty() ? scene.name : file.stem().string();
  Recording recording;
  recording.file = file;
  if (!file.empty()) recording.monitor = file.parent_path() / (file.stem().string() + "-monitor.csv");
  recording.properties = properties_of_case(load_case);
  const std::string combination = combination_text(app.scene, load_case);
  if (!combination.empty()) recording.properties["combination"] = combination;
  if (!app.mesh_note.empty()) recording.properties[kMeshProperty] = app.mesh_note;
  if (!app.quantities.empty()) recording.quantities = &app.quantities;
  if (app.gradient)
    recording.gradients = [&app, load_case, &resume](const Simulation& at, const std::vector<CriticalPoint>& passed) {
      std::vector<CriticalPoint> points;
      Simulation before = at.at(at.state(), at.load_factor());
      for (std::size_t i = 0; resume != nullptr && i < resume->steps().size(); ++i)
        for (CriticalPoint& point : stored_critical_points(before, *resume, i)) points.push_back(std::move(point));
      points.insert(points.end(), passed.begin(), passed.end());
      return gradients_or_reason(at, *app.gradient, {app.quantities, points}, app.xml, load_case);
    };
  recording.resume = resume;
  recording.writing = writing;
  recording.stop = [&app] { return app.is_asked_to_stop(); };
  recording.record_observer = [&report](const StepRecord& record) { report.add(record); };
  recording.observer = [&app](const Simulation& simulation, const StepReport& step) {
    app.check_expected(simulation, step);
    if (app.watch) app.watch(simulation, step);
  };
  const std::size_t checks = app.summary.checks().size();
  recording.restart = [&app, &report, &scene, &resume, checks] {
    report = RunReport(&app.quantities, scene);
    app.forget_path(checks);
    resume = nullptr;
  };
  std::optional<AccurateRun> accurate;
  if (scene.accuracy)
    accurate =
        app.record_accurately(scene, app.solver, recording, asks_for_path(app.solver, app.expected, load_case, scene));
  Simulation simulation = accurate ? accurate->simulation : app.record(kept, app.solver, recording);
  app.out() << name << ": " << counted(simulation.result().steps, "step") << " to load factor "
            << simulation.result().load_factor << (file.empty() ? "" : ", " + file.string()) << "\n";
  if (accurate) report_mesh(app, name, *accurate);
  report.add_places(places_of(app.quantities, simulation));
  app.reports == nullptr ? report.print(app.out()) : report.print_short(*app.reports, name);
  warn_of_uncertain_forces(app, name, simulation);
  report.add_stresses(app, name);
  report.add_errors(app, name);
  report.add_quantities(app, name);
  report.add_gradients(app, name);
  write_limits_and_places(app, report, checks, file);
  report.check_balance(app, name);
  const bool between_meshes = accurate && accurate->end == AccuracyEnd::interrupted;
  if (!simulation.result().interrupted && !between_meshes) {
    report.add_end(app, name);
    return RunEnd::arrived;
  }
  say_how_to_resume(app, simulation, file);
  return RunEnd::interrupted;
}

int finish_runs(Application& app, const CommandLine& line, const std::function<RunEnd()>& cases) {
  RunEnd end = RunEnd::arrived;
  const std::string seconds = compute_with_summary(app, line, [&] {
    try {
      end = cases();
    } catch (const MemberError& error) {
      throw placed(app, error);
    }
  });
  app.out() << "mixbeam: " << counted(app.summary.load_steps, "load step") << ", "
            << counted(app.summary.newton_iterations, "Newton iteration") << ", " << seconds
            << (app.output.empty() ? "" : ", results in " + app.output.string()) << "\n";
  print_ends(app.out(), app.summary, app.solver.analysis.control.has_value());
  if (end == RunEnd::interrupted) return kInterruptedExitCode;
  return app.summary.all_passed() ? 0 : kFailedExitCode;
}

}  // namespace mixbeam
