/// Arrays of a run: paths, quantities, fields, modes.
#include "apps/common/run/quantity_values.hpp"
#include "apps/python/arrays.hpp"
#include "discretization/reading/variables.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/state/record_fields.hpp"
#include "discretization/text/result_names.hpp"

#include <array>
#include <map>
#include <string>
#include <tuple>

namespace py = pybind11;

namespace mixbeam {

namespace {

py::dict path_of(const SolvedRun& run) {
  std::vector<int> step, iterations, negative, critical;
  std::vector<double> load_factor;
  std::vector<std::string> stable;
  int before = 0;
  for (const KeptStep& kept : run.steps()) {
    const PathPoint& point = kept.report.point;
    step.push_back(point.step);
    load_factor.push_back(point.load_factor);
    iterations.push_back(point.newton_iterations - std::exchange(before, point.newton_iterations));
    negative.push_back(kept.stability.negative);
    critical.push_back(point.critical_points);
    stable.push_back(kept.stability.stable);
  }
  py::dict path;
  path["step"] = numbers(step);
  path["load_factor"] = numbers(std::move(load_factor));
  path["newton_iterations"] = numbers(iterations);
  path["negative_eigenvalues"] = numbers(negative);
  path["critical_points_passed"] = numbers(critical);
  path["stable"] = stable;
  return path;
}

/// Quantities of a list "Quantities" in XML, with the variables of the scene.
QuantitySet quantities_in(const SolvedRun& run, const std::string& xml) {
  const XmlParameters parameters = parse_xml(xml, "quantity");
  Variables(run.app().xml.list->sublist("Scene"), parameters.source).resolve(*parameters.list, quantities_spec(), {});
  const std::vector<Quantity> wanted = read_quantities(*parameters.list, parameters.source, {});
  return QuantitySet(wanted, run.at(-1).scene(), {parameters.source, {}});
}

/// Names of columns, and their values in some steps.
py::tuple evaluate(const SolvedRun& run, const std::string& xml, const std::vector<int>& steps) {
  std::vector<std::string> names;
  std::vector<double> values;
  in_turn([&] {
    const QuantitySet quantities = quantities_in(run, xml);
    names = quantities.names();
    for (const int step : steps) {
      const std::vector<double> row = values_of(quantities, run.at(step));
      values.insert(values.end(), row.begin(), row.end());
    }
  });
  const std::size_t columns = names.size();
  return py::make_tuple(std::move(names), table(std::move(values), columns));
}

/// Place of an extreme over several places, for each column.
std::vector<std::string> places(const SolvedRun& run, const std::string& xml, int step) {
  return in_turn([&] { return places_of(quantities_in(run, xml), run.at(step)); });
}

/// Fields at relative arc lengths of a member.
py::dict sample(const SolvedRun& run, const std::string& member, const std::vector<double>& positions, int step,
                bool before_vertex) {
  std::map<std::string, std::vector<Vector3>> fields;
  std::vector<double> arc_length;
  std::vector<std::array<double, 4>> triad;
  in_turn([&] {
    const Simulation simulation = run.at(step);
    const int index = member_index(simulation.scene(), member);
    const auto add = [&](const char* name, const Vec3<double>& value) {
      fields[name].push_back({value[0], value[1], value[2]});
    };
    for (const double position : positions) {
      const PointSample at = sample_member(simulation.model(), simulation.state(), index, position, before_vertex);
      arc_length.push_back(at.arc_length);
      triad.push_back({at.triad.w, at.triad.x, at.triad.y, at.triad.z});
      add("reference_position", at.reference_position);
      add("position", at.position);
      add("displacement", at.displacement);
      add("material_force", at.force);
      add("material_moment", at.moment);
      add("force_strain", at.force_strain);
      add("moment_strain", at.moment_strain);
    }
  });
  py::dict result;
  result["arc_length"] = numbers(std::move(arc_length));
  result["triad"] = numbers(std::move(triad));
  for (auto& [name, values] : fields) result[py::str(name)] = numbers(std::move(values));
  return result;
}

py::dict members_of(const SolvedRun& run) {
  std::vector<std::tuple<std::string, double, int, int>> found;
  in_turn([&] {
    const Simulation simulation = run.at(-1);
    const std::vector<Member>& members = simulation.scene().members;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const MeshMember& on_mesh = simulation.model().mesh().members[i];
      found.emplace_back(members[i].name, on_mesh.curve.length, members[i].order, on_mesh.elements);
    }
  });
  py::dict members;
  for (const auto& [name, length, order, elements] : found)
    members[py::str(name)] = py::make_tuple(length, order, elements);
  return members;
}

py::dict state_of(const SolvedRun& run, int step) {
  StateSnapshot state = in_turn([&] {
    const Simulation simulation = run.at(step);
    return snapshot_of(simulation.model(), simulation.state());
  });
  py::dict arrays;
  arrays["vertex_displacement"] = table(std::move(state.vertex_displacement), 3);
  arrays["vertex_rotation"] = table(std::move(state.vertex_rotation), 4);
  arrays["element_triad"] = table(std::move(state.element_triad), 4);
  arrays["interior"] = numbers(std::move(state.interior));
  return arrays;
}

/// Known fields of a record; fields at samples are moved.
template <class Record>
py::dict dict_of(Record& record) {
  py::dict dict;
  visit_fields(record, [&](const auto& field, auto& value) {
    if constexpr (kIsAtSamples<decltype(value)>)
      dict[field.name] = numbers(std::move(value));
    else if (field.kept == Kept::always || is_known_value(value))
      dict[field.name] = value;
  });
  return dict;
}

py::list critical_points_of(const SolvedRun& run, int step) {
  std::vector<RecordedCriticalPoint> points = in_turn([&] {
    const KeptStep& kept = run.step(step);
    if (kept.report.critical_points.empty()) return std::vector<RecordedCriticalPoint>{};
    return run.at(step).record(kept.report, kPointsByOrder, {}).critical_points;
  });
  py::list result;
  for (RecordedCriticalPoint& point : points) result.append(dict_of(point));
  return result;
}

py::list buckling_modes_of(const SolvedRun& run, int count, int step) {
  py::list result;
  for (RecordedBucklingMode& mode : in_turn([&] { return run.at(step).buckling_modes(count, kPointsByOrder); }))
    result.append(dict_of(mode));
  return result;
}

/// `tracks`: of the states searched before.
py::list natural_modes_of(const SolvedRun& run, int count, int step, bool in_plane, ModeTracks* tracks) {
  py::list result;
  for (RecordedVibrationMode& mode :
       in_turn([&] { return run.at(step).vibration_modes(count, in_plane, kPointsByOrder, {}, tracks); }))
    result.append(dict_of(mode));
  return result;
}

/// {quantity: (value, {path of a number: derivative}, stiffness, compliance, natural, note)}
py::dict gradient_table(const SolvedRun& run, const std::vector<std::string>& of, const std::vector<std::string>& by,
                        bool by_element, int step) {
  const Application& app = run.app();
  RecordedGradients found = in_turn([&] {
    const GradientParameters asked{of, by, by_element};
    require_known(asked, app.xml, app.quantities, app.scene);
    try {
      return gradients_at(run.at(step), asked, {app.quantities, run.critical_points()}, app.xml, app.load_case);
    } catch (const LinearSolverError& error) {
      throw ConvergenceError(error.what());
    }
  });
  py::dict all;
  for (RecordedGradient& one : found.quantities) {
    py::dict derivatives;
    for (std::size_t i = 0; i < found.numbers.size(); ++i) derivatives[py::str(found.numbers[i])] = one.derivative[i];
    all[py::str(one.quantity)] =
        py::make_tuple(one.value, derivatives, numbers(std::move(one.stiffness)), numbers(std::move(one.compliance)),
                       numbers(std::move(one.natural)), one.note);
  }
  return all;
}

py::object error_estimate_of(const SolvedRun& run, int step) {
  const ErrorEstimate estimate = in_turn([&] { return run.at(step).estimate_error(); });
  if (!estimate.exists()) return py::str(estimate.not_estimated);
  py::dict errors;
  for (const auto& [name, member] : kErrorsOfEstimate)
    errors[name] = py::make_tuple((estimate.*member).error, (estimate.*member).size);
  return std::move(errors);
}

py::dict value_errors_of(const SolvedRun& run, int step) {
  const QuantitySet& quantities = run.app().quantities;
  const ErrorSummary found = in_turn([&] {
    const Simulation at = run.at(step);
    StepRecord record = at.record(run.step(step).report, kPointsByOrder, {});
    record.monitored = {{kQuantitySeries, values_of(quantities, at, record)}};
    record.error_estimate.emplace();
    add_value_errors(&quantities, at, at.estimate_error(), record);
    return static_cast<const ErrorSummary&>(*record.error_estimate);
  });
  py::dict errors;
  for (const auto* values : {&found.sections, &found.quantities})
    for (const EstimatedValue& one : *values)
      errors[py::str(one.name)] =
          one.is_estimated() ? py::object(py::make_tuple(one.error, one.value)) : py::str(one.not_estimated);
  return errors;
}

py::list checks_of(const SolvedRun& run) {
  py::list checks;
  for (const CheckedQuantity& check : run.app().summary.checks())
    checks.append(py::make_tuple(check.name, check.word.empty() ? py::cast(check.value) : py::cast(check.word),
                                 check.reference, check.source, check.pass));
  return checks;
}

py::list found_numbers_of(const SolvedRun& run) {
  py::list found;
  for (const FoundNumberOfScene& one : run.app().summary.found_numbers)
    found.append(py::make_tuple(one.parameter, one.number, one.start, one.value, one.deviation, one.covariance));
  return found;
}

/// Stiffness matrices of all sections by name, including imported ones and profiles; infinite where rigid.
std::map<std::string, Matrix6> sections_of(const SolvedRun& run) {
  std::map<std::string, Matrix6> found;
  for (const Section& section : run.app().scene.sections) {
    Matrix6& stiffness = found[section.name] = section.matrix.value_or(Matrix6{});
    for (std::size_t i = 0; i < 6; ++i) stiffness[i][i] = diagonal(section)[i];
  }
  return found;
}

}  // namespace

void bind_run(py::module_& module) {
  py::class_<ModeTracks>(module, "ModeTracks").def(py::init<>());
  py::class_<SolvedRun, Run>(module, "SolvedRun")
      .def("path", path_of)
      .def("evaluate", evaluate)
      .def("places", places)
      .def("sample", sample)
      .def("members", members_of)
      .def("sections", sections_of)
      .def("state", state_of)
      .def("critical_points", critical_points_of)
      .def("buckling_modes", buckling_modes_of)
      .def("natural_modes", natural_modes_of)
      .def("gradients", gradient_table)
      .def("error_estimate", error_estimate_of)
      .def("value_errors", value_errors_of)
      .def("checks", checks_of)
      .def("found_numbers", found_numbers_of)
      .def("report", &SolvedRun::report)
      .def("require_same_file", &SolvedRun::require_same_file)
      .def("interrupted", &SolvedRun::interrupted)
      .def("warnings", [](const SolvedRun& run) { return run.app().summary.warnings; })
      .def("load_case", [](const SolvedRun& run) { return run.app().load_case; })
      .def("scene", [](const SolvedRun& run) { return run.app().xml.text; })
      .def("write", [](const SolvedRun& run, const std::string& file) { in_turn([&] { run.write(file); }); });
}

}  // namespace mixbeam
